#ifndef PLANEFOLD_CAPTURE_PLANE_VIEW_H
#define PLANEFOLD_CAPTURE_PLANE_VIEW_H

#include <planefold/planefold.h>

#include <cstdint>
#include <vector>

#include "maths.h"

namespace pf::capture {

/// A plane of the map, as it is written down and drawn: n · p = distance, n towards the side it was seen from.
struct PlaneView {
  uint32_t id = 0;
  Vec3 normal{};
  double distance = 0.0;
  double sigma = 0.0;         ///< of the distance at the middle of the outline [m]
  double sigma_normal = 0.0;  ///< of the normal, along its worst direction [rad]
  int points = 0;
  int fixed_points = 0;
  int trial = 0;         ///< of the points, those that began on it and have not shown by themselves that they lie there
  bool is_wall = false;  ///< a wall of the plan
  bool rejected = false;  ///< a wall that is not where the plan has it
  const char* orientation = "unknown";
  Vec3 origin{}, u{}, v{};    ///< a frame in the plane
  std::vector<Vec3> outline;  ///< convex, in W

  double area() const;
  Vec3 middle() const;  ///< of the outline
};

/// The planes of the map now.
std::vector<PlaneView> read_planes(const pf_slam_t* slam);

/// Corners of an outline cut to what a camera can see of it.
///
///   R_WC, p_WC  camera;  reach  largest |x / z| and |y / z| that are kept;  points in C with z > 0, in order
std::vector<Vec3> visible_part(const std::vector<Vec3>& outline, const double q_WC[4], const double p_WC[3],
                               const double reach[2]);

/// Lines of a square grid on a plane, cut to its outline: pairs of points in W.
std::vector<Vec3> grid_lines(const PlaneView& plane, double step);

/// Part of the segment from a to b that lies in the convex polygon; false when there is none.
bool clip_to_outline(const std::vector<Vec3>& outline, const Vec3& normal, Vec3& a, Vec3& b);

}  // namespace pf::capture

#endif
