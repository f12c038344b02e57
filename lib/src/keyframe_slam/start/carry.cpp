#include "frame/start/carry.h"

#include "keyframe_slam/start/keyframe_record.h"
#include "keyframe_slam/start/keyframe_start.h"

namespace pf {

void KeyframeRecord::carry(Archive& archive) {
  if (archive.is_reading()) free_readout();
  solver_.carry(archive);
  archive.counts(solved_before_);
  for (int i = 0; i < solver_.record().features(); ++i) archive.numbers(rho_[i]);
}

void KeyframeStart::carry(Archive& archive) {
  pf::carry(archive, known_);
  target_.carry(archive);
  archive.flags(has_place_);
}

}  // namespace pf
