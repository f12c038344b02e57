#pragma once

#include "base/arena.h"
#include "geometry/plane.h"
#include "geometry/similarity.h"

/// Where the map of the window is in W, and where the walls of a plan are: a Kalman filter over both (lib/docs/theory/walls.md).

namespace pf {

class Archive;

/// A wall that the map has measured.
struct MeasuredWall {
  int wall;          ///< entry
  PlaneFrame plan;   ///< the frame about which it is estimated
  PlaneFrame frame;  ///< in which it lies in the map
  Mat3 covariance;   ///< of (a, b, h) about that, given where the map is
  bool fits;         ///< it passes the gate; set by WallGauge::compare()
};

/// The window's map has a shape that its own images give, and a place, a rotation and a size in W that they do not. These seven numbers g,
/// as plane_gauge() has them, and (a, b, h) of each wall about the frame of the plan are the state; the priors of the plan are independent
/// of each other and of g. A wall that the map has measured at z in its own coordinates, with the covariance R, is one measurement of both:
///
///   z = x_k - G g + v,   v ~ N(0, R),   G = plane_gauge(plan, 0)
///
/// The mean of g is zero: what an update makes of it is a Similarity by which the caller moves the map. In double in both libraries.
class WallGauge {
 public:
  static constexpr int kMapRows = 7;
  using Wide3 = Eigen::Matrix<double, 3, 3>;

  bool layout(Arena& arena, int max_walls);
  void init();

  int capacity() const { return walls_; }
  bool has_begun() const { return has_begun_; }
  /// The map is held by a pose at p_W with a covariance of (theta, p), and its size is known to a share.
  void begin(const Mat6& pose, const Vec3& p_W, Scalar sigma_scale);
  /// A wall of the plan, entry k, with the covariance of (a, b, h).
  void add(int k, const Mat3& covariance);
  bool has(int k) const { return has_[k]; }

  /// The map about p_W has moved on: a pose there may be off by as much more, and the size by a share.
  void drift(const Mat6& pose, const Vec3& p_W, Scalar sigma_scale);
  /// Compares the map with the plan, and returns by how much the map is to be moved. Linearised anew where that puts the map. A wall whose
  /// chi-square (3) is above the gate has no part in it.
  Similarity compare(MeasuredWall* walls, int count, Scalar gate);
  /// Takes a wall out, and what its prior has told but for a share of 1 / widening. C: the prior.
  ///
  ///   P' = P + P_xk M P_kx,   x' = x + P_xk M x_k,   M = ((1 + 1 / widening) C - P_kk)^-1
  /// Returns by how much the map is to be moved.
  Similarity forget(int k, const Mat3& C, Scalar widening);

  const Vec3& wall(int k) const { return wall_[k]; }
  Mat3 wall_covariance(int k) const;
  /// Of where the map has a plane, in its own coordinates, against where it is: of x_k - G g.
  Mat3 relative_covariance(int k, const PlaneFrame& plan) const;
  /// Of (a, b, h) of a plane of the map, as far as it follows from g: G P_gg Gᵀ.
  Mat3 plane_covariance(const PlaneFrame& frame) const;
  /// Of (theta, p) of a pose of the map, the same.
  Mat6 pose_covariance(const Vec3& p_W) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  int row_of(int k) const { return kMapRows + 3 * k; }
  double& at(int i, int j) { return P_[i * rows_ + j]; }
  double at(int i, int j) const { return P_[i * rows_ + j]; }
  void clear_rows(int from, int count);
  Wide3 block(int k) const;
  void shift(int i, double by);
  bool measure(int k, const PlaneFrame& plan, const Vec3& z, const Mat3& R, Scalar gate);
  void begin_again(const Similarity& moved);
  Similarity take_correction();

  double* P_ = nullptr;       ///< rows_ squared
  double* before_ = nullptr;  ///< the same, before a comparison
  double* gain_ = nullptr;    ///< rows_ x 3
  double* cross_ = nullptr;   ///< rows_ x 3
  Vec3* wall_ = nullptr;      ///< (a, b, h)
  Vec3* wall_before_ = nullptr;
  bool* has_ = nullptr;
  double g_[kMapRows] = {};
  int walls_ = 0, rows_ = 0;
  bool has_begun_ = false;
};

}  // namespace pf
