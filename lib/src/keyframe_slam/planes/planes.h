#pragma once

#include <cstdint>

#include "keyframe_slam/map/keyframe_map.h"
#include "map/plane_search.h"

/// Planes of the window: found among its points, fitted again with every adjustment, merged and dissolved (lib/docs/theory/window.md).

namespace pf {

class Archive;

/// Beside its row in the plane table, with the same number. The plane lies in its frame.
struct KeyframePlane {
  PlaneFrame frame;
  Mat3 covariance = Mat3::Zero();  ///< of (a, b, h), given the keyframes that the last adjustment held fixed
  bool adjusted = false;           ///< the adjustment of this keyframe has set it
};

class KeyframePlanes {
 public:
  KeyframePlanes(const Settings& settings, KeyframeMap& map)
      : settings_(settings), map_(map), table_(map.tables().planes) {}

  bool layout(Arena& arena);
  void init() { searches_ = 0; }

  /// The work of one keyframe, after its adjustment.
  void maintain(const Vec3& viewer_W);

  /// Of a loaded map, an entry that the table has restored.
  void restore(int k, const PlaneFrame& frame, const Mat3& covariance) { plane_[k] = {frame, covariance, false}; }

  const KeyframePlane& plane(int k) const { return plane_[k]; }
  int points_on(int k) const;
  bool used(int k) const { return table_.used(k); }
  int capacity() const { return table_.capacity(); }
  /// Multiplies lengths by s about a place.
  void scale(Scalar s, const Vec3& c_W);

  /// Takes what an adjustment says of a plane: (a, b, h) about its frame, and their covariance. The plane gets a frame that it lies in.
  /// False where it has turned too far to be the same plane; nothing changes.
  bool take_adjusted(int k, const Vec3& x, const Mat3& covariance);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  int drop_distant_points(int k);
  void refit(int k);
  bool is_settled(int i, Mat3* covariance) const;
  bool lies_on(int k, const Vec3& p_W, const Mat3& covariance) const;
  void set_frame(int k, const PlaneFrame& frame);
  void put_on(int k, int i);
  void take_points(int k);
  void outline(int k);
  void discover(const Vec3& viewer_W);
  void merge();
  void dissolve_weak();
  void dissolve(int k);
  int list_points(int k);
  /// Places of the points that are listed.
  Vec3* points_W() { return map_.scratch().vector; }

  const Settings& settings_;
  KeyframeMap& map_;
  PlaneTable& table_;
  KeyframePlane* plane_ = nullptr;       ///< max_planes
  PlaneCandidate* candidate_ = nullptr;  ///< one for each point that is listed; its name is its row
  Vec3 viewer_W_ = Vec3::Zero();         ///< of this keyframe
  std::uint32_t searches_ = 0;           ///< for new planes, so far
};

}  // namespace pf
