#pragma once

#include <cstdint>

#include "base/arena.h"
#include "bundle/bearing.h"
#include "bundle/normal_equations.h"

namespace pf {

/// The terms of a bundle's cost, and their derivatives in its normal equations. In squared standard deviations, with Huber's function h,
/// the cost is
///
///   sum h(|z - pi|² / sigma²) + sum h(e² / roughness²) + sum ((rho - mean) / sigma_rho)² + (c - prior)ᵀ Λ (c - prior) + e_held²
///
/// c are the parameters of the lens that are adjusted. A pixel outside the camera's domain, a pixel whose bearing is, and a point on a
/// plane whose inverse depth is below the tuned bound, cost no_pixel_penalty and have no derivative.
class BundleTerms {
 public:
  static constexpr int kMaxPoses = 32;  ///< of a bundle: as many as a mask has bits

  NormalEquations equations;

  /// False: no room, or more than kMaxPoses.
  bool layout(Arena& arena, int max_poses, int max_free_poses, int max_points, int max_planes, int max_lens_rows);

  /// Numbers what is free, and lists which poses see which points. Before the functions below.
  void begin(const Bundle& bundle);
  Scalar cost(const Camera& camera, const AdjustOptions& options, const Bundle& bundle);
  /// Returns the cost. The equations become those about where the bundle is, with the points eliminated.
  Scalar linearise(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping);

  /// Number of a pose among the free ones, -1 where it is fixed; and of a plane, and of a point's plane.
  int free_pose(int pose) const { return free_[pose]; }
  int free_plane(int plane) const { return equations.plane_columns == 0 ? -1 : free_plane_[plane]; }
  int free_plane_of(int point) const {
    return plane_of_ == nullptr || plane_of_[point] < 0 ? -1 : free_plane(plane_of_[point]);
  }
  /// The bearing of a point's host pixel, and its derivative in W (null to skip). False where the lens has none; the bearing then stays.
  bool set_ray(const Bundle& bundle, int point, RayByLens* J_ray_W) const;

 private:
  /// What one point adds up to beside its row of W.
  struct Sums {
    Scalar cost, D, g;
    std::uint32_t seen_by;  ///< bit f: W has entries for free pose f
    bool on_plane;          ///< and for its plane
  };

  void set_rotations(const Bundle& bundle);
  std::uint32_t seen(int point) const;
  template <bool kCostAlone>
  Sums add_point(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, int point);
  template <bool kCostAlone>
  void add_pixels(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, int point, Sums* sums);
  template <bool kCostAlone>
  void add_plane(const AdjustOptions& options, const Bundle& bundle, int point, Sums* sums);
  Vec2 host_column(const Bundle& bundle, int point) const;
  Scalar add_lens_prior(const Bundle& bundle, bool cost_alone);
  Scalar add_held_distance(const Bundle& bundle, bool cost_alone);

  int* free_ = nullptr;            ///< of each pose
  int* free_plane_ = nullptr;      ///< of each plane
  const int* plane_of_ = nullptr;  ///< the bundle's
  Mat3* R_CW_ = nullptr;           ///< of each pose
  RayByLens* J_ray_W_ = nullptr;   ///< of the point that is added, by all parameters; null: no lens is ever adjusted
  std::uint16_t* seen_ = nullptr;  ///< of each point, bit c: pose c sees it and is not its host
  std::uint16_t* seen_later_ = nullptr;  ///< the same of poses 16 to 31; null where there are never so many
};

}  // namespace pf
