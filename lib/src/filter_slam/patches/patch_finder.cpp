#include "filter_slam/patches/patch_finder.h"

#include <algorithm>

#include "filter_slam/patches/tuning.h"
#include "frame/followed_view.h"
#include "geometry/symmetric_eigen.h"

namespace pf {
namespace {

using namespace tuning::patch_keeper;

/// Covariance of the mean of the four corners.
Mat2 mean_covariance(const PatchMeasurement::Matrix& C) {
  Mat2 sum = Mat2::Zero();
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) sum += C.block<2, 2>(2 * a, 2 * b);
  return sum / (4 * 4);
}

}  // namespace

void PatchFinder::layout(Arena& arena) {
  search_.layout(arena);
  aligner_.layout(arena);
}

bool PatchFinder::align(const Pyramid& image, const PatchSight& sight, StoredPatch* patch, Mat8* reference_covariance) {
  PlaneStart start;
  start.H_CK = sight.H_CK;
  start.gain = patch->gain;
  start.offset = patch->offset;
  start.slack_px = kWarpSlack;
  const PlaneAlignment found = aligner_.align(image, filter_.lens(), patch->pixels, start, HomographyWarp());
  patch->weight = found.weight;
  if (!found.is_aligned()) return false;
  patch->gain = found.gain;
  patch->offset = found.offset;
  std::copy(found.corner, found.corner + 4, patch->corner);
  patch->covariance = found.covariance;
  if (reference_covariance != nullptr) *reference_covariance = found.reference_covariance;
  return true;
}

bool PatchFinder::search_within(const Pyramid& image, const PlanePatch& pixels, const Mat2& innovation,
                                PatchSight* sight) {
  Vec2 offset;
  if (!search_.find(image, filter_.lens(), pixels, sight->H_CK, innovation, gate_, &offset)) return false;
  for (Vec2& corner : sight->corner) corner += offset;
  return fit_homography(filter_.lens(), pixels, sight);
}

bool PatchFinder::search(const Pyramid& image, const StoredPatch& patch, const PatchMeasurement& z, PatchSight* sight) {
  const Mat2 innovation = mean_covariance(filter_.covariance_of<8>(z.H));
  const Scalar widest = symmetric_eigenvalues(innovation)(1);
  if (!(widest > Scalar(0)) || gate_ * widest < kAlignerReach * kAlignerReach) return true;
  return search_within(image, patch.pixels, innovation, sight);
}

bool PatchFinder::follow(const Pyramid& image, bool supported, PatchSight* sight, StoredPatch* patch,
                         Mat8* reference_covariance) {
  if (align(image, *sight, patch, reference_covariance)) return true;
  return !supported && search_within(image, patch->pixels, FollowedView::covariance(filter_.lens()), sight) &&
         align(image, *sight, patch, reference_covariance);
}

}  // namespace pf
