#pragma once

#include "bundle/bundle_terms.h"

namespace pf {

/// A small bundle adjustment (bundle.h): Levenberg-Marquardt with the points eliminated one by one, in storage from the arena. Its cost is
/// that of BundleTerms.
class BundleAdjuster {
 public:
  static constexpr int kMaxPoses = BundleTerms::kMaxPoses;

  /// False: no room, or more than kMaxPoses.
  bool layout(Arena& arena, int max_poses, int max_free_poses, int max_points, int max_planes = 0,
              int max_lens_rows = 0);

  /// Adjusts free poses, free planes and all rho; returns the robust cost, which never rises. Bounded by max_rounds.
  Scalar adjust(const Camera& camera, const AdjustOptions& options, const Bundle& bundle);

  int rounds() const { return rounds_; }  ///< steps that the last adjust() has tried

  /// One step of the normal equations (normal_equations.h) from where the bundle is, without taking it. False when S is not positive
  /// definite.
  bool step(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping);
  const Scalar* plane_step() const { return terms_.equations.b; }
  const Scalar* lens_step() const { return plane_step() + terms_.equations.plane_columns; }
  const Scalar* pose_step() const { return plane_step() + terms_.equations.pose_column(0); }
  Scalar rho_step(int point) const;

  /// Covariance of (theta, p) of the last free pose, the points, the planes and the other free poses marginalised.
  /// False when something that is adjusted is not determined; else as after begin_covariances().
  bool last_pose_covariance(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Mat6* covariance);

  /// Prepares the covariances below: those of all that is adjusted, about where the bundle is, with what is fixed taken as
  /// exact (so they are conditional on fixed poses, planes and on the points' bearings in their hosts). False when
  /// something that is adjusted is not determined; the functions below are then not to be called, nor after another
  /// call of this class.
  bool begin_covariances(const Camera& camera, const AdjustOptions& options, const Bundle& bundle);

  Mat6 pose_covariance(int pose) const;    ///< of (theta, p); zero for a fixed pose
  Mat3 plane_covariance(int plane) const;  ///< of (a, b, h); zero for a fixed plane
  /// Of the lens that is adjusted: rows x rows, row-major.
  void lens_covariance(Scalar* covariance) const;
  Scalar rho_variance(int point) const;  ///< infinite for a point that nothing is known of
  /// Of the place p_H + R_WH r / rho [m²], the host's covariance and that of the lens included. sigma_bearing [rad] is the standard
  /// deviation of its bearing in each direction. False where rho is not above zero or nothing is known of it.
  bool point_covariance(const Bundle& bundle, int point, Scalar sigma_bearing, Mat3* covariance) const;

 private:
  bool take_step(const Bundle& bundle);
  void keep(const Bundle& bundle);
  void restore(const Bundle& bundle);

  BundleTerms terms_;
  int rounds_ = 0;
  // Before the step that is tried.
  BundlePose* old_pose_ = nullptr;
  Vec3* old_plane_ = nullptr;
  Scalar* old_rho_ = nullptr;
  Camera* old_lens_ = nullptr;  ///< null: no lens is ever adjusted
};

}  // namespace pf
