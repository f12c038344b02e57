#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMU_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMU_H

#include <planefold/planefold.h>

#include <string>
#include <string_view>
#include <vector>

namespace pf::sequence {

constexpr size_t kMaxImuBytes = size_t{1} << 30;

/// Rows of time, angular velocity and specific force, in order of time. Throws ReadError; name stands for the file.
/// note  becomes a line where the times are in another unit than expected
std::vector<pf_imu_sample_t> parse_imu(std::string_view text, const std::string& name, std::string& note);

}  // namespace pf::sequence

#endif
