#pragma once

#include <fstream>
#include <string>

#include "slam.h"

namespace pfsim::gee {

/// What the paper's Figure 1 shows, as tables in the room's own axes (x and y along walls, z up) [m]:
/// PREFIX_trajectory.csv, PREFIX_camera.csv, PREFIX_points.csv and PREFIX_planes.csv; the last three at named moments.
class Figure1 {
 public:
  Figure1(const std::string& prefix, const World& world);
  void add_pose(int frame, const Slam& slam);
  void add_map(const char* moment, int frame, const Slam& slam);

 private:
  void write(std::ofstream& out, const Vec3& p_W, const Vec3& true_W, const Mat3& covariance_W) const;

  const World& world_;
  std::ofstream trajectory_, camera_, points_, planes_;
};

}  // namespace pfsim::gee
