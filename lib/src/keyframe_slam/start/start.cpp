#include "keyframe_slam/start/start.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "bundle/rotation_fit.h"
#include "frame/start/target_surface.h"
#include "frame/start/tuning.h"
#include "frame/tuning.h"
#include "geometry/so3.h"
#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {

using namespace tuning::keyframe_start;
namespace assumed = tuning::filter_start;

bool KeyframeStart::layout(Arena& arena) {
  const std::size_t points = static_cast<std::size_t>(settings_.max_features);
  ray_ = arena.take<Vec3>(points);
  pixel_ = arena.take<BundlePixel>(points);
  scratch_ = arena.take<Scalar>(points);
  record_rho_ = arena.take<Scalar>(StartRecord::kMaxFeatures);
  target_.layout(arena, settings_.camera.width, settings_.camera.height);
  return without_.layout(arena);
}

void KeyframeStart::init() {
  data_ = Data();
  target_.init();
  without_.init();
}

void KeyframeStart::start_over() {
  clear_map();
  without_.init();
  data_.known = KnownBody();
  data_.second = SecondPose();
  if (parts_.map.tables().target_withdrawn) target_.init();
}

void KeyframeStart::clear_map() {
  parts_.frame.forget_all();
  parts_.map.tables().features.clear();
  parts_.map.tables().planes.clear();
  parts_.map.init();
}

Status KeyframeStart::use_target(const Target& target) {
  if (data_.second.given) return Status::kState;
  if (data_.known.given && target.kind == TargetKind::kRectangle) return Status::kState;
  target_.set_target(target);
  return Status::kOk;
}

Status KeyframeStart::use_pose(const KnownBody& known) {
  if (target_.target().kind == TargetKind::kRectangle) return Status::kState;
  data_.known = known;
  data_.known.given = true;
  return Status::kOk;
}

Status KeyframeStart::use_second_pose(std::int64_t t_ns, const Vec3& p_W) {
  if (target_.target().kind != TargetKind::kNone || data_.second.given) return Status::kState;
  data_.second = SecondPose();
  data_.second.given = true;
  data_.second.t_ns = t_ns;
  data_.second.p_W = p_W;
  return Status::kOk;
}

void KeyframeStart::end_second_pose() {
  data_.second = SecondPose();
  without_.init();
}

/// The pose before the first measurement: the one that the caller gave, that of the target, or the one that defines the world.
void KeyframeStart::set_pose(bool at_target) {
  const int dim = settings_.body.known_rows();
  Body body = at_target ? target_.target().first_pose : Body();
  Mat6 P = at_target ? target_.target().first_covariance
                     : Mat6(Mat6::Identity() * (assumed::kDefinedSigma * assumed::kDefinedSigma));
  Scalar speed = assumed::kStartSpeed * (at_target ? Scalar(1) : settings_.start_depth), rate = assumed::kStartRate;
  if (data_.known.given) {
    body = data_.known.body;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) P(i, j) = data_.known.covariance[i * dim + j];
    const auto sigma = [&](int first) {
      Scalar trace = 0;
      for (int i = first; i < first + 3; ++i) trace += data_.known.covariance[i * dim + i];
      return std::sqrt(trace / 3);
    };
    if (settings_.constant_velocity) {
      speed = sigma(settings_.body.row(BodyPart::kVelocity));
      rate = sigma(settings_.body.row(BodyPart::kAngularVelocity));
    }
  }
  parts_.motion.set(body, P, speed, rate);
  parts_.tracking.set_has_pose(parts_.frame.report.t_ns);
}

bool KeyframeStart::start_in_image() {
  FrameReport& report = parts_.frame.report;
  TargetSighting sighting;
  const bool expected = target_.is_expected();
  const bool seen = expected && target_.find(parts_.map.camera(), parts_.measuring.tracker(), &sighting);
  if (!seen && expected && !parts_.tracking.may_skip_target()) return false;
  target_.note_begin();
  if (seen && report.frames > 1) data_.known = KnownBody();  // it was the pose of the first frame
  set_pose(seen);
  const Body& body = parts_.motion.body();
  const int keyframe = parts_.map.add_keyframe(report.t_ns, body.q_WC, body.p_W);
  if (!seen) {
    without_.begin();
    return true;
  }
  const Target& target = target_.target();
  parts_.map.tables().target_normal_W = target_normal(target);
  for (int i = 0; i < target.count; ++i) {
    const int row = parts_.map.add_placed(keyframe, target.point_W[i]);
    if (row < 0) continue;
    Feature& f = parts_.map.feature(row);
    f.is_target = true;
    f.external_id = static_cast<std::uint32_t>(i);
    const Vec2 z = sighting.pixel[i];
    parts_.measuring.search().remember(&parts_.map.tables(), row, z, {body.q_WC, body.p_W});
    parts_.map.keyframes.set_pixel(keyframe, row, z);
    parts_.map.point(row).pixel = z;
    ++report.inliers;
    parts_.frame.add({row, f.id, MatchStatus::kInlier, BlockKind::kPoint, false, z, Mat2::Zero(), z, Scalar(0)});
  }
  report.new_features = 0;
  report.attempts = report.matches = report.inliers;
  parts_.adjustment.hold_target({body.q_WC, body.p_W}, target);
  parts_.tracking.set_from_target();
  settings_.hooks.say("started at the target");
  return true;
}

