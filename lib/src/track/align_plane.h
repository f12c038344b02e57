#pragma once

#include "geometry/camera.h"
#include "track/plane_lens.h"
#include "vision/plane_patch.h"
#include "vision/plane_samples.h"
#include "vision/plane_warps.h"
#include "vision/pyramid.h"

namespace pf {

/// Where a patch's alignment begins.
struct PlaneStart {
  Mat3 H_CK = Mat3::Identity();  ///< rays of the reference image to rays of this one, both at depth 1:  R + t n^T / d
  float gain = 1, offset = 0;    ///< of light against the reference: grey = gain * grey_reference + offset
  float slack_px = 0;            ///< by which edges may be off beside noise: warp and interpolation [px of a level]
  int level = PlanePatch::kLevels - 1;  ///< coarsest, where it begins; the finest is 0
};

/// Result of an alignment.
enum class PlaneVerdict {
  kAligned,
  kNotConverged,  ///< H_CK may still be a better place to begin than the start; also: it leaves what can be computed
  kUnlike,        ///< correlation below 0.85
  kHidden,        ///< less than a third of its pixels fit
  kSlanted,       ///< too slanted, too small or too large to be compared
};

struct PlaneAlignment {
  using Mat8 = Eigen::Matrix<Scalar, 8, 8>;

  PlaneVerdict verdict = PlaneVerdict::kNotConverged;
  int iterations = 0;
  Mat3 H_CK = Mat3::Identity();
  Vec2 corner[4];  ///< where the patch's corners are [px]
  float correlation = 0;
  float weight = 0;  ///< share of its pixels that fit, each by its weight
  float gain = 1, offset = 0;
  float sigma = 0;                      ///< of the noise of a pixel of the image [grey levels]
  Mat8 covariance;                      ///< of the corners (x, y of each), from the noise of this image [px^2]
  Mat8 reference_covariance;            ///< the same from the noise of the reference: one error in every frame
  Mat2 step_covariance = Mat2::Zero();  ///< of the step of a warp with two parameters, from both noises

  bool is_aligned() const { return verdict == PlaneVerdict::kAligned; }
};

/// The one aligner of patches on planes. Finds the warp that minimises
///
///   sum w (I(pi(H rho(x))) - gain T(x) - bias)^2        over the chosen pixels x of the patch, rho their rays
///
/// with gain and bias estimated beside it, so that they are projected out; w = mask x M-estimator x trust. The M-estimator is Tukey's,
/// whose scale follows the residuals; trust = 1 / (1 + (slack |grad T| / noise)^2), since an edge that is off by the slack has a residual
/// of slack |grad T| beside noise. From the coarsest level to the finest; steps are of second order, with the mean of the gradients
/// of image and template (ESM).
///
/// src  Servant 2008, section 2.3; Benhimane and Malis 2004 (ESM); what is different: lib/docs/theory/homography.md
class PlaneAligner {
 public:
  static constexpr int kMaxIterations = 12;

  bool layout(Arena& arena, int max_samples = PlanePatch::kMaxSamples) { return samples_.layout(arena, max_samples); }

  /// image, camera   what sees the patch now; the reference was seen by the same camera
  /// warp            ShiftWarp, SlopesWarp or HomographyWarp
  /// mask            weight of each pixel but those of the border, row by row, in 1/255; null: 1 everywhere
  /// The covariance is of the corners under the warp, of rank k.
  template <typename Warp>
  PlaneAlignment align(const Pyramid& image, const Camera& camera, const PlanePatch& patch, const PlaneStart& start,
                       Warp warp, const std::uint8_t* mask = nullptr);

  /// Reads the image where a homography puts the pixels of level 0, and fits gain and bias to those that agree. samples() then holds the
  /// residuals. False where too little of the patch is in the image or gain and bias cannot be fitted.
  bool compare(const Pyramid& image, const Camera& camera, const PlanePatch& patch, const PlaneStart& start,
               const std::uint8_t* mask, float* gain);
  /// Of the last align() or compare().
  const PlaneSamples& samples() const { return samples_; }
  /// Half of the patch's side [px]: its own coordinates are in these.
  Scalar half_px() const { return half_; }

 private:
  struct Progress;  ///< of one alignment

  bool begin(const Camera& camera, const PlanePatch& patch);
  void load_samples(const PlanePatch& patch, int level, float slack_px, const std::uint8_t* mask);
  Scalar corner_way(const Mat3& step) const;
  bool read(const ImageView& image, const Camera& camera, int level, Progress* progress);
  template <typename Warp>
  bool align_level(const ImageView& image, const Camera& camera, int level, Warp* warp, Progress* progress,
                   PlaneSums<Warp::kSize + 2>* sums);
  template <typename Warp>
  void judge(const Camera& camera, const Warp& warp, const PlaneSums<Warp::kSize + 2>& sums, const Progress& progress,
             PlaneAlignment* out) const;

  PlaneSamples samples_;
  PlaneLens lens_;
  bool has_lens_ = false;
  float all_weight_ = 0;  ///< sum of the mask over the samples
  Scalar half_ = 1;       ///< pixel of the pinhole = centre + half (X, Y)
  Mat3 to_ray_;           ///< (X, Y, 1) to a ray of the reference at depth 1
  Vec2 corner_[4];        ///< (X, Y) of the patch's corners
  float gradient2_ = 0;   ///< mean square of the finest level's chosen gradients [grey^2/px^2]
};

}  // namespace pf
