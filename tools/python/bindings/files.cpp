#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <planefold_platform/sequence.h>

#ifdef PLANEFOLD_HAVE_WALLS
#include <planefold_platform/walls.h>
#endif

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "docs.h"
#include "errors.h"
#include "functions.h"
#include "path.h"

namespace pf::python {

namespace {

/// A note of the library as a warning of Python.
void warn(const char* note) {
  if (note[0] != '\0' && PyErr_WarnEx(PyExc_RuntimeWarning, note, 1) != 0) throw nb::python_error();
}

/// One of the readers that fill in a structure from a file, as a function that returns it.
template <class T>
auto reader(int (*read)(const char*, T*, char*)) {
  return [read](const Path& path) {
    T value{};
    char message[PF_SEQUENCE_MESSAGE] = "";
    if (read(path.c_str(), &value, message) != 0) raise_refused(message);
    return value;
  };
}

std::pair<pf_camera_t, double> read_calibration(const Path& path) {
  pf_camera_t camera{};
  double rate_hz = 0.0;
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (pf_read_calibration(path.c_str(), &camera, &rate_hz, message) != 0) raise_refused(message);
  warn(message);
  return {camera, rate_hz};
}

void write_calibration(const Path& path, const pf_camera_t& camera, double rate_hz, pf_calibration_form_t form) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (pf_write_calibration(path.c_str(), form, &camera, rate_hz, message) != 0) raise_refused(message);
}

std::vector<pf_imu_sample_t> read_imu(const Path& path) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  pf_imu_sample_t* samples = nullptr;
  size_t count = 0;
  if (pf_read_imu(path.c_str(), &samples, &count, message) != 0) raise_refused(message);
  const std::unique_ptr<pf_imu_sample_t, void (*)(pf_imu_sample_t*)> owner(samples, pf_free_imu);
  warn(message);
  return {samples, samples + count};
}

/// What a file says about the unit, on top of what is known of it already.
auto imu_reader(int (*read)(const char*, pf_imu_model_t*, char*)) {
  return [read](const Path& path, pf_imu_model_t& imu) {
    char message[PF_SEQUENCE_MESSAGE] = "";
    if (read(path.c_str(), &imu, message) != 0) raise_refused(message);
    warn(message);
  };
}

#ifdef PLANEFOLD_HAVE_WALLS
using Walls = std::vector<std::pair<std::string, pf_wall_prior_t>>;

std::pair<Walls, std::optional<Vector>> read_walls(const Path& path) {
  const auto walls = std::make_unique<pf_walls_t>();
  char message[PF_WALLS_MESSAGE] = "";
  if (pf_read_walls(path.c_str(), walls.get(), message) != 0) raise_refused(message);
  Walls all;
  for (int32_t i = 0; i < walls->count; ++i) all.emplace_back(walls->wall[i].name, walls->wall[i].prior);
  return {all, walls->has_up != 0 ? std::optional<Vector>(to_vector(walls->up_W, 3)) : std::nullopt};
}
#endif

}  // namespace

void add_files(nb::module_& module) {
  module.def("read_calibration", read_calibration, nb::arg("path"), doc::pf_read_calibration);
  module.def("write_calibration", write_calibration, nb::arg("path"), nb::arg("camera"), nb::arg("rate_hz") = 0.0,
             nb::arg("form") = PF_CALIBRATION_PLAIN, doc::pf_write_calibration);
  module.def("read_target", reader<pf_target_t>(pf_read_target), nb::arg("path"), doc::pf_read_target);
  module.def("read_first_pose", reader<pf_pose_t>(pf_read_first_pose), nb::arg("path"), doc::pf_read_first_pose);
  module.def(
      "parse_rectangle", [](const std::string& text) { return reader<pf_target_t>(pf_parse_rectangle)(Path{text}); },
      nb::arg("text"), doc::pf_parse_rectangle);
  module.def("read_imu", read_imu, nb::arg("path"), doc::pf_read_imu);
  module.def("read_imu_noise", imu_reader(pf_read_imu_noise), nb::arg("path"), nb::arg("imu"), doc::pf_read_imu_noise);
  module.def("read_imu_mount", imu_reader(pf_read_imu_mount), nb::arg("path"), nb::arg("imu"), doc::pf_read_imu_mount);
#ifdef PLANEFOLD_HAVE_WALLS
  module.def("read_walls", read_walls, nb::arg("path"), doc::pf_read_walls);
#endif
}

}  // namespace pf::python
