#pragma once

#include <utility>

#include "memory/place_search.h"
#include "memory/place_table.h"

/// Where the camera may be, by how the points of parts of the map look in an image (lib/docs/theory/places.md).

namespace pf {

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

/// Adds the points of a place, and of those that belong to it, that the described image may show.
void collect_place(const PlaceSearch& search, const PlaceTable& places, int place, PlaceMatches* out);

/// The part that most of an image agrees with, and as its rival the one that agrees most with another pose.
class PlaceRecall {
 public:
  bool layout(Arena& arena, bool is_asked_for) { return search_.layout(arena, is_asked_for); }
  void init() { search_.init(); }

  void describe_image(const Tracker& tracker) { search_.describe_image(tracker); }
  const PlaceSearch& search() const { return search_; }

  /// Of the sources 0 .. count - 1, collect(i, &matches) -> PlaceSource: those with most matches are tried. apart: rotation [rad], and
  /// shift in depths, by which the pose of the rival is another one. The image must be described. False: no pose.
  template <typename Collect>
  bool find(const Camera& camera, int count, Scalar apart, Collect&& collect, Recalled* best, Recalled* rival) {
    *best = *rival = Recalled();
    Candidate candidate[kMaxCandidates];
    for (int i = 0; i < count; ++i) {
      PlaceMatches matches;
      collect(i, &matches);
      Candidate one = {i, matches.count};
      for (Candidate& held : candidate)
        if (one.matches > held.matches) std::swap(one, held);
    }
    Recalled found[kMaxCandidates];
    for (int c = 0; c < kMaxCandidates; ++c) {
      if (candidate[c].source < 0) continue;
      PlaceMatches matches;
      const PlaceSource source = collect(candidate[c].source, &matches);
      if (find_pose_of(camera, source, matches, &found[c]) && found[c].inliers > best->inliers) *best = found[c];
    }
    for (const Recalled& other : found)
      if (other.inliers > rival->inliers && is_apart(other, *best, apart)) *rival = other;
    return best->inliers > 0;
  }

 private:
  static constexpr int kMaxCandidates = 3;
  struct Candidate {
    int source = -1;
    int matches = 0;
  };

  bool find_pose_of(const Camera& camera, const PlaceSource& source, const PlaceMatches& matches, Recalled* out);
  static bool is_apart(const Recalled& a, const Recalled& b, Scalar apart);

  PlaceSearch search_;
};

}  // namespace pf
