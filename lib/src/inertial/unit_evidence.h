#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "frame/frame.h"
#include "inertial/unit_mode.h"
#include "inertial/unit_noise.h"

/// Evidence against an inertial unit whose samples move the body, frame by frame. See lib/docs/theory/inertial.md.
///
/// Each frame's innovation of the pose is chi-square with six degrees of freedom. The unit's noise is learned from it (UnitNoise).
/// Innovations that not even ten times the stated noise explains add up in Page's sum (CUSUM), which detects any fault soon:
///
///   s+ = max(0, s + nis - slack),   contradicted where s > bound

namespace pf {

class Archive;

/// How a frame was measured.
struct UnitFrame {
  bool before_was_tracked = false;  ///< the frame before, and so was the pose that this one's prediction begins at
  bool is_tracked = false;
  bool is_taken_back = false;       ///< it was predicted again without samples
  bool is_worse_than_none = false;  ///< and samples had predicted it worse than none
  std::int64_t dt_ns = 0;           ///< since the frame before
};

class UnitEvidence {
 public:
  UnitEvidence(const Filter& filter, const Frame& frame, UnitNoise& noise)
      : filter_(filter), frame_(frame), noise_(noise) {}

  void init() { data_ = Data(); }
  /// Samples are used from now on.
  void begin_use() { data_.sum = 0, data_.used_ns = 0; }
  /// Samples are not used from now on.
  void end_use() { data_.sum = 0; }
  /// Notes any frame.
  void note_frame() {
    if (!filter_.is_metric()) data_.metric_ns = data_.sound_ns = 0;
  }
  /// Updates the unit's noise from a frame with samples.
  void learn_noise(const UnitFrame& frame);
  /// After learn_noise(): adds the frame to the sum. True where the sum is above its bound in this mode.
  bool add(const UnitFrame& frame, UnitMode mode);
  /// Page's sum.
  Scalar sum() const { return data_.sum; }
  /// Counts a rejection of the unit.
  void count_doubt();
  /// How often the unit was rejected.
  int doubts() const { return data_.doubts; }
  UnitUse use() const;
  /// True where samples may have been wrong since so soon after the map became metric that its scale depends on them alone.
  bool is_map_on_trial() const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    Scalar sum = 0;
    int doubts = 0;
    std::int64_t used_ns = 0;    ///< since it was last rejected
    std::int64_t metric_ns = 0;  ///< for how long the map has been tracked in metres
    std::int64_t sound_ns = 0;   ///< the same when the sum was zero last: since then the samples may have been wrong
  };

  Scalar contradiction(const UnitFrame& frame) const;

  const Filter& filter_;
  const Frame& frame_;
  UnitNoise& noise_;
  Data data_;
};

}  // namespace pf
