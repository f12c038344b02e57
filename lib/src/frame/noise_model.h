#pragma once

#include "base/eigen.h"
#include "frame/tuning.h"
#include "map/feature_table.h"

/// Pixel noise of matches in images: its covariance, and for how many frames an error lasts.

namespace pf {

class Archive;

/// Two covariances of a match.
///
///   R_gate   = g^2 (sigma_px^2 l^2 I + F)    one match by itself: gate, consensus, NIS
///   R_update = tau R_gate                    what it adds to the matches of its feature in other frames
///
/// sigma_px  prior, from the config [px]; l: pixels of level 0 per pixel of the level that was used; F: covariance of the template's fit
/// g         from inliers' residuals r after the update, E r^T r = (1 - h) tr(R_gate), with the leverage h = tr(H P H^T) / tr(R_update);
///           large residuals are clipped
/// tau       correlation time [frames]. Most of a match's error (lens, warp, first view) stays with its feature, so n frames are worth
///           n / tau independent ones: tau = 1 + 2 sum_k rho_k, rho_k the correlation of residuals k frames apart. With the running
///           mean m_k = lambda m_(k-1) + (1 - lambda) v_k of a feature's normalised residuals v,
///           E v_k . m_(k-1) = (1 - lambda) E v.v sum_j lambda^(j-1) rho_j
///
/// Derivation and measurements: lib/docs/theory/noise.md
class NoiseModel {
 public:
  /// Noise of the first view, with which later ones are compared.
  static Mat2 reference() {
    return Mat2::Identity() * (tuning::noise::kReferenceSigma * tuning::noise::kReferenceSigma);
  }
  /// Prior of a match, before the template's fit gives its covariance: for the search, and for the first depths without a target.
  static Mat2 search() { return Mat2::Identity() * (tuning::noise::kSearchSigma * tuning::noise::kSearchSigma); }
  /// R_update of such a match.
  static Mat2 search_update() { return search() * tuning::noise::kPriorFrames; }

  /// sigma_px: the least standard deviation. correlation_frames: the prior of tau.
  void init(Scalar sigma_px, Scalar correlation_frames = tuning::noise::kPriorFrames);

  /// R_gate
  Mat2 match(const Mat2& fit, Scalar level_scale) const;
  /// g
  Scalar scale() const { return scale_; }
  /// tau [frames]
  Scalar correlation_frames() const { return tau_; }
  /// Root mean square over recent inliers [px].
  Scalar sigma_gate() const;
  Scalar sigma_info() const;
  /// Whether residuals are so large that noise alone cannot be the reason.
  bool is_implausible() const { return scale_ > tuning::noise::kMaxPlausible; }

  /// Adds an inlier's residual after the update. R_gate: from match(), before the update. trace: of the feature, or null if its matches
  /// entered the update as independent of each other.
  void learn(int frame, const Vec2& residual, const Mat2& R_gate, Scalar leverage, ResidualTrace* trace);
  /// Updates g and tau with the residuals that learn() has gathered in this frame.
  void end_frame();

  void carry(Archive& archive);  ///< base/archive.h

 private:
  Scalar sigma_px_ = 0;
  Scalar scale_ = 1;  ///< g
  Scalar tau_ = 0, prior_tau_ = 0;
  Scalar variance_ = 0;  ///< running mean of tr(R_gate) / 2 [px^2]
  // Of this frame.
  int count_ = 0;
  Scalar excess_ = 0;  ///< sum of clipped squares, each with a mean of one, less one
  Scalar frame_variance_ = 0;
  // Over frames, older ones fading.
  double squares_ = 0;   ///< v.v
  double products_ = 0;  ///< v . m
  double pairs_ = 0;
};

}  // namespace pf
