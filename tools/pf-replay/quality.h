#pragma once

#include <vector>

#include "bed.h"

namespace replay {

/// How good a run is against the world that it saw.
class Quality {
 public:
  void add(const pf::sim::Pose& truth, const pf_pose_t& pose);
  /// The map at the end.
  void add(const std::vector<pfsim::WorldPoint>& truth, const std::vector<pf_feature_t>& map);

  double nees_pose() const { return mean(nees_, frames_); }  ///< mean of the frames, 6 expected
  double camera_rmse_m() const { return rms(square_m_, frames_); }
  double camera_rmse_rad() const { return rms(square_rad_, frames_); }
  double map_rmse_m() const { return rms(map_square_, points_); }

 private:
  static double mean(double sum, int count) { return count > 0 ? sum / count : 0; }
  static double rms(double sum, int count);

  int frames_ = 0, points_ = 0;
  double nees_ = 0, square_m_ = 0, square_rad_ = 0, map_square_ = 0;
};

}  // namespace replay
