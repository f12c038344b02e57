#include "filter_slam/start/filter_start.h"

#include <algorithm>

#include "filter/frame_pixels.h"
#include "filter_slam/inertial/tuning.h"
#include "frame/start/tuning.h"
#include "frame/tuning.h"
#include "model/camera_at.h"

namespace pf {

using namespace tuning::filter_start;

bool FilterStart::layout(Arena& arena, int width, int height) {
  target_.layout(arena, width, height);
  without_.layout(arena, adjusts_lens() ? settings_.lens.rows.shape_count() : 0);
  if (settings_.body.estimates_mounting()) mounting_ = arena.take<KnownMounting>(1);
  return arena.ok();
}

void FilterStart::init() {
  data_ = Data();
  target_.init();
  without_.init();
  forget_mounting();
  clear_filter();
}

void FilterStart::forget_mounting() {
  if (mounting_ == nullptr) return;
  const ImuUnit& unit = settings_.unit;
  const int first = settings_.body.row(BodyPart::kGravity) + 2, rows = settings_.body.dynamic_rows() - first;
  mounting_->mounting = unit.mounting;
  for (Scalar& c : mounting_->covariance) c = Scalar(0);
  const auto set_sigma = [&](BodyPart part, int count, Scalar sigma) {
    if (!settings_.body.has(part)) return;
    const int begin = settings_.body.row(part) - first;
    for (int i = begin; i < begin + count; ++i) mounting_->covariance[i * rows + i] = sigma * sigma;
  };
  set_sigma(BodyPart::kMountRotation, 3, unit.sigma_turn);
  set_sigma(BodyPart::kMountPlace, 3, unit.sigma_place);
  set_sigma(BodyPart::kDelay, 1, unit.sigma_delay);
}

void FilterStart::keep_mounting() {
  if (mounting_ == nullptr || !parts_.tracking.has_pose() || !parts_.filter.body_is_sound()) return;
  const int first = settings_.body.row(BodyPart::kGravity) + 2, rows = settings_.body.dynamic_rows() - first;
  mounting_->mounting = mounting();
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) {
      const int row = first + (i > j ? i : j), column = first + (i > j ? j : i);
      mounting_->covariance[i * rows + j] = parts_.filter.covariance()(row, column);
    }
}

Mounting FilterStart::mounting() const {
  Mounting mounting = parts_.filter.state().mounting;
  if (!mounting.in_metres) mounting.p_C = known_mounting().p_C;
  mounting.in_metres = true;
  return mounting;
}

void FilterStart::clear_filter() {
  empty_filter();
  parts_.map.planes.clear();
}

void FilterStart::empty_filter() {
  parts_.filter.init(settings_.kernels, settings_.body, settings_.keep_gauge);
  parts_.filter.set_lens(settings_.camera, settings_.lens);
  // Where the scale is not known, neither is the unit's place in it.
  parts_.filter.set_mounting({known_mounting().R_CB, Vec3::Zero(), known_mounting().delay, false});
  parts_.filter.set_roughness(settings_.fold.roughness);
  parts_.map.mark = Mark();
}

void FilterStart::start_over() {
  clear_filter();
  without_.init();
  data_.known = KnownBody();
  data_.has_place = false;
  data_.from_motion = false;
  if (parts_.map.target_withdrawn) target_.init();
}

bool FilterStart::fits(const Target& target) const {
  return target.count <= settings_.max_features && 3 * target.count <= parts_.filter.room();
}

Status FilterStart::use_target(const Target& target) {
  if (data_.known.given && target.kind == TargetKind::kRectangle) return Status::kState;
  if (!fits(target)) return Status::kRange;
  const bool has_place = target.kind == TargetKind::kPoints || target.has_place;
  if (!has_place && parts_.map.planes.has_known()) return Status::kState;  // they would be in another W
  target_.set_target(target);
  data_.has_place = has_place || data_.known.given;
  return Status::kOk;
}

Status FilterStart::use_pose(const KnownBody& known) {
  if (takes_images_only()) return Status::kState;
  data_.known = known;
  data_.known.given = true;
  data_.has_place = true;
  return Status::kOk;
}

int FilterStart::target_rows() const {
  constexpr int kCorners = 4;
  const Target& target = target_.target();
  return 3 * (target.kind == TargetKind::kRectangle ? kCorners : target.count);
}

