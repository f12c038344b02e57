#pragma once

#include <set>
#include <vector>

#include "planefold_platform/sim.h"
#include "sim/trajectory.h"
#include "vio_run.h"

namespace pfsim {

/// Judges the classes of a run's planes by the surfaces of its scene, and tells vertical ones that they are.
class VioPlaneWatch {
 public:
  /// W of the library is the first camera. scene may be null: there is nothing to judge.
  VioPlaneWatch(const pf_sim_t* scene, const pf::sim::Pose& first, const pf::sim::Vec3& gravity_W, double sigma_rad);

  void note(pf_slam_t* slam, bool gravity_known, bool last, VioPlanes* out);

 private:
  struct Surface {
    pf::sim::Vec3 n;  ///< in the first camera
    double d;
    int orientation;  ///< pf_orientation_t, whichever side of a horizontal one is seen
  };
  int class_of(const pf_plane_t& plane) const;

  pf::sim::Vec3 gravity_;  ///< unit, in the first camera
  double sigma_rad_;
  std::vector<Surface> surfaces_;
  std::set<std::uint32_t> told_;
};

}  // namespace pfsim
