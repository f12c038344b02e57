#pragma once

#include "track/align_plane.h"
#include "track/template_warp.h"

namespace pf {

/// Slopes of a template's surface with their covariance.
struct TemplateNormal {
  Vec2 slope = Vec2::Zero();
  Mat2 covariance = Mat2::Zero();
};

/// How far one unit of slope moves the rim of the template in the current image [px]: what makes it observable.
Scalar slope_leverage(const TemplateWarp& warp, int side);

/// Measures the slopes: Gauss-Newton on two of them with the mask as weights, the middle of the template staying at `pixel`.
///
///   min sum p(x) (I(w(x; slope)) - gain T(x) - bias)^2
///
/// patch, mask  as PlaneAligner::align
/// False where the leverage is too small, it does not converge, or the result is worse than kMaxSigma; normal untouched.
/// src  Masoud 2015 (4), where a simplex search finds two angles; the covariance is of the normal equations
bool measure_slopes(const Pyramid& image, const Camera& camera, const PlanePatch& patch, const std::uint8_t* mask,
                    const TemplateWarp& warp, const Vec2& start, const Vec2& pixel, PlaneAligner* aligner,
                    TemplateNormal* normal);

/// Updates slopes with a measurement. Its errors come again in later frames (the pixels of first sight stay), so it counts as one of
/// kCorrelation.
void fuse_slopes(const TemplateNormal& measured, TemplateNormal* normal);

}  // namespace pf
