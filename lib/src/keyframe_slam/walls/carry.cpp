#include "base/archive.h"
#include "keyframe_slam/walls/keyframe_walls.h"

namespace pf {

/// Between comparisons the mean of g is zero.
void WallGauge::carry(Archive& archive) {
  archive.flags(has_begun_);
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j <= i; ++j) {
      archive.numbers(at(i, j));
      if (archive.is_reading()) at(j, i) = at(i, j);
    }
  for (int k = 0; k < walls_; ++k) {
    archive.numbers(wall_[k]);
    archive.flags(has_[k]);
  }
}

void KeyframeWalls::carry(Archive& archive) {
  gauge_.carry(archive);
  archive.any(random_, newest_compared_);
  for (int k = 0; k < gauge_.capacity(); ++k) {
    int count = compared_[k];
    archive.within(count, 0, UINT16_MAX);
    if (archive.is_reading()) compared_[k] = count;
  }
}

}  // namespace pf
