#pragma once

#include <cstdint>

#include "base/arena.h"
#include "bundle/tuning.h"
#include "geometry/camera.h"
#include "geometry/lens.h"
#include "geometry/plane.h"

/// A small bundle adjustment: poses, points by their bearing and inverse depth in a host pose, planes on which some
/// of the points lie, and the lens that all poses share (lib/docs/window.md, lib/docs/starting.md).

namespace pf {

using Mat16 = Eigen::Matrix<Scalar, 1, 6>;

/// Where a pose saw a point.
struct BundlePixel {
  float x, y;  ///< [px]
  bool seen;
  std::uint8_t sigma_class = 0;  ///< index into AdjustOptions::class_sigma_px

  Vec2 pixel() const { return Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y)); }
};

struct BundlePose {
  Quat q_WC;
  Vec3 p_W;
  bool free;                 ///< false: not adjusted
  const BundlePixel* pixel;  ///< by point; null: this pose is a host only
};

/// A plane (geometry/plane.h): three numbers about a constant frame, which should lie near it.
struct BundlePlane {
  PlaneFrame frame;
  Vec3 x;            ///< (a, b, h)
  Scalar roughness;  ///< standard deviation of its points' distances from it [m]
  bool free;         ///< false: not adjusted
};

/// What is known of an inverse depth beforehand.
struct RhoPrior {
  Scalar mean;
  Scalar sigma;  ///< not above zero: nothing is known
};

/// Where a point's host saw it, which gives its bearing; not given: the bearing does not depend on the lens.
struct HostPixel {
  Vec2 pixel;
  bool given;
};

/// Parameters of the lens that are adjusted, about a prior.
struct BundleLens {
  LensRows rows;
  const Scalar* prior_information;  ///< rows x rows, row-major
  Camera prior;                     ///< its mean
  Camera* camera;                   ///< adjusted, in place of the camera that the calls below get
  const HostPixel* host_pixel;      ///< of each point
  Vec3* ray;                        ///< the bundle's; becomes the unit ray of the host's pixel where one is given
};

/// The distance of a free pose from a place. It holds the scale where no two fixed poses do; pixels are blind to it.
///
///   e = (|p - from| - distance) / sigma,   de/dp = uᵀ / sigma,  u = (p - from) / |p - from|
struct BundleDistance {
  int pose;
  Vec3 from_W;
  Scalar distance, sigma;
};

/// What is adjusted; a view of the caller's arrays. Something must hold position, rotation and scale: fixed poses, a
/// distance, or the prior on the inverse depths.
struct Bundle {
  BundlePose* pose;
  int poses;
  const Vec3* ray;  ///< of each point in its host pose; any length, which is the unit of 1 / rho
  const int*
      host;  ///< pose of each point; null: pose 0 for all. Pixels of a point in its own host say nothing and are skipped
  Scalar* rho;
  int points;
  const RhoPrior* prior = nullptr;  ///< of each point; null: the options' for all
  BundlePlane* plane = nullptr;
  int planes = 0;
  const int* plane_of = nullptr;  ///< plane of each point, -1 where it has none; null: of no point
  const Scalar* rho_before =
      nullptr;  ///< of each point, for relative_plane_distance; null: a plane's distances are lengths
  const BundleLens* lens = nullptr;      ///< null: the lens is exact
  const BundleDistance* held = nullptr;  ///< null: no distance is held
};

