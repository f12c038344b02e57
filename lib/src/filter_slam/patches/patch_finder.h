#pragma once

#include "filter/filter.h"
#include "filter_slam/patches/patch_sight.h"
#include "track/align_plane.h"
#include "track/patch_search.h"
#include "track/patch_store.h"

namespace pf {

/// Finds patches in the image.
class PatchFinder {
 public:
  using Mat8 = PatchMeasurement::Matrix;

  /// gate: chi-square bound with two degrees of freedom.
  PatchFinder(const Filter& filter, Scalar gate) : filter_(filter), gate_(gate) {}

  void layout(Arena& arena);

  /// Aligns the patch with the image, from its predicted place, and sets its corners, their covariance, gain and bias.
  /// *reference_covariance: of the corners, by the noise of the reference; null to skip. False where it is not found.
  bool align(const Pyramid& image, const PatchSight& sight, StoredPatch* patch, Mat8* reference_covariance = nullptr);

  /// Where the prediction (z) is uncertain by more pixels than the aligner reaches, searches for the patch and moves the sight there. False
  /// where it is not found.
  bool search(const Pyramid& image, const StoredPatch& patch, const PatchMeasurement& z, PatchSight* sight);

  /// align() for a patch without a prediction. Where nothing else supports the pose, a camera that has just begun to move is uncertain by
  /// more than the aligner reaches, and the patch is searched for as far as it can move from one frame to the next.
  bool follow(const Pyramid& image, bool supported, PatchSight* sight, StoredPatch* patch, Mat8* reference_covariance);

 private:
  bool search_within(const Pyramid& image, const PlanePatch& pixels, const Mat2& innovation, PatchSight* sight);

  const Filter& filter_;
  Scalar gate_;
  PatchSearch search_;
  PlaneAligner aligner_;
};

}  // namespace pf
