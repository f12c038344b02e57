#include "filter_slam/map_upkeep.h"

namespace pf {

bool MapUpkeep::layout(Arena& arena) {
  features_.layout(arena, settings_.max_features);
  planes_.layout(arena, settings_.max_features);
  if (kHasMemory && settings_.kept.places > 0)
    memory_ = arena.place<FilterMemory>([&](FilterMemory& made) { made.layout(arena); }, settings_, filter_, map_,
                                        frame_, features_);
  return layout_patches(arena);
}

/// Patches take nothing where there are none.
bool MapUpkeep::layout_patches(Arena& arena) {
  if (!kHasWalls || settings_.max_patches == 0) return arena.ok();
  patches_ = arena.place<PatchKeeper>([&](PatchKeeper& made) { made.layout(arena); }, settings_, filter_, map_, frame_,
                                      features_, tracking_);
  return arena.ok();
}

void MapUpkeep::init() {
  planes_.init();
  if (patches_ != nullptr) patches_->init();
  if (memory_ != nullptr) memory_->init();
}

void MapUpkeep::follow_places(bool is_starting, Scalar depth) {
  if (memory_ == nullptr || is_starting || !tracking_.is_tracked(frame_.report)) return;
  const Body& body = filter_.state().body;
  memory_->follow({body.q_WC, body.p_W}, depth);
}

void MapUpkeep::maintain(bool supported, const StartProgress& start) {
  mark_.drop_unsound();
  if (!supported) {
    features_.drop_failing(false);
    return;
  }
  features_.convert_linear();
  // From the first depths on. While a start's record goes on the filter may restart, which removes the planes; nothing begins on them then,
  // since the record needs features of open depth.
  if (settings_.planes && !start.pending()) planes_.maintain(!start.checking);
  for (int i = 0; start.recording && i < map_.planes.capacity(); ++i) map_.planes[i].age = 0;
  features_.drop_failing(true);
}

/// As for features: a frame that does not support its pose begins patches only where there is nothing that could be found again.
void MapUpkeep::maintain_patches(const Pyramid& image, bool supported, const StartProgress& start, bool is_first) {
  if (patches_ == nullptr) return;
  const bool empty = is_first || (map_.features.count() == 0 && patches_->patches().count() == 0);
  const bool may_begin = tracking_.is_tracked(frame_.report) || (empty && frame_.report.attempts == 0);
  patches_->maintain(image, supported, may_begin && !start.recording);
}

bool MapUpkeep::repair_estimate() {
  if (tracking_.updates_fail()) return false;
  const BlockFilter::Repair repair = filter_.repair(frame_.report.frames);
  if (repair == BlockFilter::Repair::kDone) count_frame(&frame_.report.repairs);
  return repair != BlockFilter::Repair::kImpossible && filter_.body_is_sound();
}

Status MapUpkeep::set_plane_vertical(std::uint32_t id, Scalar sigma) {
  if (!settings_.inertial || !tracking_.has_pose() || !filter_.is_metric()) return Status::kState;
  const int entry = map_.planes.entry_of(id);
  if (entry < 0) return Status::kNothing;
  const Status status = planes_.verticals().tell(entry, sigma);
  if (status == Status::kOk) anchors_.follow(tracking_.map_id(), frame_.report.t_ns);
  return status;
}

}  // namespace pf