struct AdjustOptions {
  Scalar sigma_px;          ///< [px] of every pixel
  Scalar huber;             ///< residuals beyond this count linearly [standard deviations]
  Scalar rho_mean;          ///< prior on every inverse depth
  Scalar rho_sigma;         ///< its standard deviation; not above zero: there is no prior
  Scalar behind_weight;     ///< information of the prior is (1 + this) times larger where rho < 0
  Scalar no_pixel_penalty;  ///< cost of a seen point that has no pixel, in squared standard deviations
  int max_rounds;
  Scalar small_gain = tuning::adjust::kSmallGain;  ///< a step that lowers the cost by less than this share is the last
  const Scalar* class_sigma_px = nullptr;          ///< by BundlePixel::sigma_class, in place of sigma_px; null: none
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

/// Distance of a point from a plane, and its Jacobians (null to skip):
///
///   e = n . p - d,   p = p_H + q,   q = R_WH r / rho
///   de/dx_H = [(q x n)ᵀ, nᵀ],  de/drho = -n . q / rho,  de/dx by plane_distance
///
/// x_H    (theta, p) of the host, rotation on the world side; q turns with it: n . (theta x q) = theta . (q x n)
Scalar bearing_plane_distance(const BundlePlane& plane, const Vec3& ray_W, const Vec3& p_H, Scalar rho,
                              Mat13* J_e_plane = nullptr, Mat16* J_e_H = nullptr, Scalar* J_e_rho = nullptr);

/// The same distance in units of a length that grows with the point's depth, and its Jacobians:
///
///   e' = e rho / rho_before,   de'/drho = (rho de/drho + e) / rho_before,   the others multiplied by rho / rho_before
///
/// A distance is the smaller the smaller the map is, and draws it together where little holds its scale; this one does not change where all
/// lengths are multiplied by the same factor, and is the distance where nothing has moved.
Scalar relative_plane_distance(const BundlePlane& plane, const Vec3& ray_W, const Vec3& p_H, Scalar rho,
                               Scalar rho_before, Mat13* J_e_plane = nullptr, Mat16* J_e_H = nullptr,
                               Scalar* J_e_rho = nullptr);

using RayByLens = Eigen::Matrix<Scalar, 3, kLensParameters>;

/// Derivative of a point's pixel by the lens, through which the pixel and the bearing in the host were seen both:
///
///   z = pi(d_C; c),  d_C = R_CWᵀ(R_WH r(c) + rho (p_H - p_C)):   dz/dc = dpi/dc + dpi/dd_C R_CW R_WH dr/dc
///
/// J_z_d    2x3, dpi/dd_C R_CW
/// J_ray_W  R_WH dr/dc by ray_lens_jacobian; zero where the bearing does not depend on the lens
inline LensJacobian bearing_lens_jacobian(const Camera& camera, const Vec3& d_C, const Mat23& J_z_d,
                                          const RayByLens& J_ray_W) {
  return lens_jacobian(camera, d_C) + J_z_d.lazyProduct(J_ray_W);
}

/// Huber's cost of a squared residual r2, in squared standard deviations, and the weight of its linearisation.
Scalar huber_cost(Scalar r2, Scalar huber, Scalar* weight);

/// Levenberg-Marquardt with the points eliminated one by one, in storage from the arena.
///
/// The cost is, in squared standard deviations, with Huber's function h,
///
///   sum h(|z - pi|² / sigma²) + sum h(e² / roughness²) + sum ((rho - mean) / sigma_rho)² + (c - prior)ᵀ Λ (c - prior) + e_held²
///
/// c are the parameters of the lens that are adjusted. A pixel outside the camera's domain, a pixel whose bearing is, and a point on a
/// plane that is nearer to infinity than tuning says, cost no_pixel_penalty and have no derivative.
class BundleAdjuster {
 public:
  static constexpr int kMaxPoses = 32;  ///< of a bundle: as many as a mask has bits

  /// False: no room, or more than kMaxPoses.
  bool layout(Arena& arena, int max_poses, int max_free_poses, int max_points, int max_planes = 0,
              int max_lens_rows = 0);

  /// Adjusts free poses, free planes and all rho; returns the robust cost, which never rises. Bounded by max_rounds.
  Scalar adjust(const Camera& camera, const AdjustOptions& options, const Bundle& bundle);

  int rounds() const { return rounds_; }  ///< steps that the last adjust() has tried

