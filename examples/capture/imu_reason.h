#ifndef PLANEFOLD_CAPTURE_IMU_REASON_H
#define PLANEFOLD_CAPTURE_IMU_REASON_H

#include <planefold/planefold.h>

#include <string>

namespace pf::capture {

/// Of a pf_imu_reason_t, as report.json has it: "gyro-in-degrees"; "none".
const char* reason_name(int32_t reason);
/// Why the samples are not used, or lengths are no metres, with its numbers; "" where all is well.
std::string reason_in_words(const pf_imu_report_t& report);
/// "its x is the camera's -y, its y the camera's x, its z the camera's z", with the angle that is left where that is not all.
std::string axes_in_words(const double q_BC[4]);

}  // namespace pf::capture

#endif
