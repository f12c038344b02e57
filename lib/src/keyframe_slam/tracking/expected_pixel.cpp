#include "keyframe_slam/tracking/expected_pixel.h"

#include "bundle/bearing.h"
#include "keyframe_slam/map/readout.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {
namespace {

/// Pixel and spread by the pose and by the readout, in the pixel's own row.
bool expect_row(const KeyframeMap& map, int i, const PosePrior& at, const Vec3& m, Scalar w, ExpectedPixel* out) {
  const Camera& camera = map.camera();
  Mat212 J;
  if (!project_row(camera, at.body(), m, w, &out->pixel, &J)) return false;
  if (at.with_velocities != nullptr) {
    const Mat212 JP = J.lazyProduct(*at.with_velocities);
    out->spread = JP.lazyProduct(J.transpose());
  } else {
    const Mat26 J_C = J.leftCols<6>();
    const Mat26 JP = J_C.lazyProduct(at.covariance);
    out->spread = JP.lazyProduct(J_C.transpose());
  }
  const Scalar variance = map.lens().readout_variance();
  if (!(variance > Scalar(0))) return true;
  const Vec2 by_readout = expected_by_readout(map, i, at.body(), w, out->pixel.y());
  out->spread += variance * by_readout * by_readout.transpose();
  return true;
}

}  // namespace

bool expect_placed(const KeyframeMap& map, int i, const PosePrior& at, ExpectedPixel* out) {
  const KeyframePoint& point = map.point(i);
  const Vec3& host_W = map.keyframes[point.host].p_W;
  Mat26 J_C;
  Vec2 J_rho;
  if (!project_bearing(map.camera(), at.q_WC.toRotationMatrix(), map.ray_W(i), host_W - at.p_W, point.rho, &out->pixel,
                       &J_C, nullptr, &J_rho))
    return false;
  const Mat26 JP = J_C.lazyProduct(at.covariance);
  out->spread = JP.lazyProduct(J_C.transpose()) + point.variance * J_rho * J_rho.transpose();
  if (!has_rows(map.camera())) return true;
  const Vec3 m = map.ray_W(i) + point.rho * host_W;
  if (!expect_row(map, i, at, m, point.rho, out)) return false;
  out->spread += point.variance * J_rho * J_rho.transpose();
  return true;
}

bool expect_unplaced(const KeyframeMap& map, int i, const PosePrior& at, Scalar depth, ExpectedPixel* out) {
  using tuning::keyframe_tracking::kOpenSpread;
  const KeyframePoint& point = map.point(i);
  Vec3 ray_C;
  if (!unproject(map.camera(), point.pixel, &ray_C)) return false;
  Mat26 J_C;
  Vec2 J_rho;
  if (!project_bearing(map.camera(), at.q_WC.toRotationMatrix(), point.seen_from.q_WC * ray_C,
                       point.seen_from.c_W - at.p_W, 1 / depth, &out->pixel, &J_C, nullptr, &J_rho))
    return false;
  const Mat26 JP = J_C.lazyProduct(at.covariance);
  out->spread =
      JP.lazyProduct(J_C.transpose()) + kOpenSpread * kOpenSpread * J_rho * J_rho.transpose() / (depth * depth);
  if (!has_rows(map.camera())) return true;
  const Vec3 m = point.seen_from.q_WC * ray_C + point.seen_from.c_W / depth;
  if (!expect_row(map, i, at, m, 1 / depth, out)) return false;
  out->spread += kOpenSpread * kOpenSpread * J_rho * J_rho.transpose() / (depth * depth);
  return true;
}

}  // namespace pf
