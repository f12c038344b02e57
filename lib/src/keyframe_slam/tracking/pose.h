#pragma once

#include "base/arena.h"
#include "frame/settings.h"
#include "geometry/p3p.h"
#include "geometry/pnp.h"
#include "keyframe_slam/tracking/pose_prior.h"

/// Pose of a frame from matches with known points: the consensus, and the fit with the noise of each.

namespace pf {

class Archive;

/// A match with a point whose depth is known.
struct PoseMatch {
  PnpPoint point;
  Mat2 noise;  ///< covariance of the pixel, the point's depth included [px^2]
  /// By how much one standard deviation of the camera's readout moves where it is expected [px]; all matches share its error.
  Vec2 by_readout = Vec2::Zero();
};

/// Fits the pose to the matches in use, and to the prior:
///
///   min over (theta, p, c) of  sum rho((r_i - u_i c)ᵀ R_i⁻¹ (r_i - u_i c)) + c² + eᵀ P⁻¹ e
///
/// by Gauss-Newton from the pose in inout: e is (theta, p) of the pose against the prior, rho Huber's, and c the error of the readout in
/// its standard deviation, u_i = by_readout. information gets that of the matches alone about the pose, robust weights included and c
/// eliminated:
///
///   A - a aᵀ / q,   a = sum J_iᵀ R_i⁻¹ u_i,   q = 1 + sum u_iᵀ R_i⁻¹ u_i
///
/// use     of each match, whether it counts
/// false   where a step cannot be computed; inout is then untouched
bool fit_pose(const Camera& camera, const PoseMatch* matches, int count, const unsigned char* use,
              const PosePrior& prior, Scalar huber, CameraPose* inout, Mat6* information);

/// ln N(r; 0, S) of matches that count, jointly, where S has the noise of each and what the prior leaves open of the pose:
///
///   ln N(r; 0, S) = sum ln N(r_i; 0, R_i) - (eᵀ P⁻¹ e + ln det(I + P A) + ln q - f² / q) / 2,   f = sum u_iᵀ R_i⁻¹ r_i
///
/// with r_i and e at the fitted pose and A its information,
/// exact where the projection is linear. Hardly likely, kImpossible, where P is no covariance.
Scalar log_density(const Camera& camera, const PoseMatch* matches, int count, const unsigned char* use,
                   const PosePrior& prior, const CameraPose& pose, const Mat6& information);

/// Finds the pose that most matches support (geometry/pnp.h), from the prior's and from triples of them.
class KeyframePose {
 public:
  bool layout(Arena& arena, int capacity);
  void init();

  PoseMatch& match(int i) { return match_[i]; }
  const PoseMatch& match(int i) const { return match_[i]; }
  bool is_inlier(int i) const { return inlier_[i] != 0; }
  const unsigned char* inliers() const { return inlier_; }

  /// Consensus and fit over the first `count` matches. bound_px: of an inlier. least: inliers that are enough.
  /// Returns the number of inliers, 0 where they are too few; pose and information are then untouched.
  int find(const Camera& camera, int count, const PosePrior& prior, Scalar bound_px, int least, CameraPose* pose,
           Mat6* information);
  /// Fit to all of the first `count` matches from the prior, where no triple has enough evidence; matches beyond the gate are then
  /// rejected. Returns the number of inliers, 0 where it fails.
  int fit(const Camera& camera, int count, const PosePrior& prior, Scalar gate, CameraPose* pose, Mat6* information);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  PoseMatch* match_ = nullptr;  ///< capacity each
  PnpPoint* point_ = nullptr;
  unsigned char* inlier_ = nullptr;
  std::uint32_t random_ = 1;
};

}  // namespace pf
