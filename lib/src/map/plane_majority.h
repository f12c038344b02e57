#pragma once

#include <cstdint>

#include "base/eigen.h"

/// The plane of most points of a set, and which of them do not lie on it.

namespace pf {

/// Largest number of points that are judged together.
inline constexpr int kMaxJudged = 64;

/// A point's own place, independent of its plane.
struct JudgedPoint {
  Vec3 p_W = Vec3::Zero();  ///< [m]
  Scalar variance = 0;      ///< of its height above the plane, up to a factor that all points share [m²]
  bool is_off = false;      ///< out: it does not lie on the plane of the others
};

struct MajoritySettings {
  int min_points = 7;                  ///< more than so many have to be known well
  Scalar distance = Scalar(0.01);      ///< twice the standard deviation of a height that is known well [m]
  Scalar roughness = Scalar(0.002);    ///< standard deviation of a point's own height [m]
  Scalar least_factor = Scalar(0.04);  ///< of the variances, at least
};

/// Heights above it have the error h + t1 u1 + t2 u2, u the coordinates of a place about c_W along e_W.
struct MajorityPlane {
  Vec3 n_W = Vec3::Zero(), c_W = Vec3::Zero();
  Vec3 e_W[2] = {Vec3::Zero(), Vec3::Zero()};
  Vec3 variance = Vec3::Zero();  ///< of (h, t1, t2), which are independent of each other
  Vec3 bent = Vec3::Zero();      ///< (h, t1, t2) that it would have if the points that are off were fitted as well
  int members = 0;               ///< points that it was fitted to
  int off = 0;
};

/// The plane whose median point is nearest, in standard deviations, among those through three of the better known half (least median of
/// squares), fitted again to what lies within three of them. An error that all points share, as the drift of the world, is in that plane,
/// and does not separate points; bent is the difference of two fits, in which it cancels.
///
///   sigma_i^2 = factor variance_i + roughness^2
///   factor      (1 + 5 / (n - 3))^2 median r_i^2 / variance_i over the median of a chi-square, 0.455; with each further fit that times
///               chi^2 / (members - 3), where that is below 1
///   bent      (sum u_i u_i^T / sigma_i^2)^-1 sum u_i r_i / sigma_i^2 over members and points that are off,   u = (1, u1, u2)
///   is_off    |r_i| > 4 sqrt(sigma_i^2 + variance of the plane there), where that root is below distance / 2
///
/// n_W    a normal that the plane's is within kSameSide of
/// false  too few points are known well, or fewer than two thirds agree; outputs untouched
bool find_majority(JudgedPoint* points, int count, const Vec3& n_W, const MajoritySettings& settings,
                   std::uint32_t seed, MajorityPlane* plane);

}  // namespace pf
