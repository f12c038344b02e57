#include "frame/kept/carry.h"

#include "base/archive.h"
#include "keyframe_slam/inertial/keyframe_unit.h"
#include "vision/carry.h"

namespace pf {

void MapRuler::carry(Archive& archive) {
  archive.within(place_slot_, -1, filter_.state().slots - 1);
  archive.within(length_slot_, -1, filter_.state().slots - 1);
  archive.numbers(z_o_, length_);
}

/// A filter that has begun has the two blocks of its ruler, and they are what they are taken for.
void KeyframeUnit::carry(Archive& archive) {
  if (parts_ == nullptr) return;
  auto& [has_begun, is_from_motion, has_other, is_again, follows, begin_ns, left, newest] = data_;
  archive.flags(has_begun, is_from_motion, has_other, is_again, follows);
  archive.any(begin_ns, newest);
  pf::carry(archive, left);
  auto& [filter, ruler, motion, mounting, rest, watch, hold, moving, forces] = *parts_;
  filter.carry(archive);
  ruler.carry(archive);
  motion.carry(archive);
  mounting.carry(archive);
  rest.carry(archive);
  watch.carry(archive);
  hold.carry(archive);
  moving.carry(archive);
  forces.carry(archive);
  if (archive.is_reading() && has_begun) archive.require(ruler.is_sound());
}

}  // namespace pf
