#include "keyframe_slam/start/keyframe_record.h"

#include <algorithm>

#include "base/elapsed.h"
#include "base/table_entries.h"
#include "frame/start/tuning.h"
#include "frame/tuning.h"
#include "geometry/so3.h"
#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/map/keyframe_upkeep.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/start/tuning.h"
#include "keyframe_slam/tracking/frame_time.h"

namespace pf {

using namespace tuning::keyframe_start;

bool KeyframeRecord::layout(Arena& arena) {
  rotation_.layout(arena);
  rho_ = arena.take<Scalar>(StartRecord::kMaxFeatures);
  return solver_.layout(arena, readout_prior(settings_.lens).rows.count);
}

void KeyframeRecord::init() {
  solved_before_ = 0;
  solver_.init();
}

void KeyframeRecord::begin() {
  init();
  solver_.begin();
}

void KeyframeRecord::begin_at_keyframe() {
  if (!progress().recording || !solver_.empty()) return;
  const Body& body = motion_.body();
  std::fill(rho_, rho_ + StartRecord::kMaxFeatures, Scalar(1));
  solver_.begin_record(body.q_WC, body.p_W, frame_.report.t_ns);
  free_readout();
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    Vec3 ray_C;
    if (match.status != MatchStatus::kNew || match.feature < 0) continue;
    if (unproject(map_.camera(), match.measured, &ray_C)) solver_.add_feature(match.id, ray_C);
  }
}

bool KeyframeRecord::follow() {
  const StartOutcome outcome = rotation_.measure(solver_.base_p_W()) ? record_frame() : StartOutcome::kTooFew;
  switch (outcome) {
    case StartOutcome::kWait:
      wait();
      return false;
    case StartOutcome::kSolved:
    case StartOutcome::kSettled:
      solver_.log(outcome, settings_.hooks);
      take_solution();
      tracking_.belief().trust();
      return true;
    case StartOutcome::kStill:  // what moves has drawn the pose along
      motion_.move(solver_.base_q_WC(), solver_.base_p_W());
      solver_.log(outcome, settings_.hooks);
      return false;
    case StartOutcome::kTooFew:
      begin_again();
      return false;
  }
  return false;
}

bool KeyframeRecord::improve() {
  ++solved_before_;
  const StartOutcome outcome = record_frame();
  if (outcome != StartOutcome::kSolved && outcome != StartOutcome::kSettled) return false;
  keep_first_keyframe(&map_);
  take_solution();
  return true;
}

bool KeyframeRecord::is_improving() const {
  return progress().recording && !(progress().depth_known && solved_before_ > kPatience);
}

void KeyframeRecord::note_keyframe() {
  if (progress().depth_known && !is_improving()) solver_.init();
}

/// Of a match of the record, at the frame's time. An accepted one has it already.
Vec2 KeyframeRecord::pixel_of(const Match& match) const {
  if (!has_rows(map_.camera())) return match.measured;
  if (match.status == MatchStatus::kInlier) return map_.point(match.feature).pixel;
  return progress().depth_known ? match_at_frame_time(map_, match, prior_of(motion_), settings_.start_depth)
                                : followed_at_frame_time(map_, match, frame_.report.t_ns);
}

StartOutcome KeyframeRecord::record_frame() {
  const Body& body = motion_.body();
  solver_.begin_frame(body.q_WC, body.p_W, frame_.report.t_ns);
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    // A match that the last depths reject may fit the next ones, and the adjustment is robust.
    if (match.feature >= 0 && (match.status == MatchStatus::kInlier || match.status == MatchStatus::kOutlier))
      solver_.add_pixel(map_.camera(), match.id, pixel_of(match));
  }
  return solver_.solve(map_.camera(), tuning::noise::kSearchSigma, settings_.start_depth);
}

/// Not enough parallax yet: improves the pose. Points were last seen from poses of the record, which have been adjusted as well; the next
/// frame searches for them from there.
void KeyframeRecord::wait() {
  const CameraView now = solver_.follow(map_.camera(), tuning::noise::kSearchSigma, settings_.start_depth, rho_);
  motion_.move(now.q_WC, now.c_W);
  for (const int i : used_entries(map_)) move_view(&map_.point(i), map_.feature(i).last_seen_ns);
  Body body = motion_.body();
  set_speeds(&body);
  motion_.set_velocities(body.v_W, body.w_C);
}

/// Only rotation so far, or too few features in view: the world stays, and the record begins again with this frame.
void KeyframeRecord::begin_again() {
  map_.clear();
  frame_.report.inliers = 0;
  begin();
  tracking_.set_has_pose(frame_.report.t_ns);
  add_keyframe(frame_, motion_.view(), settings_.window_keyframes, &map_);
}

/// A point that was last seen in a frame of the record was seen from that frame's adjusted pose.
void KeyframeRecord::move_view(KeyframePoint* point, std::int64_t seen_ns) const {
  const StartRecord& record = solver_.record();
  for (int k = record.frames() - 1; k >= 0; --k) {
    if (record.frame(k).t_ns != seen_ns) continue;
    point->seen_from = solver_.view(k);
    return;
  }
}

