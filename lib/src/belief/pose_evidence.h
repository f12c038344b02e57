#pragma once

#include "base/scalar.h"
#include "belief/alike_share.h"

/// Evidence of one frame for a pose: the ratio of two likelihoods of what its searches have found.

namespace pf {

class Archive;

/// What the searches of a frame have found, and how much of it agrees with one pose.
struct PoseConsensus {
  int searched = 0;           ///< features
  int inliers = 0;            ///< of them: found where the pose has them
  Scalar log_density = 0;     ///< ln N(r; 0, S) of the inliers' pixels, jointly [ln px^-2 each]
  Scalar log_chance = 0;      ///< sum of log_chance_density() over the inliers
  Scalar log_zoom = 0;        ///< ln of the focal length over the calibrated one, by the inliers' pixels
  Scalar lens_evidence = 0;   ///< lens_evidence() of the pixels; 0: they do not measure it
  int paired = -1;            ///< of the inliers: the nearest of all features searched for is one too; -1: not counted
  bool is_elsewhere = false;  ///< the pose is not the predicted one: how much earlier frames found says nothing of it
};

/// ln of the density with which a search of this area finds something where its feature is not [ln px^-2].
///
///   c = q / max(A, A_0)      q = tuning::chance::kMaxFindShare, A_0 = kMinArea
Scalar log_chance_density(Scalar searched_px2);

/// ln N(r; 0, S) of 2n residuals from their normalised square r^T S^-1 r and ln det S.
Scalar log_normal_density(Scalar nis, Scalar log_det, int n);

/// Probability that a feature in view is found. It belongs to the image, not to the feature, since smear hides all alike. A frame's own
/// share therefore counts more than that of earlier ones: in an image that is as sharp as theirs, with probability p, the prior is
/// Beta(kWeight m, kWeight (1 - m)) about their mean m, and Beta(1, 1) in a less sharp one.
class FindShare {
 public:
  void init();
  /// as_sharp: p of the frame that begins (sharpness_belief.h).
  void begin_frame(Scalar as_sharp) { as_sharp_ = as_sharp; }
  /// After a frame whose pose is used.
  void learn(int searched, int inliers);
  /// ln of the probability that just these `inliers` of `searched` features are found:
  ///
  ///   ln(p B(a + k, b + n - k) / B(a, b) + (1 - p) B(k + 1, n - k + 1)),   a = kWeight m,  b = kWeight (1 - m)
  Scalar log_probability(int searched, int inliers) const;
  /// Fewer are found than in earlier frames.
  bool is_less(int searched, int inliers) const {
    return static_cast<Scalar>(inliers) < mean_ * static_cast<Scalar>(searched);
  }
  /// True where so few are found that any share is more likely than that of earlier frames: this image is less sharp, or the pose about
  /// which they were searched for is wrong, and those found are a part that agrees by chance.
  bool is_unlikely(int searched, int inliers) const;
  /// ln of the probability that just `paired` of `inliers` have an inlier as nearest neighbour, where a part is found as usual and the rest
  /// is not: about the same mean m.
  Scalar log_paired(int inliers, int paired) const;
  /// m
  Scalar mean() const { return mean_; }
  /// d of a frame in which `inliers` of `searched` features are found: the mean of Beta(a + k, b + n - k).
  Scalar in_frame(int searched, int inliers) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  Scalar log_usual(int searched, int inliers) const;

  Scalar mean_ = 0, as_sharp_ = 1;
};

/// ln of the ratio of the likelihoods of this consensus: of a right pose, and of a wrong one whose finds are all chance.
///
///   E_c = ln P(k of n found) + ln N(r; 0, S) - sum over the inliers of ln c_i
///
/// What was found elsewhere is chance under both and cancels, as does what was missed but for P. Of a pose that is not the predicted one,
/// any share may be found: P = log_any_share().
Scalar evidence_against_chance(const PoseConsensus& consensus, const FindShare& share);

/// ln of the probability that just these `inliers` of `searched` features are found where any share of them may be: ln B(k + 1, n - k + 1).
Scalar log_any_share(int searched, int inliers);

/// ln of the probability that just these `inliers` of `searched` features agree in a wrong place that has something in common with the
/// right one, where they agree as well as there. A place that looks like it, one in s, gives any share of them; a part that looks like a
/// part (a poster, a row of tags, the same wall from elsewhere) a few:
///
///   ln(s B(k + 1, n - k + 1) + kShare r B(k + 1, n - k + b) / B(1, b)),   1 / (1 + b) = kPart m
///
/// r is of the inliers' neighbours: the right pose's misses lie among its finds, and the part is found whole. Where j of the k inliers have
/// an inlier as nearest neighbour, with p = (k - 1) / (n - 1),
///
///   r = P(j of k | Beta(kWeight m, kWeight (1 - m))) / P(j of k | Beta(kWeight p, kWeight (1 - p)))
Scalar log_share_elsewhere(const PoseConsensus& consensus, const FindShare& share, const AlikeShare& alike);

/// The same ratio, where a wrong pose may also be in such a place:
///
///   E = -ln(exp(-E_c) + exp(-E_a)),   E_a = ln P(k of n found) - log_share_elsewhere()
Scalar pose_evidence(const PoseConsensus& consensus, const FindShare& share, const AlikeShare& alike);

}  // namespace pf
