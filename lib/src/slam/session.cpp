#include "slam/session.h"

#include <new>

namespace pf {

bool Session::layout(Arena& arena, const Settings& settings) {
  settings_ = settings;
  map_.layout(arena, settings.max_features, settings.max_planes,
              settings.masks == MaskMode::kNone ? 0 : settings.template_px);
  imu_.layout(arena, settings.imu_buffer);
  FrameLoop* place = arena.take<FrameLoop>(1);
  if (place == nullptr) return FrameLoop(settings_, map_, imu_).layout(arena);
  filter_ = new (place) FrameLoop(settings_, map_, imu_);
  return filter_->layout(arena);
}

void Session::init() {
  data_ = Data();
  map_.init();
  imu_.init(settings_.imu_buffer, settings_.imu_ranges);
  filter_->init();
  if (settings_.readout_ignored)
    settings_.hooks.say("nominal timestamps give rows no time of their own: the rolling shutter counts as global");
}

Status Session::start_from_target(const Target& target) {
  return view().used() ? Status::kState : filter_->start().use_target(target);
}

Status Session::start_from_pose(const KnownBody& known) {
  return view().used() ? Status::kState : filter_->start().use_pose(known);
}

Vec3 Session::gravity_W() const {
  if (data_.gravity_map == view().map_id() && data_.gravity_W.squaredNorm() > Scalar(0)) return data_.gravity_W;
  InertialView unit;
  return view().inertial(&unit) && unit.metric ? unit.gravity_W : Vec3::Zero();
}

Status Session::push_frame(const ImageView& image, std::int64_t t_ns) {
  data_.kind = FrameKind::kImages;
  imu_.mark_frame(t_ns);
  return filter_->push_frame(image, t_ns);
}

Status Session::push_observations(int count, std::int64_t t_ns) {
  data_.kind = FrameKind::kObservations;
  imu_.mark_frame(t_ns);
  return filter_->push_observations(inbox(), count, t_ns);
}

}  // namespace pf
