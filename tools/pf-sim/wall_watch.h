#pragma once

#include <map>
#include <vector>

#include "bed.h"
#include "run.h"

namespace pfsim {

/// Compares the planes of a run with the walls of its room.
class WallWatch {
 public:
  explicit WallWatch(const Bed& bed) : bed_(bed) {}

  /// While the run goes: every plane that has points, each by the worst share of its points on one wall that it ever had.
  void look(const pf_slam_t* slam, const std::vector<pf_feature_t>& map);
  /// At the end: what of the walls was found, twice, or not, and the normalised errors of planes that are true.
  void judge(const pf_slam_t* slam, const std::vector<pf_feature_t>& map, RunSummary& summary) const;

 private:
  struct Share {
    int wall = -1;
    int points = 0;
    double share = 0;
  };
  Share share_of(std::uint32_t plane, const std::vector<pf_feature_t>& map) const;

  const Bed& bed_;
  std::map<std::uint32_t, double> worst_;  ///< per id
};

}  // namespace pfsim
