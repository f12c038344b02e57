#pragma once

#include <cstdint>

#include "keyframe_slam/planes/planes.h"

namespace pf {

class Archive;

/// Tends to the planes of the window: found among its points, fitted again where the adjustment had no part of them, merged and dissolved
/// (lib/docs/theory/window.md). Walls of a plan take points and other planes, and stay.
class PlaneUpkeep {
 public:
  PlaneUpkeep(const Settings& settings, KeyframeMap& map, KeyframePlanes& planes)
      : settings_(settings), map_(map), table_(map.tables().planes), planes_(planes) {}

  void init() { searches_ = 0; }
  /// The work of one keyframe, after its adjustment.
  void maintain(const Vec3& viewer_W);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  int drop_distant_points(int k);
  void refit(int k) { planes_.fit(k, drop_distant_points(k)); }
  bool lies_on(int k, const Vec3& p_W, const Mat3& covariance) const;
  void take_points(int k);
  void outline(int k);
  void discover();
  void merge();
  bool may_merge(int other, int k) const;
  bool is_inside(int wall, int count) const;
  void dissolve_weak();

  const Settings& settings_;
  KeyframeMap& map_;
  PlaneTable& table_;
  KeyframePlanes& planes_;
  Vec3 viewer_W_ = Vec3::Zero();  ///< of this keyframe
  std::uint32_t searches_ = 0;    ///< for new planes, so far
};

}  // namespace pf
