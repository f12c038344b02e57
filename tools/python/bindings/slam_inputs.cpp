#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "arrays.h"
#include "context.h"
#include "docs.h"

namespace pf::python {

namespace {

using Times = nb::ndarray<const int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

nb::object made_of(const ArrayLike& given, const char* type) {
  return nb::module_::import_("numpy").attr("ascontiguousarray")(given.given, type);
}

/// How NumPy calls what the numbers are: i and u whole, f floating, M dates, m times between dates.
std::string kind_of(const nb::object& array) { return nb::cast<std::string>(array.attr("dtype").attr("kind")); }

/// Dates are counted in their own unit, often microseconds: they become nanoseconds first.
Times times_of(const ArrayLike& given) {
  nb::object array = nb::module_::import_("numpy").attr("asarray")(given.given);
  const std::string kind = kind_of(array);
  if (kind == "M" || kind == "m") {
    array = array.attr("astype")(kind + "8[ns]");
  } else if (kind != "i" && kind != "u") {
    refuse_seconds();
  }
  Times times;
  if (!nb::try_cast<Times>(made_of({array}, "int64"), times)) throw nb::value_error("t_ns: takes a list of times");
  return times;
}

Rows rows_of(const ArrayLike& given, const char* name, size_t count) {
  Rows rows;
  if (!nb::try_cast<Rows>(made_of(given, "float64"), rows) || rows.shape(0) != count) {
    throw nb::value_error(
        (std::string(name) + ": takes three numbers for each of the " + std::to_string(count) + " times").c_str());
  }
  return rows;
}

pf_status_t push_samples(Context& self, const std::vector<pf_imu_sample_t>& samples) {
  return self.run("push_imu", [&](pf_slam_t* context) { return pf_push_imu(context, samples.data(), samples.size()); });
}

pf_status_t push_arrays(Context& self, const ArrayLike& t_ns, const ArrayLike& gyro, const ArrayLike& accel) {
  const Times times = times_of(t_ns);
  std::vector<pf_imu_sample_t> samples(times.shape(0));
  const Rows rates = rows_of(gyro, "gyro", samples.size()), forces = rows_of(accel, "accel", samples.size());
  for (size_t i = 0; i < samples.size(); ++i) {
    samples[i].t_ns = times(i);
    for (size_t k = 0; k < 3; ++k) {
      samples[i].gyro[k] = rates(i, k);
      samples[i].accel[k] = forces(i, k);
    }
  }
  return push_samples(self, samples);
}

/// Columns x, y, width, height.
std::vector<pf_rectangle_t> rectangles_of(const ArrayLike& given) {
  using Quadruples = nb::ndarray<const int32_t, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>;
  std::vector<pf_rectangle_t> rectangles;
  if (given.given.is_none()) return rectangles;
  const nb::object array = nb::module_::import_("numpy").attr("asarray")(given.given);
  if (nb::cast<size_t>(array.attr("size")) == 0) return rectangles;
  const std::string kind = kind_of(array);
  if (kind != "i" && kind != "u") throw nb::type_error("rectangles: takes whole pixels");
  Quadruples rows;
  if (!nb::try_cast<Quadruples>(made_of(given, "int32"), rows)) {
    throw nb::value_error("rectangles: takes x, y, width and height of each");
  }
  for (size_t i = 0; i < rows.shape(0); ++i) {
    rectangles.push_back({rows(i, 0), rows(i, 1), rows(i, 2), rows(i, 3)});
  }
  return rectangles;
}

pf_status_t set_mask(Context& self, nb::handle pixels, const ArrayLike& rectangles) {
  const std::vector<pf_rectangle_t> masked = rectangles_of(rectangles);
  const pf_camera_t& camera = self.config().camera;
  pf_mask_t mask{};
  mask.width = camera.width;
  mask.height = camera.height;
  if (!pixels.is_none()) {
    const pf_image_t image = to_image(pixels, 0);
    mask.pixels = image.pixels;
    mask.width = image.width;
    mask.height = image.height;
    mask.stride = image.stride;
  }
  mask.num_rectangles = static_cast<int32_t>(masked.size());
  mask.rectangles = masked.empty() ? nullptr : masked.data();
  return self.run("set_mask", [&](pf_slam_t* context) { return pf_set_mask(context, &mask); });
}

}  // namespace

void add_inputs(nb::class_<Context>& slam) {
  slam.def(
      "push_frame",
      [](Context& self, nb::handle image, nb::handle t_ns) {
        const pf_image_t pixels = to_image(image, to_time(t_ns));
        return self.run_released("push_frame", [&](pf_slam_t* context) { return pf_push_frame(context, &pixels); });
      },
      nb::arg("image"), nb::arg("t_ns"),
      nb::sig("def push_frame(self, image: numpy.typing.NDArray[numpy.uint8], t_ns: int) -> Status"),
      doc::pf_push_frame);
  slam.def("set_mask", set_mask, nb::arg("pixels").none() = nb::none(), nb::arg("rectangles") = nb::none(),
           nb::sig("def set_mask(self, pixels: numpy.typing.NDArray[numpy.uint8] | None = None, "
                   "rectangles: numpy.typing.ArrayLike | None = None) -> Status"),
           doc::pf_set_mask);
  slam.def(
      "push_observations",
      [](Context& self, int64_t t_ns, const std::vector<pf_observation_t>& observations) {
        return self.run_released("push_observations", [&](pf_slam_t* context) {
          return pf_push_observations(context, t_ns, observations.data(), observations.size());
        });
      },
      nb::arg("t_ns"), nb::arg("observations"), doc::pf_push_observations);
  slam.def(
      "push_control",
      [](Context& self, const ArrayLike& dv_C, const ArrayLike& dw_C) {
        const auto dv = numbers<3>(dv_C, "dv_C"), dw = numbers<3>(dw_C, "dw_C");
        return self.run("push_control",
                        [&](pf_slam_t* context) { return pf_push_control(context, dv.data(), dw.data()); });
      },
      nb::arg("dv_C"), nb::arg("dw_C"), doc::pf_push_control);
  slam.def("push_imu", push_samples, nb::arg("samples"), doc::pf_push_imu);
  slam.def("push_imu", push_arrays, nb::arg("t_ns"), nb::arg("gyro"), nb::arg("accel"),
           "The same from arrays: times (n,), angular velocities and specific forces (n, 3).");
}

}  // namespace pf::python
