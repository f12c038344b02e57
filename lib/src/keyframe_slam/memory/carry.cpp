#include "base/archive.h"
#include "keyframe_slam/memory/keyframe_recall.h"
#include "keyframe_slam/memory/map_saving.h"

namespace pf {

void KeyframeRecall::carry(Archive& archive) { recall_.carry(archive); }

void MapSaving::carry(Archive& archive) { archive.flags(is_loaded_); }

}  // namespace pf
