#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMU_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMU_H

#include <planefold/planefold.h>

#include <string>
#include <string_view>
#include <vector>

namespace pf::sequence {

constexpr size_t kMaxImuBytes = size_t{1} << 30;

/// Rows of time, angular velocity and specific force, in order of time. Throws ReadError; name stands for the file.
/// note  becomes a line on what was converted, mended or left out
std::vector<pf_imu_sample_t> parse_imu(std::string_view text, const std::string& name, std::string& note);

/// The same from what a user names: a file, two files as GYRO+ACCEL, or a folder with one for each sensor, as phones write it.
std::vector<pf_imu_sample_t> read_imu(const std::string& path, std::string& note);

}  // namespace pf::sequence

#endif
