#include "keyframe_slam/adjustment/keyframe_adjustment.h"

#include <algorithm>
#include <cmath>

#include "bundle/bearing.h"
#include "geometry/so3.h"
#include "keyframe_slam/adjustment/bundle_planes.h"
#include "keyframe_slam/adjustment/tuning.h"
#include "keyframe_slam/map/depth.h"

namespace pf {

using namespace tuning::keyframe_adjustment;

namespace {

/// Of many keyframes of which but one is fixed: the distance from that one of the farthest of the older half of the others. False where all
/// are at the same place.
bool hold_distance(const AdjustedPoses& poses, BundleDistance* held) {
  held->pose = -1;
  held->from_W = poses.pose[poses.free].p_W;
  held->distance = Scalar(0);
  for (int c = 0; 2 * c < poses.free; ++c) {
    const Scalar distance = (poses.pose[c].p_W - held->from_W).norm();
    if (distance <= held->distance) continue;
    held->pose = c;
    held->distance = distance;
  }
  held->sigma = kHeldDistance * held->distance;
  return held->pose >= 0;
}

}  // namespace

bool KeyframeAdjustment::layout(Arena& arena) {
  choice_.layout(arena);
  bundle_.layout(arena, settings_);
  return adjuster_.layout(arena, max_bundle_poses(), max_free_keyframes(settings_), settings_.max_features,
                          settings_.max_planes, settings_.lens.rows.count);
}

Scalar KeyframeAdjustment::sigma_px() const { return std::max(noise_.sigma_gate(), kMinSigma); }

bool KeyframeAdjustment::run(bool settled) {
  AdjustedPoses& poses = bundle_.poses;
  AdjustedPoints& points = bundle_.points;
  if (!choice_.choose(settled, &poses, &points)) return false;
  fill_poses(map_, settings_.max_features, &poses);
  BundleDistance held;
  const bool holds_distance = settled && choice_.needs_distance(poses) && hold_distance(poses, &held);
  const bool has_scale =
      holds_distance || poses.seen_in - poses.free >= kMinScaleKeyframes || choice_.is_held_by_target();
  if (has_scale) add_plane_points(map_, &points);
  fill_points(map_, settings_.max_features, &poses, &points);
  const RhoPrior prior = weak_prior(points);
  std::fill(points.prior, points.prior + points.count, prior);
  hold_by_pixels(map_, noise_.sigma_info(), &points);
  target_.add_to(map_, &poses, &points);
  bundle_.planes.count = 0;
  if (has_scale) add_planes(map_, planes_, settings_.fold, noise_.sigma_info(), &points, &bundle_.planes);
  adjust(settled && map_.lens().rows().count > 0, prior, holds_distance ? &held : nullptr);
  return true;
}

/// Adjusts the bundle, and gives the map what comes of it.
void KeyframeAdjustment::adjust(bool with_lens, const RhoPrior& prior, const BundleDistance* held) {
  const AdjustedPoses& poses = bundle_.poses;
  const AdjustedPoints& points = bundle_.points;
  const AdjustedPlanes& planes = bundle_.planes;
  const int rounds = map_.keyframes.count() <= settings_.window_keyframes ? kFirstRounds : kRounds;
  const AdjustOptions options = {sigma_px(), kHuber, prior.mean, prior.sigma, kBehindWeight, kNoPixelPenalty, rounds};
  const Scalar inflation = noise_.correlation_frames();
  Camera camera = map_.camera();
  Scalar information[KeyframeLens::kMaxEntries];
  lens_information(map_.lens().prior(), inflation, information);
  const bool with_readout = with_lens && map_.lens().rows().has_readout();
  const BundleLens lens = {map_.lens().rows(), information, map_.lens().prior_camera(),           &camera,
                           points.host_pixel,  points.ray,  with_readout ? poses.rates : nullptr, camera.readout};
  if (with_readout) fill_rates(map_, poses);
  for (int p = 0; p < points.count && with_lens; ++p) points.host_pixel[p] = map_.host_pixel(points.row[p]);
  const Bundle bundle = {poses.pose,
                         poses.count,
                         points.ray,
                         points.host,
                         points.rho,
                         points.count,
                         points.prior,
                         planes.plane,
                         planes.count,
                         planes.count > 0 ? points.plane_of : nullptr,
                         points.rho_before,
                         with_lens ? &lens : nullptr,
                         held};
  adjuster_.adjust(map_.camera(), options, bundle);
  Mat6 P;
  const bool determined = adjuster_.last_pose_covariance(map_.camera(), options, bundle, &P);
  shape_.is_determined = false;
  if (determined) note_covariance(inflation * (P + P.transpose()) / 2);
  if (with_lens) map_.move_lens(camera);
  if (with_lens && determined) {
    Scalar covariance[KeyframeLens::kMaxEntries];
    adjuster_.lens_covariance(covariance);
    map_.lens().set_covariance(covariance, inflation);
  }
  take_keyframes();
  take_points();
  planes_.begin_adjustment();
  for (int j = 0; j < planes.count && determined; ++j)
    planes_.take_adjusted(planes.row[j], planes.plane[j].x, adjuster_.plane_covariance(j));
}

/// Covariance of the newest keyframe, which is the last free pose, given those that are held fixed. Away from the first keyframe that of
/// the newest of these, H, is added, since H moves everything:
///
///   theta = theta_H + dtheta,  p = p_H + R_H dp:   P = P_dd + A P_H Aᵀ,   A = [I 0; -[p - p_H]x I]
void KeyframeAdjustment::note_covariance(const Mat6& given_held) {
  const AdjustedPoses& poses = bundle_.poses;
  const int newest = poses.free - 1;
  map_covariance_ = given_held;
  shape_ = {poses.seen_in, true, choice_.is_away(), given_held, 0, 0};
  for (int c = 0; c < poses.seen_in; ++c)
    if (c != newest) shape_.hangs_on = std::max(shape_.hangs_on, map_.keyframes[poses.keyframe[c]].number);
  const auto take_span = [&](int a, int b) {
    shape_.span = std::max(shape_.span, (poses.pose[a].p_W - poses.pose[b].p_W).norm());
  };
  for (int a = poses.free; a < poses.seen_in; ++a) {
    take_span(a, newest);
    for (int b = poses.free; b < a; ++b) take_span(a, b);
  }
  int held = -1;
  for (int c = poses.free; c < poses.seen_in && choice_.is_away(); ++c) {
    const int k = poses.keyframe[c];
    if (held < 0 || map_.keyframes[k].number > map_.keyframes[held].number) held = k;
  }
  if (held >= 0) {
    Mat6 A = Mat6::Identity();
    A.bottomLeftCorner<3, 3>() = -hat(Vec3(poses.pose[newest].p_W - map_.keyframes[held].p_W));
    map_covariance_ += A * map_.keyframes[held].covariance * A.transpose();
  }
  map_.keyframes[poses.keyframe[newest]].covariance = map_covariance_;
}

MapDrift KeyframeAdjustment::drift() const {
  MapDrift drift;
  if (!shape_.is_away) return drift;
  drift.any = true;
  drift.Q = shape_.given_held / static_cast<Scalar>(shape_.keyframes);
  const Scalar sigma = std::sqrt(drift.Q.bottomRightCorner<3, 3>().trace() / 3);
  drift.sigma_scale = shape_.span > sigma ? sigma / shape_.span : Scalar(1);
  return drift;
}

void KeyframeAdjustment::set_place_covariance(const Mat6& of_held) {
  map_covariance_ = shape_.given_held + of_held;
  map_.keyframes[map_.keyframes.newest()].covariance = map_covariance_;
}

Scalar KeyframeAdjustment::log_rho_variance(int row) const {
  const AdjustedPoints& points = bundle_.points;
  const std::int16_t* end = points.row + points.count;
  const int p = static_cast<int>(std::find(points.row, points.row + points.count, row) - points.row);
  if (!shape_.is_determined || points.row + p == end) return 0;
  return noise_.correlation_frames() * adjuster_.rho_variance(p) / (points.rho[p] * points.rho[p]);
}

void KeyframeAdjustment::take_keyframes() {
  const AdjustedPoses& poses = bundle_.poses;
  for (int c = 0; c < poses.free; ++c) {
    Keyframe& k = map_.keyframes[poses.keyframe[c]];
    k.q_WC = poses.pose[c].q_WC;
    k.p_W = poses.pose[c].p_W;
  }
  target_.put_back(&map_);
}

void KeyframeAdjustment::take_points() {
  const AdjustedPoints& points = bundle_.points;
  for (int p = 0; p < points.count; ++p) {
    const int i = points.row[p];
    KeyframePoint& point = map_.point(i);
    if (!map_.feature(i).is_target) {
      point.rho = points.rho[p];
      point.variance = depth_by_pixels(map_, i, noise_.sigma_info()).variance;
    }
    reject_outliers(i);
    if (point.faces_host) map_.tables().first_view(i) = map_.keyframes[point.host].view();
  }
}

/// Forgets pixels of a point that are not where it is.
void KeyframeAdjustment::reject_outliers(int i) {
  const KeyframePoint& point = map_.point(i);
  const Vec3 ray_W = map_.ray_W(i), host_W = map_.keyframes[point.host].p_W;
  const Scalar bound = kOutlierSigmas * sigma_px();
  for (int k = 0; k < map_.keyframes.capacity(); ++k) {
    BundlePixel& pixel = map_.keyframes.pixels(k)[i];
    if (k == point.host || !map_.keyframes.used(k) || !pixel.seen) continue;
    const Keyframe& keyframe = map_.keyframes[k];
    Vec2 z;
    pixel.seen =
        project_bearing(map_.camera(), keyframe.q_WC.toRotationMatrix(), ray_W, host_W - keyframe.p_W, point.rho, &z) &&
        !((pixel.pixel() - z).squaredNorm() > bound * bound);
  }
}

}  // namespace pf
