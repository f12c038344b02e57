#pragma once

#include <cstdint>

#include "base/arena.h"
#include "map/map.h"

/// Pixels that the caller has found and recognised, in place of an image.

namespace pf {

struct PixelObservation {
  std::uint32_t external_id;
  Vec2 pixel;
  Scalar sigma_px;
};

/// Those of one frame, by the features that they measure.
class GivenPixels {
 public:
  /// max_features: of the table; room: for the pixels of one frame.
  bool layout(Arena& arena, int max_features, int room);
  /// Where the pixels of the next frame are written.
  PixelObservation* inbox() { return inbox_; }

  /// The frame has the first `count` of the inbox. Of an id that comes twice the first counts.
  void begin(int count, const FeatureTable& features);
  /// The frame has an image.
  void end() { are_given_ = false; }
  bool are_given() const { return are_given_; }
  /// What measures a feature; null: nothing.
  const PixelObservation* of(int entry) const { return at_[entry] >= 0 ? &inbox_[at_[entry]] : nullptr; }
  int count() const { return count_; }
  const PixelObservation& operator[](int k) const { return inbox_[k]; }

 private:
  PixelObservation* inbox_ = nullptr;
  std::int16_t* at_ = nullptr;  ///< of each feature, -1: none
  int count_ = 0;
  bool are_given_ = false;
};

}  // namespace pf