  /// One step from where the bundle is, without taking it.
  ///
  ///   | H_pp  W  | dx   |b|      damping:  D' = D (1 + damping);  S = H_pp - W D'⁻¹ Wᵀ;  S_ii += damping |S_ii| + 1e-9
  ///   | Wᵀ    D  | drho |g|      S dx = b - W D'⁻¹ g,   drho = D'⁻¹ (g - Wᵀ dx)
  ///
  /// x holds (a, b, h) of each free plane, the lens, and then (theta, p) of each free pose, in the bundle's order. A D below one
  /// (a point that hardly anything is known of) is damped as if it were one.
  ///
  /// False when S is not positive definite.
  bool step(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping);
  const Scalar* plane_step() const { return b_; }
  const Scalar* lens_step() const { return b_ + plane_columns_; }
  const Scalar* pose_step() const { return b_ + plane_columns_ + lens_columns_; }
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
  /// What one point adds up to: rows of a point are w (a row of W), D and g.
  struct Sums {
    Scalar cost, D, g;
    std::uint32_t seen_by;  ///< bit f: w has entries for free pose f
    bool on_plane;          ///< and for its plane
  };

  void begin(const Bundle& bundle);
  void set_rotations(const Bundle& bundle);
  Scalar cost(const Camera& camera, const AdjustOptions& options, const Bundle& bundle);
  Scalar linearise(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping);
  template <bool kCostAlone>
  Sums add_point(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, int point);
  template <bool kCostAlone>
  void add_pixels(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, int point, Sums* sums);
  template <bool kCostAlone>
  void add_plane(const AdjustOptions& options, const Bundle& bundle, int point, Sums* sums);
  bool set_ray(const Bundle& bundle, int point, RayByLens* J_ray_W) const;
  Scalar add_lens_prior(const Bundle& bundle, bool cost_alone);
  Scalar add_held_distance(const Bundle& bundle, bool cost_alone);
  void eliminate(int point, const Sums& sums);
  bool solve(Scalar damping);
  bool take_step(const Bundle& bundle);
  void keep(const Bundle& bundle);
  void restore(const Bundle& bundle);
  void spread(int point, Scalar factor) const;
  Scalar gather(int point) const;

  int free_plane_of(int point) const {
    return plane_columns_ == 0 || plane_of_ == nullptr || plane_of_[point] < 0 ? -1 : free_plane_[plane_of_[point]];
  }
  int pose_column(int free_pose) const { return plane_columns_ + lens_columns_ + 6 * free_pose; }
  Scalar* lens_part(int point) const { return W_ + point * w_ld_ + plane_part_; }
  Scalar* pose_part(int point, int free_pose) const { return lens_part(point) + lens_columns_ + 6 * free_pose; }

  int ld_ = 0;             ///< 3 max_planes + max_lens_rows + 6 max_free_poses
  int w_ld_ = 0;           ///< plane_part_ + max_lens_rows + 6 max_free_poses
  int plane_part_ = 0;     ///< 3 if there may be planes, else 0
  int plane_columns_ = 0;  ///< 3 times the free planes of this bundle
  int lens_columns_ = 0;   ///< rows of this bundle's lens
  int columns_ = 0;        ///< both, and 6 times its free poses
  int rounds_ = 0;
  int* free_ = nullptr;             ///< number of each pose among the free ones, -1 where it is fixed
  int* free_plane_ = nullptr;       ///< and of each plane
  const int* plane_of_ = nullptr;   ///< the bundle's
  Mat3* R_CW_ = nullptr;            ///< of each pose
  BundlePose* old_pose_ = nullptr;  ///< before the step that is tried
  Vec3* old_plane_ = nullptr;
  Scalar* old_rho_ = nullptr;
  struct OfLens {
    Camera old;         ///< before the step that is tried
    RayByLens J_ray_W;  ///< of the point that is added, by all parameters
  };
  OfLens* of_lens_ = nullptr;  ///< null: no lens is ever adjusted
  std::uint32_t seen(int point) const;

  std::uint16_t* seen_ = nullptr;        ///< of each point, bit c: pose c sees it and is not its host
  std::uint16_t* seen_later_ = nullptr;  ///< the same of poses 16 to 31; null where there are never so many
  Scalar* H_ = nullptr;                  ///< ld_ square: S, then its factor
  Scalar* b_ = nullptr;                  ///< ld_
  Scalar* W_ = nullptr;  ///< max_points x w_ld_: a row for each point: its plane, the lens, each free pose
  Scalar* D_ = nullptr;  ///< max_points, damped; zero where nothing is known of a point
  Scalar* g_ = nullptr;  ///< max_points
};

}  // namespace pf
