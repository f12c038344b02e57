#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <unordered_map>
#include <vector>

#include "planefold_platform/sim.h"
#include "sim/linear.h"

namespace pfsim {

/// What a plane of the map is, against the surfaces of the scene. Plain data, for memory shared between processes.
struct PlaneVerdict {
  std::int32_t id = 0, points = 0;
  std::int32_t surface = -1;           ///< -1: no surface lies there
  std::int32_t explained_by = -1;      ///< where none does: a surface that is as far off as the plane's covariance says
  float normal_deg = 0, offset_m = 0;  ///< of the plane from the surface, the offset at the middle of the outline
  float nees = 0;     ///< of the plane against the surface, 3 degrees of freedom; negative: its covariance is none
  float area_m2 = 0;  ///< of the outline
  float covered = 0,
        overstep = 0;  ///< of what was seen of the surface: inside the outline; outline beyond all that was seen
};

struct SurfaceVerdict {
  std::int32_t surface = 0, planes = 0;  ///< planes that are it
  float seen_m2 = 0;                     ///< in view for kSeenSeconds
};

struct PlanesVerdict {
  static constexpr int kMost = 64;
  std::int32_t planes = 0, surfaces = 0;
  PlaneVerdict plane[kMost];
  SurfaceVerdict surface[kMost];
};

constexpr double kSeenSeconds = 3, kSeenArea = 0.5;  ///< a surface that was seen so much must be found
constexpr double kNormalBar = 2, kOffsetBar = 0.02;  ///< and within these [deg, m]

/// Keeps, for each surface of a scene, which part of it was in the picture and for how long.
class SurfaceWatch {
 public:
  SurfaceWatch(const pf_sim_t* sim, const pf_camera_t& camera);
  /// The view of a frame counts for that many seconds.
  void look(const pf_pose_t& truth, double seconds);
  PlanesVerdict judge(const pf_slam_t* slam) const;

 private:
  using Cells = std::unordered_map<std::int64_t, float>;  ///< seconds in view
  struct Surface {
    pf::sim::Vec3 n, u, v;
    double d = 0;
    Cells cells;
  };

  PlaneVerdict judge_one(const pf_plane_t& plane) const;
  PlaneVerdict compare(const pf_plane_t& plane, std::size_t k) const;
  void overlap(const pf_plane_t& plane, const Surface& surface, PlaneVerdict* verdict) const;

  const pf_sim_t* sim_;
  int width_, height_;
  std::vector<pf::sim::Vec3> ray_C_;  ///< of every second pixel, with z = 1
  std::vector<float> depth_;
  std::vector<std::int32_t> surface_at_;
  std::vector<Surface> surfaces_;
};

/// {true, false, duplicate, wanted, found, ...} over runs, and each run's planes.
nlohmann::json planes_json(const std::vector<const PlanesVerdict*>& runs);

}  // namespace pfsim
