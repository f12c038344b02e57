#include "keyframe_slam/map/depth.h"

#include <algorithm>
#include <cmath>

#include "bundle/bearing.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {
namespace {

using namespace tuning::keyframe_depth;

/// Sums of one view's pixel. False where the point does not project.
struct DepthSums {
  Scalar information = 0, gradient = 0, worst2 = 0;

  bool add(const Camera& camera, const CameraView& view, const Vec3& ray_W, const Vec3& host_W, Scalar rho,
           const Vec2& pixel) {
    Vec2 z, J;
    Mat26 J_C;
    if (!project_bearing(camera, view.q_WC.toRotationMatrix(), ray_W, host_W - view.c_W, rho, &z, &J_C, nullptr, &J))
      return false;
    const Vec2 r = pixel - z;
    information += J.squaredNorm();
    gradient += J.dot(r);
    worst2 = std::max(worst2, r.squaredNorm());
    return true;
  }
};

/// Adds all pixels of a point in keyframes that are not its host. strict: false as soon as one does not project; else such a pixel is left
/// out.
bool add_keyframes(const Camera& camera, const KeyframeMap& map, int i, Scalar rho, bool strict, DepthSums* sums) {
  const int host = map.point(i).host;
  const Vec3 ray_W = map.ray_W(i);
  for (int k = 0; k < map.keyframes.capacity(); ++k) {
    const BundlePixel& seen = map.keyframes.pixels(k)[i];
    if (k == host || !map.keyframes.used(k) || !seen.seen) continue;
    if (!sums->add(camera, map.keyframes[k].view(), ray_W, map.keyframes[host].p_W, rho, seen.pixel()) && strict)
      return false;
  }
  return true;
}

}  // namespace

bool fit_depth(const Camera& camera, const KeyframeMap& map, int i, const CameraView& now, const Vec2& pixel,
               DepthFit* fit) {
  const Vec3& host_W = map.keyframes[map.point(i).host].p_W;
  const Vec3 ray_W = map.ray_W(i);
  Vec3 ray_C;
  fit->cos_parallax = Scalar(1);
  if (!unproject(camera, pixel, &ray_C)) return false;
  const Vec3 d = (now.q_WC * ray_C).normalized();
  const Scalar c = ray_W.dot(d), sin2 = 1 - c * c;
  fit->cos_parallax = c;
  if (!(sin2 > kMinSin2)) return false;
  const Scalar s = (ray_W - c * d).dot(now.c_W - host_W) / sin2;
  if (!(s > Scalar(0))) return false;
  Scalar rho = 1 / s;
  DepthSums sums;
  for (int round = 0; round <= kRounds; ++round) {
    sums = DepthSums();
    if (!sums.add(camera, now, ray_W, host_W, rho, pixel)) return false;
    if (!add_keyframes(camera, map, i, rho, true, &sums)) return false;
    if (!(sums.information > Scalar(0))) return false;
    if (round < kRounds) rho += sums.gradient / sums.information;
    if (!(rho > Scalar(0))) return false;
  }
  fit->rho = rho;
  fit->information = sums.information;
  fit->worst_px = std::sqrt(sums.worst2);
  return std::isfinite(rho);
}

PixelDepth depth_by_pixels(const KeyframeMap& map, int i, Scalar sigma_px) {
  const Scalar rho = map.point(i).rho;
  DepthSums sums;
  add_keyframes(map.camera(), map, i, rho, false, &sums);
  const RhoPrior& remembered = map.point(i).remembered;
  if (remembered.sigma > Scalar(0)) {
    const Scalar information = sigma_px * sigma_px / (remembered.sigma * remembered.sigma);
    sums.information += information;
    sums.gradient += information * (remembered.mean - rho);
  }
  if (!(sums.information > Scalar(0))) return {rho, Scalar(0)};
  return {rho + sums.gradient / sums.information, sigma_px * sigma_px / sums.information};
}

}  // namespace pf
