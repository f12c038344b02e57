#pragma once

#include <utility>

#include "memory/place_search.h"
#include "memory/place_table.h"

/// Where the camera may be, by how the points of parts of the map look in an image (lib/docs/theory/places.md).

namespace pf {

class Archive;

/// A pose that the points of a part of the map support: of a place, or of a keyframe.
struct Recalled {
  PoseEstimate pose;
  std::uint32_t place = 0;  ///< id of the place, or number of the keyframe
  Scalar depth = 1;         ///< of what is seen, median
  int inliers = 0;          ///< 0: there is none
};

/// A part of the map: the points of it that the image may show, and from where they were seen.
struct PlaceSource {
  std::uint32_t id = 0;
  Quat q_WK = Quat::Identity();
  Vec3 p_WK = Vec3::Zero();
};

/// Points that the poses which were tried explain.
struct ExplainedPoints {
  static constexpr int kMax = 3 * PlaceMatches::kMax;
  int count = 0;
  std::uint32_t id[kMax];

  void add(std::uint32_t feature) {
    if (count < kMax) id[count++] = feature;
  }
  void remove_from(PlaceMatches* matches) const;
};

/// The part that most of an image agrees with, and as its rival the one that agrees most with another pose.
class PlaceRecall {
 public:
  /// For so many places; 0: none.
  bool layout(Arena& arena, int places);
  void init() { search_.init(); }

  void describe_image(const Tracker& tracker) { search_.describe_image(tracker); }
  /// Matches the points of all places with the described image.
  void match_places(const PlaceTable& places);
  const PlaceSearch& search() const { return search_; }
  /// Adds the points of a place, and of those that belong to it, that what is described may show.
  void collect_place(const PlaceTable& places, int place, PlaceMatches* out) const;

  /// Of the sources 0 .. count - 1, collect(i, &matches) -> PlaceSource: the one with most matches is tried, and then again the one with
  /// most that no pose explains yet, so that places that look alike are tried one after the other. apart: rotation [rad], and shift in
  /// depths, by which the pose of the rival is another one. The image must be described. False: no pose.
  template <typename Collect>
  bool find(const Camera& camera, int count, Scalar apart, Collect&& collect, Recalled* best, Recalled* rival) {
    *best = *rival = Recalled();
    Recalled found[kMaxTried];
    ExplainedPoints explained;
    for (Recalled& one : found) {
      if (!try_next(camera, count, collect, &explained, &one)) break;
      if (one.inliers > best->inliers) *best = one;
    }
    for (const Recalled& other : found)
      if (other.inliers > rival->inliers && is_apart(other, *best, apart)) *rival = other;
    return best->inliers > 0;
  }

  /// Whether an image whose pose is known looks like another part of the map, which shares little with its own view (D >= kNear): the
  /// drift of a map that comes back to its beginning does not count. view: its pose, with the median depth. The others are as in find();
  /// most matches are those of its own points.
  template <typename Collect>
  bool is_alike(const Camera& camera, int count, const Recalled& view, Collect&& collect) {
    ExplainedPoints explained;
    for (int tried = 0; tried < kMaxTried; ++tried) {
      Recalled one;
      if (!try_next(camera, count, collect, &explained, &one)) return false;
      if (one.inliers > 0 && is_elsewhere(one, view)) return true;
    }
    return false;
  }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMaxTried = 3;
  static_assert(kMaxTried * PlaceMatches::kMax <= ExplainedPoints::kMax, "what is tried is explained");

  /// Tries the source with most matches that are not explained, and adds to these what its pose explains; where it gives no pose, all of
  /// them. False: none has enough.
  template <typename Collect>
  bool try_next(const Camera& camera, int count, Collect&& collect, ExplainedPoints* explained, Recalled* out) {
    int most = 0, source = -1;
    for (int i = 0; i < count; ++i) {
      PlaceMatches matches;
      collect(i, &matches);
      explained->remove_from(&matches);
      if (matches.count <= most) continue;
      most = matches.count;
      source = i;
    }
    if (most < least_matches()) return false;
    PlaceMatches matches;
    const PlaceSource from = collect(source, &matches);
    explained->remove_from(&matches);
    find_pose_of(camera, from, matches, explained, out);
    return true;
  }

  static int least_matches();
  void add_points(const PlaceTable& places, int place, PlaceMatches* out) const;
  void find_pose_of(const Camera& camera, const PlaceSource& source, const PlaceMatches& matches,
                    ExplainedPoints* explained, Recalled* out);
  static bool is_apart(const Recalled& a, const Recalled& b, Scalar apart);
  static bool is_elsewhere(const Recalled& a, const Recalled& b);

  PlaceSearch search_;
  std::int16_t* corner_ = nullptr;  ///< of each point of each place: what it may be in what is described, -1: nothing
};

}  // namespace pf