void KeyframeStart::begin_record() {
  if (!progress().recording || !without_.empty()) return;
  const Body& body = parts_.motion.body();
  std::fill(record_rho_, record_rho_ + StartRecord::kMaxFeatures, Scalar(1));
  without_.begin_record(body.q_WC, body.p_W, parts_.frame.report.t_ns);
  for (int t = 0; t < parts_.frame.match_count(); ++t) {
    const Match& match = parts_.frame.match(t);
    Vec3 ray_C;
    if (match.status != MatchStatus::kNew || match.feature < 0) continue;
    if (unproject(parts_.map.camera(), match.measured, &ray_C)) without_.add_feature(match.id, ray_C);
  }
}

/// The rotation that explains the picture best, from the first frame's rays. Accepts matches that are within a few times the typical
/// parallax of it. False: too few.
bool KeyframeStart::accept_rotation(int found) {
  Frame& frame = parts_.frame;
  int count = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (match.status != MatchStatus::kOutlier || match.feature < 0 || count == settings_.max_features) continue;
    ray_[count] = parts_.map.ray_W(match.feature);
    const Vec2 pixel = parts_.measuring.followed_at_frame_time(match);
    pixel_[count++] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), true};
  }
  if (found < settings_.min_inliers) return false;
  Quat q_WC = parts_.motion.body().q_WC;
  const Scalar parallax = fit_rotation(parts_.map.camera(), ray_, pixel_, count, scratch_, &q_WC);
  const Scalar bound = kParallaxes * parallax + parts_.measuring.bound_px();
  parts_.measuring.settle_followed(found, q_WC, without_.base_p_W(), settings_.start_depth);
  for (int t = 0; t < frame.match_count(); ++t) {
    Match& match = frame.match(t);
    Vec2 z;
    if (match.status != MatchStatus::kOutlier || match.feature < 0) continue;
    if (!project(parts_.map.camera(), q_WC.conjugate() * parts_.map.ray_W(match.feature), &z)) continue;
    const Vec2 pixel = parts_.measuring.followed_at_frame_time(match);
    if ((pixel - z).squaredNorm() > bound * bound) continue;
    parts_.measuring.accept(&match, pixel);
    ++frame.report.inliers;
  }
  return frame.report.inliers >= settings_.min_inliers;
}

/// Of a match of the record, at the frame's time. An accepted one has it already.
Vec2 KeyframeStart::pixel_of(const Match& match) const {
  if (parts_.map.camera().readout == Scalar(0)) return match.measured;
  if (match.status == MatchStatus::kInlier) return parts_.map.point(match.feature).pixel;
  return progress().depth_known ? parts_.measuring.at_frame_time(match, settings_.start_depth)
                                : parts_.measuring.followed_at_frame_time(match);
}

StartOutcome KeyframeStart::record_frame() {
  const Frame& frame = parts_.frame;
  const Body& body = parts_.motion.body();
  without_.begin_frame(body.q_WC, body.p_W, frame.report.t_ns);
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    // What the last depths refuse, the next ones may explain, and that adjustment is robust.
    if (match.feature >= 0 && (match.status == MatchStatus::kInlier || match.status == MatchStatus::kOutlier))
      without_.add_pixel(parts_.map.camera(), match.id, pixel_of(match));
  }
  return without_.solve(parts_.map.camera(), tuning::noise::kSearchSigma, settings_.start_depth);
}

void KeyframeStart::note_keyframe() {
  if (progress().depth_known && data_.solved_before > kPatience) without_.init();
}

bool KeyframeStart::record_more() {
  ++data_.solved_before;
  const StartOutcome outcome = record_frame();
  if (outcome != StartOutcome::kSolved && outcome != StartOutcome::kSettled) return false;
  parts_.map.keep_first_keyframe();
  take_record();
  return true;
}

/// Points were last seen from poses of the record, which have just been adjusted: the next frame searches for them from there.
void KeyframeStart::move_views() {
  const StartRecord& record = without_.record();
  for (int i = 0; i < parts_.map.capacity(); ++i) {
    if (!parts_.map.used(i)) continue;
    for (int k = record.frames() - 1; k >= 0; --k) {
      if (record.frame(k).t_ns != parts_.map.feature(i).last_seen_ns) continue;
      parts_.map.point(i).seen_from = without_.view(k);
      break;
    }
  }
}

bool KeyframeStart::follow_record() {
  Frame& frame = parts_.frame;
  const int found = parts_.measuring.follow(settings_.start_depth);
  const StartOutcome outcome = accept_rotation(found) ? record_frame() : StartOutcome::kTooFew;
  if (outcome == StartOutcome::kWait) {
    const CameraView now =
        without_.follow(parts_.map.camera(), tuning::noise::kSearchSigma, settings_.start_depth, record_rho_);
    parts_.motion.move(now.q_WC, now.c_W);
    move_views();
    Body body = parts_.motion.body();
    set_speeds(&body);
    parts_.motion.set_velocities(body.v_W, body.w_C);
    return false;
  }
  if (outcome == StartOutcome::kSolved || outcome == StartOutcome::kSettled) {
    take_record();
    settings_.hooks.say("started without a target: the first depths are known");
    return true;
  }
  if (outcome == StartOutcome::kStill) {  // what moves has drawn the pose along
    parts_.motion.move(without_.base_q_WC(), without_.base_p_W());
    if (without_.is_first_still()) settings_.hooks.say(kStandsStill);
    return false;
  }
  // Only rotation so far, or too few features in view: the world stays, and the record begins again with this frame.
  clear_map();
  frame.report.inliers = 0;
  without_.init();
  without_.begin();
  const Body body = parts_.motion.body();
  parts_.tracking.set_has_pose(frame.report.t_ns);
  parts_.map.add_keyframe(frame.report.t_ns, body.q_WC, body.p_W);
  return false;
}

}  // namespace pf
