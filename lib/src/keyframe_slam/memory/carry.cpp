#include "vision/carry.h"

#include "base/archive.h"
#include "keyframe_slam/memory/keyframe_recall.h"
#include "keyframe_slam/memory/map_join.h"
#include "keyframe_slam/memory/map_saving.h"

namespace pf {

void KeyframeRecall::carry(Archive& archive) { recall_.carry(archive); }

void JoinFinder::carry(Archive& archive) {
  for (MapJoin* join : {&before_, &found_}) {
    auto& [map_id, T, view, covariance, sigma_scale] = *join;
    auto& [q, t, s] = T;
    archive.any(map_id);
    archive.numbers(q, t, s, covariance, sigma_scale);
    pf::carry(archive, view);
  }
}

void MapSaving::carry(Archive& archive) { archive.flags(is_loaded_); }

}  // namespace pf
