#pragma once

#include <cstdint>

#include "filter/imu_log.h"
#include "filter/inertial_motion.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "inertial/unit_noise.h"

/// Detects a camera at rest from the samples of its inertial unit and the image together: samples do not show a slow turntable, and the
/// image does not show motion together with the scene (lib/docs/theory/inertial.md).

namespace pf {

class Archive;

class RestDetector {
 public:
  RestDetector(const Settings& settings, const Frame& frame, const ImuLog& imu, const UnitNoise& noise)
      : settings_(settings), frame_(frame), imu_(imu), noise_(noise) {}

  void layout(Arena& arena);
  void init() {
    if (data_ != nullptr) *data_ = Data();
  }
  /// After a frame. seen: its measurements support its pose. True when the camera has been at rest for a second up to this frame; *rest
  /// then has the means of that second's samples, and the next second begins.
  bool note(bool seen, RestReading* rest);
  /// When the last second at rest began, in the time of frames.
  std::int64_t begin_ns() const { return data_->rest_begin_ns; }
  /// Before a frame is measured, dt [s] after the last one, of a camera that has been at rest for at least a second: the means of the
  /// samples since then. False where they are too few for that time.
  bool read_frame(Scalar dt, StillReading* still) const;
  /// How far the image has moved since this rest began, as a mean over some frames; at least the least motion that can be distinguished
  /// from none [px].
  Scalar motion_px() const;
  /// After a map that began anew during the rest: compares the image with the mean of the next second.
  void begin_pixels_anew();
  /// The camera moves, by other evidence.
  void end_rest() { data_->rested = 0; }
  bool is_resting() const { return data_ != nullptr && data_->rested > Scalar(0); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMaxPixels = 60;

  using Vec4 = Eigen::Matrix<Scalar, 4, 1>;

  /// Pixel of a feature at the beginning of this second, or its mean over the first second of this rest or map.
  struct Seen {
    std::uint32_t id;
    int count;
    Vec2 pixel;
  };

  struct Data {
    bool begun = false;
    std::int64_t begin_ns = 0;  ///< of this second
    std::int64_t rest_begin_ns = 0;
    std::int64_t sample_ns = 0;  ///< time of the last sample that was added
    int count = 0;
    int seen = 0;
    Scalar motion2 = 0;                           ///< [px^2] of the picture since this second began
    Vec3 mean[2] = {Vec3::Zero(), Vec3::Zero()};  ///< of gyro and accelerometer
    Scalar square[2] = {0, 0};                    ///< sums of squares about the means, over the axes
    // Of the whole rest.
    Scalar rested = 0;              ///< [s] since it began, once its first second has passed
    std::int64_t first_ns = 0;      ///< when it began
    std::int64_t mean_ns = 0;       ///< when the second began whose mean pixels it is compared with
    int first = 0;                  ///< these pixels
    bool anew = false;              ///< they begin with the next frame
    Vec4 motion_px = Vec4::Zero();  ///< of the picture since then, a running mean over frames
    Scalar scatter[2] = {1, 1};     ///< of the samples in the last second, in that of their densities; at least 1
  };

  void begin(bool rests_on);
  void keep_pixels();
  void keep_first();
  void add(const ImuSample& sample);
  void compare_with_first();
  bool covers(int count, Scalar T) const;
  bool is_quiet();
  bool has_moved();
  bool motion_since(const Seen* before, int count, Vec4* motion_px) const;

  const Settings& settings_;
  const Frame& frame_;
  const ImuLog& imu_;
  const UnitNoise& noise_;
  Seen* seen_ =
      nullptr;  ///< 2 kMaxPixels: of this second, of the first one; null without the inertial motion model, which needs no room then
  Data* data_ = nullptr;  ///< the same
};

}  // namespace pf
