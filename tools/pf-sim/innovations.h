#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "planefold_platform/sim.h"
#include "sim/linear.h"

namespace pfsim {

/// What a track belongs to.
enum class TrackKind { kInverseDepth, kPoint, kTarget };
constexpr int kTrackKinds = 3;
constexpr std::array<const char*, kTrackKinds> kTrackKindName{"inverse_depth", "point", "target"};

/// Correlation of a 2-vector with itself one frame later, over all features: sum of a.b over the root of sum a.a sum b.b.
struct LagOne {
  double ab = 0, aa = 0, bb = 0;
  void add(const double a[2], const double b[2]);
  void add(const LagOne& other);
  double value() const;
};

/// Sums over the inliers of one kind. Plain data, so that it may lie in memory shared between processes.
struct InnovationSums {
  double nis = 0, count = 0;  ///< normalised innovation squared, two degrees of freedom each
  double square = 0;          ///< of the innovation [px^2]
  double match_square = 0;    ///< of the match itself against the truth, where it is below kMatchReach [px^2]
  double match_count = 0, match_far = 0;
  LagOne innovation, match;
  void add(const InnovationSums& other);
};

/// A match that is further from its true place than this is one of another thing (an occluding edge) [px].
constexpr double kMatchReach = 0.5;

/// What a frame truly shows, made when it is first asked for.
class FrameDepth {
 public:
  FrameDepth(const pf_sim_t* sim, const pf_camera_t& camera);
  /// Along z [m]; 0 where nothing is.
  double at(const pf_pose_t& truth, long x, long y);
  /// Number of the surface; -1 where nothing is.
  std::int32_t surface_at(const pf_pose_t& truth, long x, long y);

 private:
  const pf_sim_t* sim_;
  int width_;
  std::int64_t t_ns_ = -1;
  std::vector<float> depth_;
  std::vector<std::int32_t> surface_;

  std::size_t look(const pf_pose_t& truth, long x, long y);
};

/// Reads a context's tracks after every frame. The place where a match should be is the truth's: the point of the surface
/// that a feature's first pixel shows, or the target's corner, projected with the true pose.
class InnovationWatch {
 public:
  InnovationWatch(const pf_config_t& config, const pf_target_t& points);
  void read(const pf_slam_t* slam, const pf_pose_t& truth, FrameDepth& depth);
  const InnovationSums& sums(TrackKind kind) const { return sums_[static_cast<std::size_t>(kind)]; }
  /// Frames in which a feature was measured, as mean over those that were measured at all. 0: none was.
  double track_length() const;

 private:
  struct Past {
    int frame = -2, frames = 0;
    double innovation[2] = {}, match[2] = {};
    bool match_valid = false;
  };
  void learn_kinds(const pf_slam_t* slam);
  void learn_places(const pf_pose_t& truth, FrameDepth& depth);
  bool match_error(const pf_match_t& track, const pf::sim::Pose& truth, double error[2]) const;

  pf_camera_t camera_;
  pf_target_t points_;
  std::vector<pf_feature_t> features_;
  std::vector<pf_match_t> tracks_;
  std::map<std::uint32_t, int> target_index_;       ///< of features that are points of the target
  std::map<std::uint32_t, pf::sim::Vec3> place_W_;  ///< true places
  std::map<std::uint32_t, Past> past_;
  std::array<InnovationSums, kTrackKinds> sums_{};
  int frame_ = 0;
};

}  // namespace pfsim
