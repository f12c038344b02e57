#include "keyframe_slam/adjustment/keyframe_bundle.h"

#include <algorithm>
#include <cmath>

#include "bundle/bundle_adjuster.h"
#include "keyframe_slam/adjustment/tuning.h"
#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {
namespace {

/// Pose of a keyframe in the bundle, which becomes a fixed one without pixels where it is not there yet.
int pose_of(const KeyframeMap& map, int keyframe, AdjustedPoses* poses) {
  const int* end = poses->keyframe + poses->count;
  const int at = static_cast<int>(std::find<const int*>(poses->keyframe, end, keyframe) - poses->keyframe);
  if (at < poses->count) return at;
  const Keyframe& k = map.keyframes[keyframe];
  poses->keyframe[at] = keyframe;
  poses->pose[at] = {k.q_WC, k.p_W, false, nullptr};
  return poses->count++;
}

}  // namespace

static_assert(tuning::keyframe_map::kKeyframes + 1 <= BundleAdjuster::kMaxPoses, "keyframes and the target's host");

int max_bundle_poses() { return tuning::keyframe_map::kKeyframes + 1; }

bool KeyframeBundle::layout(Arena& arena, const Settings& settings) {
  const std::size_t max_points = static_cast<std::size_t>(settings.max_features);
  const std::size_t max_planes = static_cast<std::size_t>(settings.max_planes);
  const std::size_t max_poses = static_cast<std::size_t>(max_bundle_poses());
  poses.pose = arena.take<BundlePose>(max_poses);
  poses.keyframe = arena.take<int>(max_poses);
  poses.pixel = arena.take<BundlePixel>((max_poses - 1) * max_points);
  poses.rates = settings.lens.rows.has_readout() ? arena.take<BundleRates>(max_poses) : nullptr;
  points.ray = arena.take<Vec3>(max_points);
  points.host = arena.take<int>(max_points);
  points.rho = arena.take<Scalar>(max_points);
  points.rho_before = arena.take<Scalar>(max_points);
  points.prior = arena.take<RhoPrior>(max_points);
  points.row = arena.take<std::int16_t>(max_points);
  planes.plane = arena.take<BundlePlane>(max_planes);
  planes.row = arena.take<int>(max_planes);
  points.plane_of = arena.take<int>(max_points);
  points.host_pixel = settings.lens.rows.count > 0 ? arena.take<HostPixel>(max_points) : nullptr;
  return arena.ok();
}

void fill_poses(const KeyframeMap& map, int stride, AdjustedPoses* poses) {
  for (int c = 0; c < poses->seen_in; ++c) {
    const Keyframe& k = map.keyframes[poses->keyframe[c]];
    poses->pose[c] = {k.q_WC, k.p_W, c < poses->free, poses->pixel + c * stride};
  }
  poses->count = poses->seen_in;
}

void fill_points(const KeyframeMap& map, int stride, AdjustedPoses* poses, AdjustedPoints* points) {
  for (int p = 0; p < points->count; ++p) {
    const int row = points->row[p];
    const KeyframePoint& point = map.point(row);
    for (int c = 0; c < poses->seen_in; ++c)
      poses->pixel[c * stride + p] = map.keyframes.pixels(poses->keyframe[c])[row];
    points->ray[p] = point.ray_K;
    points->host[p] = pose_of(map, point.host, poses);
    points->rho[p] = points->rho_before[p] = point.rho;
  }
}

void fill_rates(const KeyframeMap& map, const AdjustedPoses& poses) {
  for (int c = 0; c < poses.count; ++c) {
    const int k = poses.keyframe[c];
    poses.rates[c] =
        k < 0 ? BundleRates{Vec3::Zero(), Vec3::Zero()} : BundleRates{map.keyframes[k].v_W, map.keyframes[k].w_C};
  }
}

RhoPrior weak_prior(const AdjustedPoints& points) {
  Scalar sum = 0, squares = 0;
  for (int p = 0; p < points.count; ++p) {
    sum += points.rho[p];
    squares += points.rho[p] * points.rho[p];
  }
  const Scalar mean = squares / sum;
  return {mean, tuning::keyframe_adjustment::kPriorSigma * mean};
}

void hold_by_pixels(const KeyframeMap& map, Scalar sigma_px, AdjustedPoints* points) {
  for (int p = 0; p < points->seen; ++p) {
    const RhoPrior& remembered = map.point(points->row[p]).remembered;
    if (remembered.sigma > Scalar(0)) points->prior[p] = remembered;
  }
  for (int p = points->seen; p < points->count; ++p) {
    const PixelDepth depth = depth_by_pixels(map, points->row[p], sigma_px);
    points->prior[p] =
        depth.variance > Scalar(0) ? RhoPrior{depth.rho, std::sqrt(depth.variance)} : RhoPrior{points->rho[p], 0};
  }
}

}  // namespace pf