/// known: covariance over the known rows of the layout. Of an inertial unit nothing is known yet.
void FilterStart::set_body(const Body& body, const Scalar* known, const Scalar* J_lens) {
  using namespace tuning::inertial;
  Scalar all[BodyLayout::kMaxDynamicRows * BodyLayout::kMaxDynamicRows];
  if (settings_.inertial) {
    const BodyLayout& layout = settings_.body;
    const int dim = layout.dynamic_rows(), stride = layout.known_rows(), moving = layout.row(BodyPart::kGyroBias);
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) all[i * dim + j] = i < moving && j < moving ? known[i * stride + j] : Scalar(0);
    const auto set_sigma = [&](BodyPart part, int rows, Scalar sigma) {
      for (int i = layout.row(part); i < layout.row(part) + rows; ++i) all[i * dim + i] = sigma * sigma;
    };
    set_sigma(BodyPart::kGyroBias, 3, parts_.filter.uses_samples() ? kGyroBias : kStartRate);
    set_sigma(BodyPart::kAccelBias, 3, kAccelBias);
    set_sigma(BodyPart::kGravity, 2, kGravity);
    const int first = layout.row(BodyPart::kGravity) + 2, rows = dim - first;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < rows; ++j) all[(first + i) * dim + first + j] = mounting_->covariance[i * rows + j];
    known = all;
  }
  Body now = body;
  motion_.begin(parts_.frame.report.t_ns, &now);
  parts_.filter.set_body(now, known, J_lens);
  parts_.tracking.set_has_pose(parts_.frame.report.t_ns);
}

/// Variances of velocities that nothing is known of.
void FilterStart::set_start_velocities(Scalar speed) {
  const BodyLayout& layout = settings_.body;
  const int dim = layout.known_rows();
  const auto set_sigma = [&](BodyPart part, Scalar sigma) {
    if (!layout.has(part)) return;
    for (int i = layout.row(part); i < layout.row(part) + 3; ++i) data_.covariance[i * dim + i] = sigma * sigma;
  };
  set_sigma(BodyPart::kVelocity, speed);
  set_sigma(BodyPart::kAngularVelocity, kStartRate);
}

/// Covariance of the body from which a record begins at a pose that the caller knew: that of the pose now; of velocities nothing, since
/// those of the record take their place.
void FilterStart::note_covariance() {
  const int dim = settings_.body.known_rows();
  Scalar P[Body::kPoseDim * Body::kPoseDim];
  parts_.filter.body_covariance(Body::kPoseDim, P);
  for (Scalar& c : data_.covariance) c = Scalar(0);
  for (int i = 0; i < Body::kPoseDim; ++i)
    for (int j = 0; j < Body::kPoseDim; ++j) data_.covariance[i * dim + j] = P[i * Body::kPoseDim + j];
  set_start_velocities(kStartSpeed * settings_.start_depth);
}

/// The pose before the first measurement: the one that the caller gave, or the one that defines the world.
void FilterStart::set_known_pose(bool at_target, bool fitted_to_target) {
  data_.knows_scale = at_target || !needs_record();
  data_.begin_ns = parts_.frame.report.t_ns;
  if (data_.known.given) {
    set_body(data_.known.body, data_.known.covariance);
    return;
  }
  const BodyLayout& layout = settings_.body;
  const int dim = layout.known_rows();
  Scalar* covariance = data_.covariance;
  for (Scalar& c : data_.covariance) c = Scalar(0);
  const Target& target = target_.target();
  for (int i = 0; i < Body::kPoseDim; ++i)
    for (int j = 0; j < Body::kPoseDim; ++j)
      covariance[i * dim + j] =
          at_target ? target.first_covariance(i, j) : (i == j ? kDefinedSigma * kDefinedSigma : Scalar(0));
  set_start_velocities(kStartSpeed * (at_target ? Scalar(1) : settings_.start_depth));
  begin_body(at_target ? target.first_pose : Body(), fitted_to_target);
}

/// A pose that was fitted to pixels of the target is wrong where the lens is: rows of the pose, and none of the velocities.
void FilterStart::begin_body(const Body& body, bool fitted_to_target) {
  Scalar J_lens[BodyLayout::kMaxDynamicRows * kLensParameters] = {};
  const Target& target = target_.target();
  const LensRows& rows = parts_.filter.state().lens_rows;
  PoseEstimate pose;
  pose.q_WC = body.q_WC;
  pose.p_WC = body.p_W;
  const bool by_lens = fitted_to_target && rows.count > 0 &&
                       pose_by_lens(settings_.camera, target.point_W, target.count, pose, rows, J_lens);
  set_body(body, data_.covariance, by_lens ? J_lens : nullptr);
}

