#pragma once

#include "base/arena.h"
#include "geometry/camera.h"

/// A small bundle adjustment: poses, and points by their bearing and inverse depth in a host pose (lib/docs/starting.md).

namespace pf {

/// Where a pose saw a point.
struct BundlePixel {
  float x, y;  ///< [px]
  bool seen;

  Vec2 pixel() const { return Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y)); }
};

struct BundlePose {
  Quat q_WC;
  Vec3 p_W;
  bool free;                 ///< false: not adjusted
  const BundlePixel* pixel;  ///< by point; null: this pose is a host only
};

/// What is adjusted; a view of the caller's arrays. Something must hold position, rotation and scale: fixed poses, or
/// the prior on the inverse depths.
struct Bundle {
  BundlePose* pose;
  int poses;
  const Vec3* ray;  ///< of each point in its host pose; any length, which is the unit of 1 / rho
  const int*
      host;  ///< pose of each point; null: pose 0 for all. Pixels of a point in its own host say nothing and are skipped
  Scalar* rho;
  int points;
};

struct AdjustOptions {
  Scalar sigma_px;          ///< [px] of every pixel
  Scalar huber;             ///< residuals beyond this count linearly [standard deviations]
  Scalar rho_mean;          ///< prior on every inverse depth
  Scalar rho_sigma;         ///< its standard deviation
  Scalar behind_weight;     ///< information of the prior is (1 + this) times larger where rho < 0
  Scalar no_pixel_penalty;  ///< cost of a seen point that has no pixel, in squared standard deviations
  int max_rounds;
};

/// Pixel of a point, and its Jacobians (null to skip):
///
///   d = R_WH r + rho (p_H - p_C),   z = pi(R_WCᵀ d)
///   dz/dx_C = [J [d]x, -rho J],  dz/dx_H = [-J [R_WH r]x, rho J],  dz/drho = J (p_H - p_C),   J = dpi/dd_C R_WCᵀ
///
/// r      bearing in the host, R_WH r = ray_W        p_HC_W  p_H - p_C
/// x      (theta, p) of a pose, rotation on the world side
/// false  outside the camera's domain; outputs untouched
bool project_bearing(const Camera& camera, const Mat3& R_WC, const Vec3& ray_W, const Vec3& p_HC_W, Scalar rho,
                     Vec2* pixel, Mat26* J_z_C = nullptr, Mat26* J_z_H = nullptr, Vec2* J_z_rho = nullptr);

/// Huber's cost of a squared residual r2, in squared standard deviations, and the weight of its linearisation.
Scalar huber_cost(Scalar r2, Scalar huber, Scalar* weight);

/// Levenberg-Marquardt with the points eliminated one by one, in storage from the arena.
class BundleAdjuster {
 public:
  bool layout(Arena& arena, int max_poses, int max_free_poses, int max_points);

  /// Adjusts free poses and all rho; returns the robust cost, the prior included. Bounded by max_rounds.
  Scalar adjust(const Camera& camera, const AdjustOptions& options, const Bundle& bundle);

  /// One step from where the bundle is, without taking it: (theta, p) of each free pose in order, and the step of each
  /// rho.
  ///
  ///   | H_pp  W  | dx   |b|      damping:  D' = D (1 + damping);  S = H_pp - W D'⁻¹ Wᵀ;  S_ii += damping |S_ii| + 1e-9
  ///   | Wᵀ    D  | drho |g|      S dx = b - W D'⁻¹ g,   drho = D'⁻¹ (g - Wᵀ dx)
  ///
  /// False when S is not positive definite.
  bool step(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping);
  const Scalar* pose_step() const { return b_; }
  Scalar rho_step(int point) const;

  /// Covariance of (theta, p) of the last free pose, the points and the other free poses marginalised. False when
  /// something that is adjusted is not determined.
  bool last_pose_covariance(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Mat6* covariance);

 private:
  Scalar cost(const Camera& camera, const AdjustOptions& options, const Bundle& bundle) const;
  void linearise(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping);
  void add_pixel(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, int pose, int point);

  int max_free_ = 0;
  int columns_ = 0;                 ///< 6 times the free poses of this bundle
  int ld_ = 0;                      ///< 6 max_free_
  int* column_ = nullptr;           ///< first column of each pose, -1 where it is fixed
  Mat3* R_WC_ = nullptr;            ///< of each pose
  BundlePose* old_pose_ = nullptr;  ///< before the step that is tried
  Scalar* old_rho_ = nullptr;
  Scalar* H_ = nullptr;  ///< ld_ square: H_pp, then S, then its factor
  Scalar* b_ = nullptr;  ///< ld_
  Scalar* W_ = nullptr;  ///< max_points x ld_: Wᵀ, a row for each point
  Scalar* D_ = nullptr;  ///< max_points
  Scalar* g_ = nullptr;  ///< max_points
};

}  // namespace pf
