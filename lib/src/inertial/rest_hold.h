#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter/imu_log.h"
#include "frame/settings.h"
#include "inertial/body_motion.h"
#include "inertial/rest_detector.h"

/// Holds the body while it is at rest: its pose stays, its velocity is zero, and samples are measurements of biases and gravity instead of
/// motion. See lib/docs/theory/inertial.md.

namespace pf {

class Archive;

class RestHold {
 public:
  RestHold(const Settings& settings, Filter& filter, RestDetector& rest, const ImuLog& imu, const BodyMotion& motion)
      : settings_(settings), filter_(filter), rest_(rest), imu_(imu), motion_(motion) {}

  void init() { data_ = Data(); }
  /// Predicts the body from one frame's time to the next where it is at rest. follows: the frame before was tracked. depth: median, of the
  /// measured points. False, with nothing changed, where the body is not at rest, by the detector until the last frame, or by this frame's
  /// samples.
  bool predict(bool follows, std::int64_t before_ns, std::int64_t t_ns, Scalar depth);
  /// Undoes the prediction of a frame whose image contradicts the rest.
  void take_back();
  /// Ends a frame, after the detector has noted it.
  void end_frame(std::int64_t t_ns);
  /// In this frame.
  bool holds() const { return data_.holds; }
  /// Time at which motion begins in a prediction from now_ns: there, or earlier by the time in which samples may have missed its beginning.
  std::int64_t motion_begin_ns(std::int64_t now_ns) const;
  /// Notes that the body has been predicted from motion_begin_ns.
  void note_motion() { data_.late_count = 0; }
  /// True after a rest while samples alone still measure the camera's motion well.
  bool has_just_ended(std::int64_t t_ns);
  /// Ends the time in which samples alone are taken to measure motion well, by other evidence.
  void forget() { data_.last_ns = INT64_MIN; }
  /// Time at which this frame's prediction began.
  std::int64_t before_ns() const { return data_.before_ns; }
  /// Number of rests that have begun.
  int rests() const { return rests_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMaxLate = 8;

  /// Readings of a held frame that no later frame has confirmed to be of a body at rest yet.
  struct Late {
    std::int64_t before_ns;
    StillReading still;
  };

  struct Data {
    bool holds = false;
    std::int64_t before_ns = 0;
    std::int64_t last_ns = INT64_MIN;  ///< of the last frame that was held; INT64_MIN: there was none
    Scalar moved_px = 0;               ///< motion that the pose was given as noise since the rest began
    Scalar sigma_rad = 0, dt = 0;      ///< of this frame's prediction
    Scalar m_per_px = 0;
    StillReading still;
    Late late[kMaxLate];
    int late_count = 0;
  };

  bool follow_rest(bool follows, std::int64_t before_ns, std::int64_t t_ns, Scalar depth);
  void begin_rest();
  void leave();
  void end_rest();
  void take_late();
  void move(Scalar sign);

  const Settings& settings_;
  Filter& filter_;
  RestDetector& rest_;
  const ImuLog& imu_;
  const BodyMotion& motion_;
  int rests_ = 0;
  Data data_;
};

}  // namespace pf