void FilterStart::start_with_observations() {
  set_known_pose(target_.has_target());
  parts_.features.add_target_points(target_.target());
}

bool FilterStart::start_in_image() {
  TargetSighting sighting;
  const bool expected = target_.is_expected();
  const bool seen = expected && target_.find(settings_.camera, parts_.images.tracker(), &sighting);
  if (!seen && expected && !parts_.tracking.may_skip_target()) return false;
  target_.note_begin();
  if (!seen) {
    if (!sees_walls()) keep_walls_apart();
    set_known_pose(false);
    if (needs_record())
      without_.begin();
    else if (!settings_.inertial && parts_.map.planes.has_known())
      without_.begin_check();
    return true;
  }

  FrameReport& report = parts_.frame.report;
  if (report.frames > 1) data_.known = KnownBody();  // it was the pose of the first frame
  set_known_pose(true, true);
  parts_.features.add_target_points(target_.target());
  for (int i = 0; i < parts_.map.features.capacity(); ++i) {
    if (!parts_.map.features.used(i) || !parts_.map.features[i].is_target) continue;
    Feature& f = parts_.map.features[i];
    const Vec2 z = sighting.pixel[f.external_id];
    parts_.images.remember(i, z, {sighting.pose.q_WC, sighting.pose.p_WC});
    f.observations = f.attempts = 1;
    ++report.inliers;
    parts_.frame.add({i, f.id, MatchStatus::kInlier, BlockKind::kPoint, false, z, Mat2::Zero(), z, Scalar(0)});
  }
  report.attempts = report.matches = report.inliers;
  if (!settings_.inertial && !parts_.map.planes.has_known()) without_.begin_check();
  parts_.tracking.set_from_target();
  settings_.hooks.say("started at the target");
  return true;
}

void FilterStart::begin_record() {
  if (!is_recording() || !without_.empty()) return;
  if (data_.known.given) note_covariance();
  const CameraAt camera = camera_at(parts_.filter.state(), Scalar(0));
  without_.begin_record(camera.q_WC, camera.p_W, parts_.frame.report.t_ns);
  if (adjusts_lens() && !progress().checking) without_.free_lens(settings_.camera, shape_prior(settings_.lens));
  for (int t = 0; t < parts_.frame.match_count(); ++t) {
    const Match& match = parts_.frame.match(t);
    Vec3 ray_C;
    if (match.feature < 0) continue;
    if (match.status != MatchStatus::kNew && !parts_.map.features[match.feature].is_target) continue;
    if (unproject(settings_.camera, match.measured, &ray_C)) without_.add_feature(match.id, ray_C);
  }
  if (progress().checking && without_.empty()) end_record();
}

bool FilterStart::record_frame() {
  if (!is_recording() || without_.empty() || parts_.frame.report.inliers < settings_.min_inliers) return false;
  const CameraAt camera = camera_at(parts_.filter.state(), Scalar(0));
  without_.begin_frame(camera.q_WC, camera.p_W, parts_.frame.report.t_ns);
  for (int t = 0; t < parts_.frame.match_count(); ++t) {
    const Match& match = parts_.frame.match(t);
    // The gate judges by the depths of the last solution. What it refuses, the next one may explain, and that adjustment is robust.
    if (match.feature < 0 || (match.status != MatchStatus::kInlier && match.status != MatchStatus::kOutlier)) continue;
    without_.add_pixel(settings_.camera, match.id,
                       at_frame_time(parts_.filter, parts_.map.features[match.feature].slot, match.measured));
  }
  const bool first = !progress().depth_known, checks = progress().checking;
  const StartOutcome outcome = without_.solve(settings_.camera, tuning::noise::kSearchSigma, settings_.start_depth);
  switch (outcome) {
    case StartOutcome::kWait:
      if (progress().pending()) bound_baseline();
      break;
    case StartOutcome::kSolved:
    case StartOutcome::kSettled:
      if (checks) return check_depths(outcome == StartOutcome::kSettled);
      restart_from_record(Scalar(1));
      if (first) settings_.hooks.say("started without a target: the first depths are known");
      break;
    case StartOutcome::kTooFew:
      if (first && !checks) begin_anew();  // only rotation so far, or too few features in view
      break;
    case StartOutcome::kStill:
      stay_at_base();
      if (without_.is_first_still()) settings_.hooks.say(kStandsStill);
      break;
  }
  return false;
}

}  // namespace pf
