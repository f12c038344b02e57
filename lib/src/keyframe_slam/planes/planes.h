#pragma once

#include <cstdint>

#include "frame/tuning.h"
#include "geometry/similarity.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "map/plane_search.h"

/// Where the planes of the window are, and which points lie on them (lib/docs/theory/window.md). Walls of a plan are planes that were known
/// before (walls/keyframe_walls.h).

namespace pf {

class Archive;

/// Beside its row in the plane table, with the same number. The plane lies in its frame.
struct KeyframePlane {
  PlaneFrame frame;
  Mat3 covariance = Mat3::Zero();  ///< of (a, b, h), given the keyframes that the last adjustment held fixed
  bool adjusted = false;           ///< the last adjustment has set it
  PlaneFrame plan;  ///< of a wall: as the plan has it; the wall's outlines are in the coordinates of any of its frames
};

class KeyframePlanes {
 public:
  KeyframePlanes(const Settings& settings, KeyframeMap& map)
      : settings_(settings), map_(map), table_(map.tables().planes) {}

  bool layout(Arena& arena);

  const KeyframePlane& plane(int k) const { return plane_[k]; }
  int points_on(int k) const;
  bool used(int k) const { return table_.used(k); }
  int capacity() const { return table_.capacity(); }
  /// Whether the map has measured where a wall is.
  bool is_measured(int wall) const { return points_on(wall) >= tuning::plane_lifecycle::kMinPoints; }
  /// [m] Of the surface.
  Scalar roughness_of(int k) const { return table_[k].known ? table_[k].roughness : settings_.fold.roughness; }

  // --- planes that come; each is an entry of the table
  void add_found(int k, const PlaneFrame& frame);
  /// Of a loaded map.
  void restore(int k, const PlaneFrame& frame, const Mat3& covariance) { plane_[k] = {frame, covariance, false, {}}; }
  /// Of a plan.
  void add_wall(int k, const PlaneFrame& plan) { plane_[k] = {plan, Mat3::Zero(), false, plan}; }

  // --- where they are
  /// All of W is moved.
  void move(const Similarity& T);
  void move(int k, const Similarity& T);
  /// Before what an adjustment says of planes.
  void begin_adjustment();
  /// Takes what an adjustment says of a plane: (a, b, h) about its frame, and their covariance. The plane gets a frame that it lies in.
  /// False where it has turned too far to be the same plane; nothing changes.
  bool take_adjusted(int k, const Vec3& x, const Mat3& covariance);
  /// A wall is where (a, b, h) about the plan's frame say.
  void set_wall(int k, const Vec3& x, const Mat3& covariance);
  /// Fits a plane to the first points that are listed.
  void fit(int k, int count);

  // --- points on them
  /// Whether a point is known well enough to be put on a plane. *covariance: of its place.
  bool is_certain(int i, Mat3* covariance) const;
  void put_on(int k, int i);
  /// Takes all points off a plane.
  void clear_points(int k);
  /// Lists the points on a plane: their places and rows. Returns how many.
  int list_points(int k);
  Vec3* points_W() { return map_.scratch().vector; }
  /// One for each point that is listed; its name is its row.
  PlaneCandidate* listed() { return candidate_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  bool lay(int k, const PlaneFrame& about, const Vec3& x, const Mat3& covariance);
  void set_frame(int k, const PlaneFrame& frame);

  const Settings& settings_;
  KeyframeMap& map_;
  PlaneTable& table_;
  KeyframePlane* plane_ = nullptr;  ///< max_planes
  PlaneCandidate* candidate_ = nullptr;
};

}  // namespace pf
