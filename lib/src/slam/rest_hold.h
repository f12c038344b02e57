#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "slam/body_motion.h"
#include "slam/rest_detector.h"
#include "slam/settings.h"

/// Holds the body while it is at rest: its pose stays, its velocity is zero, and samples are measurements of biases and gravity instead of
/// motion. See lib/docs/inertial.md.

namespace pf {

class RestHold {
 public:
  RestHold(const Settings& settings, Filter& filter, RestDetector& rest)
      : settings_(settings), filter_(filter), rest_(rest) {}

  void init() { data_ = Data(); }
  /// Predicts the body from one frame's time to the next where it is at rest. follows: the frame before was tracked. depth: the median
  /// one of what is seen. False, with nothing changed, where it is not: by what the detector saw until the last frame, or by this
  /// frame's samples.
  bool predict(bool follows, std::int64_t before_ns, std::int64_t t_ns, Scalar depth);
  /// The picture contradicts that: nothing is predicted yet.
  void take_back();
  /// After the detector has seen the frame too.
  void end_frame();
  /// In this frame.
  bool holds() const { return data_.holds; }
  /// When its prediction began.
  std::int64_t before_ns() const { return data_.before_ns; }
  /// Rests that have begun, in all.
  int rests() const { return rests_; }

 private:
  struct Data {
    bool holds = false;
    std::int64_t before_ns = 0;
    Scalar moved_px = 0;           ///< that the pose has been allowed since the rest began
    Scalar sigma_rad = 0, dt = 0;  ///< of this frame's prediction
    Scalar m_per_px = 0;
    StillReading still;
  };

  bool follow_rest(bool follows, std::int64_t before_ns, std::int64_t t_ns, Scalar depth);
  void begin_rest();
  void leave();
  void end_rest();
  void move(Scalar sign);

  const Settings& settings_;
  Filter& filter_;
  RestDetector& rest_;
  int rests_ = 0;
  Data data_;
};

}  // namespace pf
