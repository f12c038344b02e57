#include "session/session.h"

namespace pf {

bool Session::layout(Arena& arena, const Settings& settings) {
  settings_ = settings;
  const bool has_window = kHasWindow && settings.backend == BackEnd::kWindow;
  map_.layout(arena, settings.max_features, settings.max_planes,
              settings.masks == MaskMode::kNone ? 0 : settings.template_px, settings.kept.anchors);
  imu_.layout(arena, settings.imu.buffer);
  if (settings.mask.is_asked_for) mask_.layout(arena, settings.camera.width, settings.camera.height);
  settings_.mask.mask = settings.mask.is_asked_for ? &mask_ : nullptr;
  const auto lay_out = [&](auto& back_end) { back_end.layout(arena); };
  if (has_window)
    window_ = arena.place<KeyframeSlam>(lay_out, settings_, map_, imu_);
  else
    filter_ = arena.place<FilterSlam>(lay_out, settings_, map_, imu_);
  return arena.ok();
}

void Session::init() {
  data_ = Data();
  map_.init();
  if (settings_.mask.mask != nullptr) mask_.init();
  imu_.init(settings_.imu.buffer, settings_.imu.ranges);
  if (has_filter())
    filter_->init();
  else
    window_->init();
  if (settings_.readout_ignored)
    settings_.hooks.say("camera.readout_s counts as 0: nominal timestamps give rows no time of their own");
}

Status Session::start_from_target(const Target& target) {
  if (view().used()) return Status::kState;
  return has_filter() ? filter_->start().use_target(target) : window_->start().use_target(target);
}

Status Session::start_from_pose(const KnownBody& known) {
  if (view().used()) return Status::kState;
  return has_filter() ? filter_->start().use_pose(known) : window_->start().use_pose(known);
}

Vec3 Session::given_gravity_W() const {
  return data_.gravity_map == view().tracking().map_id() ? data_.gravity_W : Vec3::Zero();
}

Status Session::push_frame(const ImageView& image, std::int64_t t_ns) {
  data_.kind = FrameKind::kImages;
  imu_.mark_frame(t_ns);
  return has_filter() ? filter_->push_frame(image, t_ns) : window_->push_frame(image, t_ns);
}

Status Session::push_observations(int count, std::int64_t t_ns) {
  data_.kind = FrameKind::kObservations;
  imu_.mark_frame(t_ns);
  return filter_->push_observations(inbox(), count, t_ns);
}

}  // namespace pf
