#include "rejections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "imu_reason.h"

namespace pf::capture {

namespace {

constexpr double kSigmas = 4.0;          ///< of a calibration that is contradicted
constexpr double kOffsetSigmas = 4.0;    ///< of a time offset that is worth a line
constexpr double kLeastOffset_s = 0.01;  ///< likewise: less is what --estimate delay finds
constexpr double kLeastDoubt_s = 1.0;    ///< of a unit that was rejected and is believed again

std::string text_of(const char* format, double a, double b) {
  char text[400];
  std::snprintf(text, sizeof(text), format, a, b);
  return text;
}

}  // namespace

void add_rejected_calibration(const pf_slam_t* slam, const pf_camera_t& given, std::vector<Rejection>& rejections) {
  pf_camera_t found{};
  double covariance[100];
  if (pf_get_camera(slam, &found, covariance) != PF_OK || found.estimate != PF_CAMERA_ESTIMATE) {
    return;
  }
  const auto sigma = [&](int i) { return std::sqrt(covariance[11 * i]); };
  struct Number {
    const char* name;
    double given, found, prior, left;
  };
  const std::array<Number, 5> numbers{
      {{"fx", given.fx, found.fx, given.sigma_focal * given.fx, sigma(0)},
       {"fy", given.fy, found.fy, given.sigma_focal * given.fy, sigma(1)},
       {"cx", given.cx, found.cx, given.sigma_centre_px, sigma(2)},
       {"cy", given.cy, found.cy, given.sigma_centre_px, sigma(3)},
       {"distortion", given.distortion[0], found.distortion[0], given.sigma_distortion[0], sigma(4)}}};
  const Number* worst = nullptr;
  double most = kSigmas;
  for (const Number& number : numbers) {
    const double off = std::fabs(number.found - number.given);
    const double sigmas = number.prior > 0.0 ? off / number.prior : 0.0;
    if (sigmas > most && off > kSigmas * number.left) {
      most = sigmas;
      worst = &number;
    }
  }
  if (worst == nullptr) {
    return;
  }
  rejections.push_back(
      {"calibration", std::string("the pictures contradict the calibration: its ") + worst->name +
                          text_of(" of %.5g was found as %.5g, ", worst->given, worst->found) +
                          text_of("%.1f of its sigmas away (%.3g); ", most, worst->prior) +
                          "is it of this camera at this resolution and focus? pf-calibrate makes one"});
}

void add_rejected_unit(const pf_slam_t* slam, const UnitCheck& unit, std::vector<Rejection>& rejections) {
  pf_imu_report_t report{};
  if (!unit.inertial || pf_get_imu_report(slam, &report) != PF_OK) {
    return;
  }
  const bool tells = report.reason > PF_IMU_REASON_CONTRADICTS;
  const bool long_ago = report.rejected == 0 && report.rejected_s > kLeastDoubt_s;
  if (report.rejected != 0 || long_ago) {
    rejections.push_back(
        {"inertial unit",
         std::string("the inertial unit contradicts the pictures and was left out, ") +
             text_of(long_ago ? "for %.1f s in all" : "for %.1f s and at the end", report.rejected_s, 0.0) +
             (long_ago ? "" : "; lengths are not metres then") + "; " +
             (tells
                  ? reason_in_words(report)
                  : std::string(
                        "check --imu-mount, the axes and signs (at rest the accelerometer shows +9.81 m/s^2 upwards), "
                        "units and --imu-offset"))});
  } else if (tells) {
    rejections.push_back({"inertial unit", "the inertial unit is not used in full: " + reason_in_words(report)});
  }
  const double off = unit.offset_s - unit.delay_s;
  if (unit.sigma_s > 0.0 && std::fabs(off) > kLeastOffset_s && std::fabs(off) > kOffsetSigmas * unit.sigma_s) {
    rejections.push_back(
        {"delay", text_of("the pictures contradict the inertial unit's times by %.1f ms, sigma %.1f ms; ", 1e3 * off,
                          1e3 * unit.sigma_s) +
                      text_of("type --imu-offset %.4f", unit.given_s + off, 0.0)});
  }
}

std::string summary_of(const std::vector<Rejection>& rejections) {
  std::string text;
  for (const Rejection& rejection : rejections) {
    text += (text.empty() ? "contradicted by the pictures: " : ", ") + rejection.what;
  }
  return text;
}

}  // namespace pf::capture
