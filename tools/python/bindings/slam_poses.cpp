#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include <optional>

#include "arrays.h"
#include "context.h"
#include "docs.h"

namespace pf::python {

namespace {

pf_pose_t predict(Context& self, int64_t t_ns) {
  pf_pose_t pose{};
  self.run("predict_pose", [&](const pf_slam_t* context) { return pf_predict_pose(context, t_ns, &pose); });
  return pose;
}

/// Of a getter that says PF_NOTE_NOTHING: None.
template <class T, class Ask>
std::optional<T> maybe(Context& self, const char* call, const Ask& ask) {
  T value{};
  const pf_status_t status = self.run(call, [&](const pf_slam_t* context) { return ask(context, &value); });
  return status == PF_NOTE_NOTHING ? std::nullopt : std::optional<T>(value);
}

std::pair<Vector, Matrix> project(Context& self, const ArrayLike& p_W) {
  const auto point = numbers<3>(p_W, "p_W");
  double pixel[2] = {}, covariance[4] = {};
  self.run("project",
           [&](const pf_slam_t* context) { return pf_project_point(context, point.data(), pixel, covariance); });
  return {to_vector(pixel, 2), to_matrix(covariance, 2, 2)};
}

}  // namespace

void add_poses(nb::class_<Context>& slam) {
  slam.def_prop_ro(
      "state",
      [](Context& self) {
        pf_state_t state = PF_STATE_STARTING;
        self.run("state", [&](const pf_slam_t* context) { return pf_get_state(context, &state); });
        return state;
      },
      doc::pf_get_state);
  slam.def_prop_ro(
      "pose",
      [](Context& self) {
        pf_pose_t pose{};
        self.run("pose", [&](const pf_slam_t* context) { return pf_get_pose(context, &pose); });
        return pose;
      },
      doc::pf_get_pose);
  slam.def("predict_pose", predict, nb::arg("t_ns"), doc::pf_predict_pose);
  slam.def(
      "mark_pose",
      [](Context& self) { self.run("mark_pose", [](pf_slam_t* context) { return pf_mark_pose(context); }); },
      doc::pf_mark_pose);
  slam.def_prop_ro(
      "motion_since_mark",
      [](Context& self) { return maybe<pf_motion_t>(self, "motion_since_mark", pf_get_motion_since_mark); },
      doc::pf_get_motion_since_mark);
  slam.def("project", project, nb::arg("p_W"), doc::pf_project_point);
  slam.def(
      "hit_test",
      [](Context& self, const ArrayLike& pixel) {
        const auto at = numbers<2>(pixel, "pixel");
        return maybe<pf_hit_t>(self, "hit_test", [&](const pf_slam_t* context, pf_hit_t* hit) {
          return pf_hit_test(context, at.data(), hit);
        });
      },
      nb::arg("pixel"), doc::pf_hit_test);
  slam.def(
      "add_anchor_pose",
      [](Context& self, const pf_pose_t& pose) {
        uint32_t id = 0;
        self.run("add_anchor_pose", [&](pf_slam_t* context) { return pf_add_anchor_pose(context, &pose, &id); });
        return id;
      },
      nb::arg("pose"), doc::pf_add_anchor_pose);
  slam.def(
      "add_anchor_hit",
      [](Context& self, const pf_hit_t& hit) -> nb::object {
        uint32_t id = 0;
        const pf_status_t status =
            self.run("add_anchor_hit", [&](pf_slam_t* context) { return pf_add_anchor_hit(context, &hit, &id); });
        if (status == PF_NOTE_NOTHING) return nb::none();
        return nb::int_(id);
      },
      nb::arg("hit"), doc::pf_add_anchor_hit);
  slam.def(
      "anchor",
      [](Context& self, uint32_t id) {
        return maybe<pf_anchor_t>(self, "anchor", [&](const pf_slam_t* context, pf_anchor_t* anchor) {
          return pf_get_anchor(context, id, anchor);
        });
      },
      nb::arg("id"), doc::pf_get_anchor);
  slam.def(
      "remove_anchor",
      [](Context& self, uint32_t id) {
        return self.run("remove_anchor", [&](pf_slam_t* context) { return pf_remove_anchor(context, id); });
      },
      nb::arg("id"), doc::pf_remove_anchor);
  slam.def_prop_ro(
      "inertial", [](Context& self) { return maybe<pf_inertial_t>(self, "inertial", pf_get_inertial); },
      doc::pf_get_inertial);
  slam.def(
      "template",
      [](Context& self, uint32_t feature) {
        return maybe<pf_template_t>(self, "template", [&](const pf_slam_t* context, pf_template_t* out) {
          return pf_get_template(context, feature, out);
        });
      },
      nb::arg("feature"), doc::pf_get_template);
  slam.def(
      "find_plane",
      [](Context& self, uint32_t id) {
        return maybe<uint32_t>(self, "find_plane", [&](const pf_slam_t* context, uint32_t* current) {
          return pf_find_plane(context, id, current);
        });
      },
      nb::arg("id"), doc::pf_find_plane);
}

}  // namespace pf::python
