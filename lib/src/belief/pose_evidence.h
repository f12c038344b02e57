#pragma once

#include "base/scalar.h"
#include "belief/alike_share.h"

/// Evidence of one frame for a pose: the ratio of two likelihoods of what its searches have found.

namespace pf {

/// What the searches of a frame have found, and how much of it agrees with one pose.
struct PoseConsensus {
  int searched = 0;          ///< features
  int inliers = 0;           ///< of them: found where the pose has them
  Scalar log_density = 0;    ///< ln N(r; 0, S) of the inliers' pixels, jointly [ln px^-2 each]
  Scalar log_chance = 0;     ///< sum of log_chance_density() over the inliers
  Scalar log_zoom = 0;       ///< ln of the focal length over the calibrated one, by the inliers' pixels
  Scalar lens_evidence = 0;  ///< lens_evidence() of the pixels; 0: they do not measure it
};

/// ln of the density with which a search of this area finds something where its feature is not [ln px^-2].
///
///   c = q / max(A, A_0)      q = tuning::chance::kMaxFindShare, A_0 = kMinArea
Scalar log_chance_density(Scalar searched_px2);

/// ln N(r; 0, S) of 2n residuals from their normalised square r^T S^-1 r and ln det S.
Scalar log_normal_density(Scalar nis, Scalar log_det, int n);

/// Probability that a feature in view is found. It belongs to the image, not to the feature, since smear hides all alike. A frame's own
/// share therefore counts more than that of earlier ones: the prior is Beta(w m, w (1 - m)) about their mean m, w = kWeight.
class FindShare {
 public:
  void init();
  /// Of a view that is not the one of the frame before, in which any share may be found: Beta(1, 1).
  static FindShare of_another_view();
  /// After a frame whose pose is used.
  void learn(int searched, int inliers);
  /// ln of the probability that just these `inliers` of `searched` features are found:
  ///
  ///   ln B(a + k, b + n - k) - ln B(a, b),   a = w m,  b = w (1 - m)
  Scalar log_probability(int searched, int inliers) const;
  /// d of a frame in which `inliers` of `searched` features are found: the mean of Beta(a + k, b + n - k).
  Scalar in_frame(int searched, int inliers) const;

 private:
  Scalar mean_ = 0, weight_ = 0;
};

/// ln of the ratio of the likelihoods of this consensus: of a right pose, and of a wrong one whose finds are all chance.
///
///   E_c = ln P(k of n found) + ln N(r; 0, S) - sum over the inliers of ln c_i
///
/// What was found elsewhere is chance under both and cancels, as does what was missed but for P.
Scalar evidence_against_chance(const PoseConsensus& consensus, const FindShare& share);

/// ln of the probability that just these `inliers` of `searched` features agree with a pose in a wrong place that has something in common with
/// the right one. A place that looks like it gives any share of them, with the probability `alike`; a part that looks like a part (a poster, a
/// row of tags, the same wall from elsewhere) gives a few, with kPart:
///
///   ln(alike B(k + 1, n - k + 1) + kPart B(k + 1, n - k + kFew) / B(1, kFew))
Scalar log_share_elsewhere(int searched, int inliers, Scalar alike);

/// The same ratio as evidence_against_chance(), where a wrong pose may also be in such a place, where what is found agrees as well:
///
///   E = -ln(exp(-E_c) + exp(-E_a)),   E_a = ln P(k of n found) - log_share_elsewhere(n, k, s)
///
/// s: share of places that look like another one.
Scalar pose_evidence(const PoseConsensus& consensus, const FindShare& share, const AlikeShare& alike);

}  // namespace pf
