#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "innovations.h"

namespace pfsim {

/// What became of the features that lie on a surface of the scene. Plain data, for memory shared between processes.
struct FoldSums {
  std::int32_t due = 0;      ///< features that were measured in kTogetherFrames frames with their surface well in view
  std::int32_t folded = 0;   ///< of these, in a plane by then, and that plane is their surface
  std::int32_t young = 0;    ///< not: still an inverse depth
  std::int32_t missing = 0;  ///< not: no plane of the map is their surface
  std::int32_t waiting = 0;  ///< not, though there is a plane that is their surface
  std::int64_t planar = 0;   ///< points on planes, summed over frames, whose place on a surface is known
  std::int64_t wrong = 0;    ///< of these, on a plane that is another surface, from which they are kWrongOffset or more
  void add(const FoldSums& other);
};

constexpr int kTogether = 8;           ///< features of a surface that are measured in one frame: it is well in view
constexpr int kTogetherFrames = 60;    ///< such frames after which a feature should be folded
constexpr double kWrongOffset = 0.02;  ///< [m]

/// Reads a context after every frame and counts which features of the scene's surfaces are folded into the right plane. A feature lies on
/// the surface that its first pixel shows; one at a rim, where pixels beside it show another, is left out. A plane is the surface that
/// most of its points lie on.
class FoldWatch {
 public:
  FoldWatch(const pf_sim_t* sim, const pf_config_t& config);
  void read(const pf_slam_t* slam, const pf_pose_t& truth, FrameDepth& depth);
  const FoldSums& sums() const { return sums_; }

 private:
  struct Seen {
    std::int32_t surface = -1;  ///< -1: at a rim, or on nothing that is flat
    pf::sim::Vec3 p_W;
    int together = 0;
  };
  void learn_places(const pf_pose_t& truth, FrameDepth& depth);
  void name_planes();
  void count_planar();
  void judge(const pf_feature_t& feature);
  bool has_plane(std::int32_t surface) const;

  const pf_sim_t* sim_;
  pf_camera_t camera_;
  std::vector<pf_feature_t> features_;
  std::vector<pf_match_t> matches_;
  std::map<std::uint32_t, Seen> seen_;                   ///< by feature
  std::map<std::uint32_t, std::int32_t> plane_surface_;  ///< of the planes of this frame
  FoldSums sums_;
};

/// {due, folded, share, ...} over runs.
nlohmann::json folds_json(const FoldSums& sums);

}  // namespace pfsim
