#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMU_MODEL_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMU_MODEL_H

#include <planefold/planefold.h>

#include <string>
#include <vector>

namespace pf::sequence {

constexpr size_t kMaxImuModelBytes = size_t{1} << 20;

/// Noise densities of a unit, from Kalibr's imu.yaml, EuRoC's imu0/sensor.yaml or the plain form. Sets these four fields of *imu, and
/// gravity where the file has it. Throws ReadError.
/// notes  gets a line on what was ignored
void parse_imu_noise(const std::string& text, const std::string& file, pf_imu_model_t* imu,
                     std::vector<std::string>& notes);

/// Where the unit is mounted, from one of the fields of pf_read_imu_mount. Sets q_BC, p_BC and delay_s of *imu. Throws ReadError.
/// camera  of a file of several; where it is not there, the first is taken, and a note says so
void parse_imu_mount(const std::string& text, const std::string& file, const std::string& camera, pf_imu_model_t* imu,
                     std::vector<std::string>& notes);

}  // namespace pf::sequence

#endif
