#include "phone.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace pfsim {
namespace {

using pf::sim::ImuOptions;
using pf::sim::Mat3;
using pf::sim::Random;
using pf::sim::Vec3;

constexpr std::uint64_t kStream = 57;
constexpr double kScale = 0.01, kCross = 0.005, kNoise = 3, kDelay = 0.05, kJitter = 1e-3;
constexpr double kTurn = 2 * 3.14159265358979 / 180;

/// The unit's axes become R of what they were, and its origin stays where it is on the camera.
void turn(const Mat3& R, ImuOptions* imu) {
  imu->R_BC = R * imu->R_BC;
  imu->p_BC = R * imu->p_BC;
}

}  // namespace

void turn_axes(int which, ImuOptions* imu) {
  const int first = which % 3, second = (first + 1 + which / 3 % 2) % 3;
  const double sign[2] = {which / 6 % 2 == 0 ? 1.0 : -1.0, which / 12 % 2 == 0 ? 1.0 : -1.0};
  Vec3 x, y;
  (first == 0 ? x.x : first == 1 ? x.y : x.z) = sign[0];
  (second == 0 ? y.x : second == 1 ? y.y : y.z) = sign[1];
  const Vec3 z = x.cross(y);
  Mat3 R;
  R.m = {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
  turn(R, imu);
}

std::string choose_parts(const std::vector<std::string>& names, PhoneParts* parts) {
  if (names.empty()) return "";
  const std::pair<const char*, bool PhoneParts::*> kParts[] = {
      {"scale", &PhoneParts::scale}, {"cross", &PhoneParts::cross},   {"noise", &PhoneParts::noise},
      {"delay", &PhoneParts::delay}, {"jitter", &PhoneParts::jitter}, {"mount", &PhoneParts::mount},
      {"rows", &PhoneParts::rows}};
  for (const auto& part : kParts) parts->*part.second = false;
  for (const std::string& name : names) {
    const auto* const found =
        std::find_if(std::begin(kParts), std::end(kParts), [&](const auto& part) { return name == part.first; });
    if (found == std::end(kParts)) return name;
    parts->*found->second = true;
  }
  return "";
}

void make_phone(std::uint64_t seed, const PhoneParts& parts, ImuOptions* imu) {
  Random draw(seed, kStream);
  for (auto* error : {&imu->gyro_error, &imu->accel_error})
    for (std::size_t i = 0; i < 9; ++i) {
      const bool on_axis = i % 4 == 0;
      const double drawn = draw.normal() * (on_axis ? kScale : kCross);
      (*error)[i] = (on_axis ? parts.scale : parts.cross) ? drawn : 0;
    }
  if (parts.noise)
    for (double* density : {&imu->gyro_density, &imu->accel_density, &imu->gyro_walk, &imu->accel_walk})
      *density *= kNoise;
  if (parts.delay) imu->delay_s += kDelay;
  if (parts.jitter) imu->jitter_s = kJitter;
  const pf::sim::Vec3 axis = draw.normal3().unit();
  if (parts.mount) turn(pf::sim::rotation_exp(axis * kTurn), imu);
}

}  // namespace pfsim
