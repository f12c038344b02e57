#include <vector>

#include "arrays.h"
#include "context.h"
#include "docs.h"

namespace pf::python {

namespace {

pf_report_t report(Context& self) {
  pf_report_t report{};
  self.run("report", [&](const pf_slam_t* context) { return pf_get_report(context, &report); });
  return report;
}

Matrix gauge_information(Context& self) {
  const auto rows = static_cast<size_t>(report(self).state_dim);
  std::vector<double> scratch(rows * (rows + 8));
  double information[49] = {};
  self.run("gauge_information", [&](const pf_slam_t* context) {
    return pf_get_gauge_information(context, scratch.data(), scratch.size(), information);
  });
  return to_matrix(information, 7, 7);
}

}  // namespace

void add_reports(nb::class_<Context>& slam) {
  slam.def_prop_ro("report", report, doc::pf_get_report);
  slam.def_prop_ro(
      "imu_report",
      [](Context& self) {
        pf_imu_report_t report{};
        self.run("imu_report", [&](const pf_slam_t* context) { return pf_get_imu_report(context, &report); });
        return report;
      },
      doc::pf_get_imu_report);
  slam.def_prop_ro(
      "camera",
      [](Context& self) {
        pf_camera_t camera{};
        self.run("camera", [&](const pf_slam_t* context) { return pf_get_camera(context, &camera, nullptr); });
        return camera;
      },
      doc::pf_get_camera);
  slam.def_prop_ro(
      "camera_covariance",
      [](Context& self) {
        pf_camera_t camera{};
        double covariance[100] = {};
        self.run("camera_covariance",
                 [&](const pf_slam_t* context) { return pf_get_camera(context, &camera, covariance); });
        return to_matrix(covariance, 10, 10);
      },
      nb::rv_policy::move, doc::pf_get_camera);
  slam.def("gauge_information", gauge_information, doc::pf_get_gauge_information);
}

}  // namespace pf::python
