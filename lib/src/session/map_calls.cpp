#include "session/map_calls.h"

#include "filter_slam/filter_slam.h"
#include "keyframe_slam/keyframe_slam.h"

namespace pf {

Status MapCalls::load(const std::uint8_t* buffer, std::size_t bytes, const char** wrong, Vec3* gravity_W) {
  if (!kHasMemory || settings_.kept.places == 0) return Status::kState;
  const bool has_window = kHasWindow && window_ != nullptr;
  const Frame& frame = has_window ? window_->frame() : filter_->frame();
  if (frame.report.frames > 0) return Status::kState;
  SavedMap saved;
  *wrong = saved.open(buffer, bytes,
                      has_window ? window_->mapping().saving().scratch() : filter_->upkeep().memory()->scratch());
  if (*wrong != nullptr) return Status::kMap;
  *gravity_W = saved.gravity_W();
  return has_window ? window_->start().use_map(saved) : filter_->start().use_map(saved, filter_->upkeep().memory());
}

Status MapCalls::add_anchor(const AnchorRequest& asked, std::uint32_t* id) {
  if (!kHasMemory) return Status::kFull;
  if (!kHasWindow || filter_ != nullptr) return filter_->add_anchor(asked, id);
  if (window_->tracking().state() != SlamState::kTracking) return Status::kState;
  const Body& body = window_->motion().body();
  const KeyframeAnchors::View view = {{body.q_WC, body.p_W},
                                      window_->motion().pose_covariance(),
                                      window_->placement().map_covariance(window_->motion().body().p_W),
                                      window_->median_depth(),
                                      window_->frame().report.t_ns};
  KeyframeAnchors anchors(map_.anchors, window_->map(), window_->placement().planes());
  return anchors.add(asked, window_->tracking().map_id(), view, id);
}

Status MapCalls::remove_anchor(std::uint32_t id) {
  const int entry = map_.anchors.entry_of(id);
  if (entry < 0) return Status::kNothing;
  if (!kHasWindow || filter_ != nullptr)
    filter_->upkeep().anchors().remove(entry);
  else
    map_.anchors.remove(entry);
  return Status::kOk;
}

}  // namespace pf