/// Velocities between the last frames of the record.
void KeyframeRecord::set_speeds(Body* body) const {
  const StartRecord& record = solver_.record();
  const int last = record.frames() - 1, before = std::max(0, last - kSpeedFrames);
  if (!(settings_.constant_velocity || settings_.inertial) || before >= last) return;
  const CameraView then = solver_.view(before), now = solver_.view(last);
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(record.frame(before).t_ns, record.frame(last).t_ns)));
  body->v_W = (now.c_W - then.c_W) / dt;
  body->w_C = log_so3(then.q_WC.conjugate() * now.q_WC) / dt;
}

/// Of the first keyframe, where the readout of its rows is uncertain, by the record's first frames.
void KeyframeRecord::set_first_speeds() {
  const StartRecord& record = solver_.record();
  const int after = std::min(kSpeedFrames, record.frames()) - 1;
  if (!map_.lens().rows().has_readout() || after < 0) return;
  for (const int k : used_entries(map_.keyframes)) {
    Keyframe& first = map_.keyframes[k];
    if (!map_.keyframes.is_first(k)) continue;
    const CameraView now = solver_.view(after);
    const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(first.t_ns, record.frame(after).t_ns)));
    if (!(dt > Scalar(0))) continue;
    first.v_W = (now.c_W - first.p_W) / dt;
    first.w_C = log_so3(first.q_WC.conjugate() * now.q_WC) / dt;
  }
}

/// Where the solution has the frame of the second pose that the caller gave.
void KeyframeRecord::note_second_pose() {
  const StartRecord& record = solver_.record();
  for (int k = 0; k < record.frames() && second_.given; ++k) {
    if (!second_.is_frame(record.frame(k).t_ns)) continue;
    second_.estimated = true;
    second_.estimate_W = solver_.view(k).c_W;
  }
}

/// Depths of the solution. Points that it has none for leave the map; those that are not in the record lose theirs.
void KeyframeRecord::take_points() {
  const StartRecord& record = solver_.record();
  for (const int i : used_entries(map_)) {
    const int index = solver_.index_of(map_.feature(i).id);
    KeyframePoint& point = map_.point(i);
    if (index >= 0 && !solver_.bundle().good(index)) {
      map_.drop(i);
      continue;
    }
    point.has_depth = index >= 0;  // others are by poses that are no longer
    if (index >= 0) {
      point.ray_K = record.ray(index).normalized();
      point.rho = solver_.bundle().rho(index) / record.ray(index).norm();
    }
    move_view(&point, map_.feature(i).last_seen_ns);
  }
}

/// A readout that nothing tells is an unknown of the record's solution, whose depths it would bend.
void KeyframeRecord::free_readout() {
  const LensPrior prior = readout_prior(settings_.lens);
  if (prior.rows.count > 0) solver_.free_lens(settings_.camera, prior, map_.camera());
}

/// The map's pixels are those of their frames' times by the solution's readout, which is what adjustments begin with.
void KeyframeRecord::take_readout() {
  const Camera* const solved = solver_.bundle().lens();
  if (solved == nullptr) return;
  Camera camera = map_.camera();
  camera.readout = solved->readout;
  map_.move_lens(camera);
  map_.lens().begin_readout(solved->readout, solver_.bundle().readout_variance());
  for (const int i : used_entries(map_)) {
    const int index = solver_.index_of(map_.feature(i).id);
    if (index >= 0) map_.point(i).ray_K = solver_.record().ray(index).normalized();
  }
}

/// Depths and poses of the solved record. The frame becomes a keyframe, and velocities are those of the record's last frames.
void KeyframeRecord::take_solution() {
  solved_before_ = 0;
  const CameraView now = solver_.view(solver_.record().frames() - 1);
  note_second_pose();
  set_first_speeds();
  take_points();
  Body body = motion_.body();
  body.q_WC = now.q_WC;
  body.p_W = now.c_W;
  set_speeds(&body);
  Mat6 P = Mat6::Identity() * (kRotationSigma * kRotationSigma);
  P.bottomRightCorner<3, 3>() *= settings_.start_depth * settings_.start_depth;
  motion_.set(body, P, kSpeedSigma * settings_.start_depth, tuning::filter_start::kStartRate);
  const int keyframe = add_keyframe(frame_, now, settings_.window_keyframes, &map_);
  map_.keyframes[keyframe].v_W = body.v_W;
  map_.keyframes[keyframe].w_C = body.w_C;
  take_readout();
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature >= 0 && match.status == MatchStatus::kInlier) map_.point(match.feature).seen_from = now;
  }
  for (const int i : used_entries(map_))
    if (map_.point(i).has_depth) map_.point(i).variance = depth_by_pixels(map_, i, noise_.sigma_info()).variance;
  if (!progress().recording) solver_.init();
}

}  // namespace pf
