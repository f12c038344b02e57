#pragma once

#include <cstdint>

#include "filter/imu_log.h"
#include "filter/inertial_motion.h"
#include "slam/frame.h"
#include "slam/settings.h"

/// Detects that the camera lies still, from the samples of its inertial unit and from the picture together: a slow turntable is quiet to
/// the samples, and a wall that moves along is quiet to the picture. See lib/docs/inertial.md.

namespace pf {

class RestDetector {
 public:
  RestDetector(const Settings& settings, const Frame& frame, const ImuLog& imu)
      : settings_(settings), frame_(frame), imu_(imu) {}

  void layout(Arena& arena);
  void init() {
    if (data_ != nullptr) *data_ = Data();
  }
  /// After a frame. seen: its measurements support its pose. True when the camera has been at rest for a second up to this frame; then
  /// *rest is what the samples said in that time, and the next second begins.
  bool note(bool seen, RestReading* rest);
  /// When the last second at rest began, in the time of frames.
  std::int64_t begin_ns() const { return data_->rest_begin_ns; }

 private:
  static constexpr int kMaxPixels = 60;

  /// Where a feature was at the beginning of this second.
  struct Seen {
    std::uint32_t id;
    Vec2 pixel;
  };

  struct Data {
    bool begun = false;
    std::int64_t begin_ns = 0;  ///< of this second
    std::int64_t rest_begin_ns = 0;
    std::int64_t sample_ns = 0;  ///< time of the last sample that was taken in
    int count = 0;
    int seen = 0;
    Scalar motion2 = 0;                           ///< [px^2] of the picture since this second began
    Vec3 mean[2] = {Vec3::Zero(), Vec3::Zero()};  ///< of gyro and accelerometer
    Scalar square[2] = {0, 0};                    ///< sums of squares about the means, over the axes
  };

  void begin();
  void keep_pixels();
  void add(const ImuSample& sample);
  bool is_quiet() const;
  bool has_moved();

  const Settings& settings_;
  const Frame& frame_;
  const ImuLog& imu_;
  Seen* seen_ = nullptr;  ///< kMaxPixels; null without the inertial motion model, which needs no room then
  Data* data_ = nullptr;  ///< likewise
};

}  // namespace pf
