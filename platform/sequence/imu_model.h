#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMU_MODEL_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMU_MODEL_H

#include <planefold/planefold.h>

#include <string>

namespace pf::sequence {

constexpr size_t kMaxImuModelBytes = size_t{1} << 20;

/// Noise densities of a unit, from Kalibr's imu.yaml, EuRoC's imu0/sensor.yaml or the plain form. Sets these four fields of *imu, and
/// gravity where the file has it, and returns one line on what was ignored, or "". Throws ReadError.
std::string parse_imu_noise(const std::string& text, const std::string& file, pf_imu_model_t* imu);

/// Where the unit is mounted, from EuRoC's cam0/sensor.yaml (T_BS), Kalibr's camchain-imucam.yaml (T_cam_imu, and its
/// timeshift_cam_imu as delay) or the plain form (T_imu_cam). Sets q_BC, p_BC and delay_s of *imu. Throws ReadError.
void parse_imu_mount(const std::string& text, const std::string& file, pf_imu_model_t* imu);

}  // namespace pf::sequence

#endif
