#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/table_entries.h"
#include "geometry/held_pose.h"
#include "geometry/similarity.h"

/// Table of anchors: poses that the caller set, each held by what moves when the map is corrected (lib/docs/theory/anchors.md).

namespace pf {

class Archive;

/// A chain of places: a reference K holds the camera V from which the anchor was set, and V holds the anchor A. Covariances are of
/// (theta, p) in W. What has no reference any more stays where it is in W.
struct Anchor {
  std::uint32_t id = 0;      ///< never used twice; 0: this entry is free
  std::uint32_t map_id = 0;  ///< of the map that it belongs to
  std::uint32_t plane = 0;   ///< id of the plane that it was set on, 0: none
  bool is_on_plane = false;  ///< which is there, and its ray meets it
  std::uint32_t place = 0;  ///< K with the window: number of a keyframe, or id of the place that it has become; 0: none
  int camera = kNoCamera;   ///< K with the filter: slot of a reference camera, which it pins
  std::int64_t t_ns = 0;    ///< of the frame in which it was set

  static constexpr int kNoCamera = -1;
  static constexpr int kAwaitsCamera =
      -2;  ///< the filter begins again, and K is the camera of this frame: to be copied once it is there

  RelativePlace T_KV;
  Mat6 between = Mat6::Zero();  ///< what V may be off from where K holds it
  RelativePlace T_VA;
  /// What A may be off from where V holds it. On a plane it follows from V and the plane, and counts where that is gone.
  Mat6 beside = Mat6::Zero();
  Vec2 pixel = Vec2::Zero();  ///< of V that it was set at, where it lies on a plane

  // --- at the end of the last frame of its map
  RelativePlace T_WV;
  Mat6 covariance_WV = Mat6::Zero();
  RelativePlace T_WA;
  Mat6 covariance = Mat6::Zero();

  /// Its plane is not there: it stays where V saw it last.
  void leave_plane() {
    if (is_on_plane) T_VA = T_WV.inverse().of(T_WA);
    is_on_plane = false;
  }
  /// Another reference holds V from now on, as far as it is known now. What the two have in common counts twice.
  void hold_by(std::uint32_t new_place, const RelativePlace& T_WK) {
    place = new_place;
    T_KV = T_WK.inverse().of(T_WV);
    between = covariance_WV;
  }
};

/// Where an anchor is asked for: a pose in W, or a point of a plane (an entry; -1: none), of which the rotation does not count.
struct AnchorRequest {
  int plane = -1;
  RelativePlace T_WA;
};

/// The plane that an anchor lies on, as it is known now.
struct AnchorPlane {
  PlaneFrame frame;
  Vec3 x = Vec3::Zero();
  Mat3 covariance = Mat3::Zero();  ///< of (a, b, h)
};

/// Places an anchor by its reference K, where K, V and the plane (null: none) are independent of each other.
void place_by(const RelativePlace& T_WK, const Mat6& covariance_WK, const AnchorPlane* plane, Anchor* anchor);

class AnchorTable {
 public:
  bool layout(Arena& arena, int capacity) {
    anchor_ = arena.take<Anchor>(static_cast<std::size_t>(capacity));
    capacity_ = capacity;
    return arena.ok();
  }
  void init() {
    for (int i = 0; i < capacity_; ++i) anchor_[i] = Anchor();
    last_id_ = 0;
  }

  int capacity() const { return capacity_; }
  bool used(int i) const { return anchor_[i].id != 0; }
  Anchor& operator[](int i) { return anchor_[i]; }
  const Anchor& operator[](int i) const { return anchor_[i]; }
  int entry_of(std::uint32_t id) const { return entry_with_id(*this, id); }
  int count() const;

  /// A free entry, or -1.
  int find_free() const;
  /// Puts an anchor into a free entry under a new id, which it returns.
  std::uint32_t add(int entry, const Anchor& anchor) {
    anchor_[entry] = anchor;
    return anchor_[entry].id = ++last_id_;
  }
  /// Puts one of a saved map into a free entry, under its own id.
  void restore(int entry, const Anchor& anchor) {
    anchor_[entry] = anchor;
    last_id_ = last_id_ > anchor.id ? last_id_ : anchor.id;
  }
  void remove(int i) { anchor_[i] = Anchor(); }

  /// A map is moved, and goes on under another id or the same one.
  void move(std::uint32_t map_id, std::uint32_t new_map_id, const Similarity& T);

  void carry(Archive& archive, int slots);  ///< base/archive.h; slots: of blocks

 private:
  Anchor* anchor_ = nullptr;
  int capacity_ = 0;
  std::uint32_t last_id_ = 0;
};

}  // namespace pf
