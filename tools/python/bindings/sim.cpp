#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <planefold_platform/sim.h>

#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "arrays.h"
#include "docs.h"
#include "errors.h"
#include "functions.h"

namespace pf::python {

namespace {

std::vector<std::string> scenes() {
  std::vector<std::string> names;
  while (const char* name = pf_sim_scene_name(static_cast<int32_t>(names.size()))) names.emplace_back(name);
  return names;
}

pf_sim_options_t options_of(const std::string& scene) {
  pf_sim_options_t options{};
  if (pf_sim_options_default(scene.c_str(), &options) != PF_OK) {
    std::string known;
    for (const std::string& name : scenes()) known += (known.empty() ? "" : ", ") + name;
    raise_refused("sim:" + scene + ": there is no such scene; there are " + known);
  }
  return options;
}

/// A scene, whose frames are iterated over.
class Sim {
 public:
  Sim(const std::string& scene, const std::optional<pf_sim_options_t>& options)
      : scene_(scene), options_(options ? *options : options_of(scene)), sim_(nullptr, pf_sim_close) {
    options_of(scene);
    sim_.reset(pf_sim_open(scene.c_str(), &options_));
    if (!sim_) raise_refused("sim:" + scene + ": an option is out of its range, or there is no memory for the picture");
    pf_sim_camera(sim_.get(), &camera_);
  }

  std::tuple<GreyImage, int64_t> next() {
    pf_image_t image{};
    if (pf_sim_next(sim_.get(), &image, &truth_) == 0) throw nb::stop_iteration();
    return {copy_image(image), image.t_ns};
  }

  GreyImage render(const pf_pose_t& pose) {
    pf_image_t image{};
    check(pf_sim_render(sim_.get(), &pose, &image), "render");
    return copy_image(image);
  }

  pf_target_t target(pf_target_kind_t kind) const {
    pf_target_t target{};
    if (pf_sim_target(sim_.get(), kind, &target) != PF_OK) raise_refused("sim:" + scene_ + ": has no target");
    return target;
  }

  pf_pose_t pose_at(int64_t t_ns) const {
    pf_pose_t pose{};
    pf_sim_pose_at(sim_.get(), t_ns, &pose);
    return pose;
  }

  std::pair<Vector, double> surface(int32_t number) const {
    double normal[3] = {}, distance = 0.0;
    check(pf_sim_surface(sim_.get(), number, normal, &distance), "surface");
    return {to_vector(normal, 3), distance};
  }

  void rewind() { pf_sim_rewind(sim_.get()); }
  const pf_camera_t& camera() const { return camera_; }
  const pf_sim_options_t& options() const { return options_; }
  const pf_pose_t& truth() const { return truth_; }
  const pf_sim_t* get() const { return sim_.get(); }

 private:
  std::string scene_;
  pf_sim_options_t options_;
  std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim_;
  pf_camera_t camera_{};
  pf_pose_t truth_{};
};

/// The inertial unit beside it.
class SimImu {
 public:
  SimImu(const Sim& sim, const std::optional<pf_sim_imu_options_t>& options) : imu_(nullptr, pf_sim_imu_close) {
    pf_sim_imu_options_default(&options_);
    if (options) options_ = *options;
    imu_.reset(pf_sim_imu_open(sim.get(), &options_));
    if (!imu_) raise_refused("SimImu: an option is out of its range");
  }

  std::vector<pf_imu_sample_t> until(int64_t t_ns) {
    std::vector<pf_imu_sample_t> samples;
    while (pf_sim_imu_next_ns(imu_.get()) <= t_ns) {
      samples.emplace_back();
      pf_sim_imu_next(imu_.get(), &samples.back());
    }
    return samples;
  }

  std::pair<Vector, Vector> biases() const {
    double gyro[3] = {}, accel[3] = {};
    pf_sim_imu_biases(imu_.get(), gyro, accel);
    return {to_vector(gyro, 3), to_vector(accel, 3)};
  }

  const pf_sim_imu_options_t& options() const { return options_; }

 private:
  pf_sim_imu_options_t options_{};
  std::unique_ptr<pf_sim_imu_t, void (*)(pf_sim_imu_t*)> imu_;
};

}  // namespace

void add_sim(nb::module_& module) {
  module.def("sim_scenes", scenes, "Names of the built-in scenes.");
  module.def("sim_options", options_of, nb::arg("scene"), "The scene's own options.");
  nb::class_<Sim> sim(module, "Sim", "A built-in scene with exact truth: iterates over (image, t_ns).");
  sim.def(nb::init<const std::string&, const std::optional<pf_sim_options_t>&>(), nb::arg("scene"),
          nb::arg("options") = nb::none(), doc::pf_sim_open);
  sim.def(
      "__iter__", [](nb::handle self) { return nb::borrow(self); }, nb::sig("def __iter__(self) -> Sim"));
  sim.def("__next__", &Sim::next);
  sim.def("rewind", &Sim::rewind, doc::pf_sim_rewind);
  sim.def("target", &Sim::target, nb::arg("kind") = PF_TARGET_RECTANGLE, doc::pf_sim_target);
  sim.def("pose_at", &Sim::pose_at, nb::arg("t_ns"), doc::pf_sim_pose_at);
  sim.def("render", &Sim::render, nb::arg("pose"), doc::pf_sim_render);
  sim.def("surface", &Sim::surface, nb::arg("number"), doc::pf_sim_surface);
  sim.def_prop_ro(
      "camera", [](const Sim& self) { return self.camera(); }, doc::pf_sim_camera);
  sim.def_prop_ro(
      "options", [](const Sim& self) { return self.options(); }, "A copy of the options.");
  sim.def_prop_ro(
      "truth", [](const Sim& self) { return self.truth(); }, "True pose in the frame that came last.");

  nb::class_<SimImu> imu(module, "SimImu", "An inertial unit beside the camera of a scene.");
  imu.def(nb::init<const Sim&, const std::optional<pf_sim_imu_options_t>&>(), nb::arg("sim"),
          nb::arg("options") = nb::none(), doc::pf_sim_imu_open);
  imu.def("until", &SimImu::until, nb::arg("t_ns"),
          "The samples that are measured up to a time, from where the last call ended.");
  imu.def("biases", &SimImu::biases, doc::pf_sim_imu_biases);
  imu.def_prop_ro(
      "options", [](const SimImu& self) { return self.options(); }, "A copy of the options.");
}

}  // namespace pf::python
