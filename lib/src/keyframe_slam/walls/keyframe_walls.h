#pragma once

#include "base/small_count.h"
#include "base/status.h"
#include "frame/frame.h"
#include "keyframe_slam/adjustment/keyframe_adjustment.h"
#include "keyframe_slam/planes/planes.h"
#include "keyframe_slam/walls/wall_gauge.h"

/// Walls of a plan in the window. After Servant et al. 2008, section 2.2 (lib/docs/theory/walls.md).

namespace pf {

class Archive;

/// The map's planes are adjusted with its keyframes and points, walls among them, and the adjustment knows nothing of the plan. The plan
/// tells where the map as a whole is (WallGauge). A wall that the map has not measured is where the plan has it, as the gauge knows it.
class KeyframeWalls {
 public:
  KeyframeWalls(const Settings& settings, KeyframeMap& map, const Frame& frame, KeyframePlanes& planes)
      : settings_(settings), map_(map), table_(map.tables().planes), frame_(frame), planes_(planes) {}

  bool layout(Arena& arena);
  /// Of walls that the table has kept, all is as it was when they came.
  void init();

  /// Adds a wall. is_apart: the map's unit of length is not known, so that nothing can be compared with it. kFull: no room.
  Status add(const PlanePrior& prior, bool is_apart, std::uint32_t* id);

  /// Puts the newest keyframe's points on the walls that their rays meet in the plan, roughly. Returns how many; *depth: their median
  /// distance. With fewer than `least` nothing changes.
  int place_points(int least, Scalar* depth);
  /// The factor on lengths about the first place with which most points that a camera at c_W sees lie on walls; zero: not clear.
  Scalar find_factor(const Vec3& first_W, const Vec3& c_W);
  /// The map is in metres now, to the share to which points agree.
  void meet(const Mat6& first_pose, const Vec3& first_W);
  /// The map is held where it is in W, as well as that.
  void begin(const Mat6& pose, const Vec3& p_W, Scalar sigma_scale) { gauge_.begin(pose, p_W, sigma_scale); }
  bool has_begun() const { return gauge_.has_begun(); }

  /// After the adjustment of a keyframe: compares the walls that it has measured with the plan. Returns by how much the map is to be moved.
  Similarity compare(const KeyframeAdjustment& adjustment);
  /// After that, with the map moved: walls that are not measured go where the gauge has them, points join, and walls are judged. Returns a
  /// further move, where a wall was rejected.
  Similarity maintain(const KeyframeAdjustment& adjustment, const CameraView& view);

  /// Of a pose of the map, from where the map is.
  Mat6 pose_covariance(const Vec3& p_W) const { return gauge_.pose_covariance(p_W); }
  /// Of (a, b, h) of a wall in W.
  Mat3 covariance(int wall) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  bool is_used(int k) const { return table_.used(k) && table_[k].known && table_[k].counts(); }
  void place(int k);
  void join(int k, const KeyframeAdjustment& adjustment, const CameraView& view);
  bool join_found(int k, const CameraView& view, const int* row, int count);
  void merge_emptied(int wall);
  bool judge(int k, const CameraView& view, Similarity* T);
  Similarity reject(int k);
  Scalar distance_variance(int k, const Vec3& p_W, const Mat3& covariance, Vec3* by_plane) const;

  const Settings& settings_;
  KeyframeMap& map_;
  PlaneTable& table_;
  const Frame& frame_;
  KeyframePlanes& planes_;
  WallGauge gauge_;
  MeasuredWall* measured_ = nullptr;  ///< in one keyframe
  std::uint32_t random_ = 1;          ///< of what is drawn before walls
  int newest_compared_ = 0;           ///< number of the keyframe
  SmallCount* compared_ = nullptr;    ///< keyframes by which each wall was, since the map measures it
};

}  // namespace pf
