#include <string>

#include "arrays.h"
#include "context.h"
#include "docs.h"

namespace pf::python {

void add_starts(nb::class_<Context>& slam) {
  slam.def(
      "start_from_target",
      [](Context& self, const pf_target_t& target) {
        self.run("start_from_target", [&](pf_slam_t* context) { return pf_start_from_target(context, &target); });
      },
      nb::arg("target"), doc::pf_start_from_target);
  slam.def(
      "start_from_pose",
      [](Context& self, const pf_pose_t& pose, const ArrayLike& velocity_covariance) {
        const auto covariance = numbers<36>(velocity_covariance, "velocity_covariance");
        self.run("start_from_pose",
                 [&](pf_slam_t* context) { return pf_start_from_pose(context, &pose, covariance.data()); });
      },
      nb::arg("pose"), nb::arg("velocity_covariance"), doc::pf_start_from_pose);
  slam.def(
      "set_second_pose",
      [](Context& self, int64_t t_ns, const pf_pose_t& pose) {
        self.run("set_second_pose", [&](pf_slam_t* context) { return pf_set_second_pose(context, t_ns, &pose); });
      },
      nb::arg("t_ns"), nb::arg("pose"), doc::pf_set_second_pose);
  slam.def(
      "withdraw_target",
      [](Context& self) {
        self.run("withdraw_target", [](pf_slam_t* context) { return pf_withdraw_target(context); });
      },
      doc::pf_withdraw_target);
  slam.def(
      "add_wall",
      [](Context& self, const pf_wall_prior_t& wall) {
        uint32_t id = 0;
        self.run("add_wall", [&](pf_slam_t* context) { return pf_add_wall(context, &wall, &id); });
        return id;
      },
      nb::arg("wall"), doc::pf_add_wall);
  slam.def(
      "save_map",
      [](Context& self, pf_map_kind_t kind) -> nb::object {
        nb::object map = nb::none();
        self.run("save_map", [&](pf_slam_t* context) {
          size_t bytes = 0;
          pf_status_t status = pf_map_size(context, kind, &bytes);
          std::string buffer(bytes, '\0');
          if (status == PF_OK) status = pf_save_map(context, kind, buffer.data(), bytes, &bytes);
          if (status == PF_OK) map = nb::bytes(buffer.data(), bytes);
          return status;
        });
        return map;
      },
      nb::arg("kind") = PF_MAP_PORTABLE, doc::pf_save_map);
  slam.def(
      "load_map",
      [](Context& self, const nb::bytes& map) {
        self.run("load_map", [&](pf_slam_t* context) { return pf_load_map(context, map.c_str(), map.size()); });
      },
      nb::arg("map"), doc::pf_load_map);
  slam.def(
      "set_gravity",
      [](Context& self, const ArrayLike& gravity_W) {
        const auto gravity = numbers<3>(gravity_W, "gravity_W");
        self.run("set_gravity", [&](pf_slam_t* context) { return pf_set_gravity(context, gravity.data()); });
      },
      nb::arg("gravity_W"), doc::pf_set_gravity);
  slam.def(
      "set_plane_vertical",
      [](Context& self, uint32_t plane, double sigma_rad) {
        return self.run("set_plane_vertical",
                        [&](pf_slam_t* context) { return pf_set_plane_vertical(context, plane, sigma_rad); });
      },
      nb::arg("plane"), nb::arg("sigma_rad"), doc::pf_set_plane_vertical);
}

}  // namespace pf::python
