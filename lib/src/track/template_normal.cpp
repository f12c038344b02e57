#include "track/template_normal.h"

#include <cmath>

#include "track/tuning.h"

namespace pf {
namespace {

using namespace tuning::template_normal;

bool is_finite(const Mat2& C) { return std::isfinite(C(0, 0) + C(0, 1) + C(1, 1)); }

}  // namespace

Scalar slope_leverage(const TemplateWarp& warp, int side) {
  // H (I + q (d . (ray - ray_0))^T), q = H^-1 t: a ray moves by (q_xy - ray q_z) d . (ray - ray_0); H itself hardly scales.
  const Vec3 q = warp.homography(warp.facing()).inverse() * warp.t;
  const Vec2 along = q.head<2>() - warp.ray_0 * q.z();
  return along.norm() * static_cast<Scalar>(side) / 2;
}

bool measure_slopes(const Pyramid& image, const Camera& camera, const PlanePatch& patch, const std::uint8_t* mask,
                    const TemplateWarp& warp, const Vec2& start, const Vec2& pixel, PlaneAligner* aligner,
                    TemplateNormal* normal) {
  const Scalar leverage = slope_leverage(warp, patch.side);
  if (!(leverage >= kMinLeverage)) return false;
  Mat3 shift;
  const Mat3 H = warp.homography(start);
  if (!anchored(camera, warp, H, pixel, &shift)) return false;
  PlaneStart from;
  from.level = 0;
  from.H_CK = shift.lazyProduct(H);
  SlopesWarp slopes;
  slopes.t = shift * warp.t;
  const PlaneAlignment found = aligner->align(image, camera, patch, from, slopes, mask);
  if (found.verdict == PlaneVerdict::kNotConverged || found.verdict == PlaneVerdict::kSlanted) return false;
  // H = H_0 + t e^T: what the steps came to, by rays.
  const Mat3 D = found.H_CK - from.H_CK;
  const Vec2 step = (slopes.t.transpose() * D).head<2>().transpose() / slopes.t.squaredNorm();
  // Steps are by half sides of the patch.
  const Vec2 per(camera.fx / aligner->half_px(), camera.fy / aligner->half_px());
  Mat2 C = per.asDiagonal() * found.step_covariance * per.asDiagonal();
  const Scalar least = kWarpError / leverage;
  C += Mat2::Identity() * (least * least);
  if (!is_finite(C) || !(C.trace() < kMaxSigma * kMaxSigma) || !(step.squaredNorm() < kMaxStep * kMaxStep))
    return false;
  normal->slope = start + step;
  normal->covariance = C;
  return true;
}

void fuse_slopes(const TemplateNormal& measured, TemplateNormal* normal) {
  const Mat2 P = normal->covariance + Mat2::Identity() * (kWalk * kWalk);
  const Mat2 S = P + kCorrelation * measured.covariance;
  const Mat2 K = P * S.inverse();
  normal->slope += K * (measured.slope - normal->slope);
  normal->covariance = P - K * P;
  normal->covariance(1, 0) = normal->covariance(0, 1);
}

}  // namespace pf
