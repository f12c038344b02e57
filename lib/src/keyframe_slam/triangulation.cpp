#include "keyframe_slam/triangulation.h"

#include <cmath>

#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/tracking/frame_time.h"
#include "keyframe_slam/tuning.h"

namespace pf {
namespace {

/// A point's inverse depth has become known. Its pixels were taken to their frames' times with the depth of their keyframes, and are taken
/// there with its own now.
void correct_pixels(int i, Scalar rho, KeyframeMap* map) {
  KeyframePoint& point = map->point(i);
  KeyframeTable& keyframes = map->keyframes;
  const Camera& camera = map->camera();
  const Vec3 at_W = keyframes[point.host].p_W + map->ray_W(i) / rho;
  for (int k = 0; k < keyframes.capacity(); ++k) {
    const Keyframe& keyframe = keyframes[k];
    const BundlePixel& seen = keyframes.pixels(k)[i];
    if (!keyframes.used(k) || !seen.seen || !(keyframe.row_depth > Scalar(0))) continue;
    if (k != point.host && !keyframe.matches_by_motion) continue;
    Body body;
    body.q_WC = keyframe.q_WC;
    body.p_W = keyframe.p_W;
    body.v_W = keyframe.v_W;
    body.w_C = keyframe.w_C;
    const Vec3 d = at_W - keyframe.p_W;
    const Scalar w = 1 / keyframe.row_depth, w_now = 1 / d.norm();
    const Vec3 ray = d * w_now;
    const Vec2 before = seen.pixel();
    const Vec2 pixel = before + at_frame_time(camera, body, ray + w_now * body.p_W, w_now, before) -
                       at_frame_time(camera, body, ray + w * body.p_W, w, before);
    keyframes.set_pixel(k, i, pixel);
    Vec3 ray_C;
    if (k == point.host && unproject(camera, pixel, &ray_C)) point.ray_K = ray_C.normalized();
  }
}

/// With the rows of a point whose depth has become known corrected, its depth once more.
void fit_again(const Match& match, const KeyframeMotion& motion, bool by_motion, KeyframeMap* map, DepthFit* fit) {
  correct_pixels(match.feature, fit->rho, map);
  KeyframePoint& point = map->point(match.feature);
  if (by_motion) point.pixel = match_at_frame_time(*map, match, prior_of(motion), 1 / fit->rho);
  DepthFit again;
  if (fit_depth(map->camera(), *map, match.feature, motion.view(), point.pixel, &again)) *fit = again;
}

}  // namespace

void triangulate(const Frame& frame, const KeyframeMotion& motion, const TriangulationRule& rule, KeyframeMap* map) {
  const Scalar cos_parallax = std::cos(tuning::keyframe_slam::kMinParallax);
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier || map->point(match.feature).has_depth) continue;
    KeyframePoint& point = map->point(match.feature);
    DepthFit fit;
    const bool fits = fit_depth(map->camera(), *map, match.feature, motion.view(), point.pixel, &fit);
    if (fit.cos_parallax > cos_parallax) continue;
    if (!fits || (rule.strict && fit.worst_px > rule.bound_px)) {
      if (rule.strict) map->drop(match.feature);
      continue;
    }
    if (has_rows(map->camera())) fit_again(match, motion, rule.strict, map, &fit);
    point.rho = fit.rho;
    point.variance = rule.sigma_px * rule.sigma_px / fit.information;
    point.has_depth = true;
  }
}

}  // namespace pf
