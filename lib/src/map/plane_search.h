#pragma once

#include <cstdint>

#include "map/known_surface.h"

/// Looks for planes among points that lie on none yet: lib/docs/theory/plane_search.md.

namespace pf {

/// A point that may lie on a plane that has not been found yet.
struct PlaneCandidate {
  Vec3 p_W;                   ///< [m]
  Mat3 covariance;            ///< of p_W itself [m²]
  int name;                   ///< in all searches: the caller's row of it
  bool is_explained = false;  ///< by the known surface: it belongs to no plane but that one
};

/// When points are called a plane. In the words of Gee 2007, section 3.3: l_T, d_T, d_max, lambda_T.
struct PlaneSearchSettings {
  int min_points = 7;                       ///< a plane has more points than this
  Scalar distance = Scalar(0.01);           ///< of a point from its plane [m]
  Scalar radius = 1;                        ///< of a point from the plane's origin [m]
  Scalar normal_variance = Scalar(2.5e-5);  ///< of the points about the plane, λ0 / count [m²]
  int trials = 100;                         ///< minimal sets that are drawn
  Scalar chi2 = Scalar(6.63);               ///< d² < chi2 (nᵀ Σ n + normal_variance)
  const KnownSurface* known = nullptr;      ///< beside the planes that are looked for; null: none
};

/// Largest number of points that a new plane starts with; others are folded later.
inline constexpr int kMaxPlaneMembers = 64;

/// One plane among the candidates, or none.
///
/// RANSAC with local support: the first point of a set is any, the two others lie within radius / 2 of it. A set counts
/// its points against those in the layers beside it. The best sets are refitted, and the first that passes is returned:
///
///   count > min_points,  λ0 / count < normal_variance,  the points span an area and not a line
///   every point is where the plane through the *other* points says      |r| / (1 - leverage) < distance
///   the points hang together                                             steps of at most radius / 2
///   the plane stands out of what is around it, and chance cannot explain it    false_alarms.h
///
/// search        number of this search: another one draws other sets. A set depends on it and on the names of points, not on how many
///               candidates there are, so that one point more or less changes few of them (base/draw_by_name.h)
/// members       room for kMaxPlaneMembers indices of candidates, which belong to the plane; the fit is theirs
/// false         nothing passed; outputs untouched
/// work          at most about trials x count steps, and no memory but some 3 kB of stack
/// src           Gee 2007, section 3.3. There the origin's set decides; here sets far from all others do not, points that
///               decide the plane alone are left out, and planes that clutter makes by chance are refused
bool search_plane(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings,
                  const Vec3& viewer_W, std::uint32_t search, PlaneFit* fit, int* members, int* member_count);

}  // namespace pf
