#pragma once

#include "base/arena.h"
#include "geometry/pnp.h"
#include "memory/place.h"
#include "track/tracker.h"

/// Which places an image may show: corners of the image and points of places with descriptors that are alike, and the pose from which most
/// of them are where they should be (lib/docs/theory/places.md).

namespace pf {

class Archive;

/// Points of one place that the image may show.
struct PlaceMatches {
  static constexpr int kMax = 96;
  int count = 0;
  PnpPoint point[kMax];
  std::uint32_t id[kMax];

  void add(std::uint32_t feature, const Vec3& p_W, const Vec2& pixel) {
    if (count >= kMax) return;
    id[count] = feature;
    point[count++] = {p_W, Scalar(1), pixel};
  }
  bool has(std::uint32_t feature) const {
    for (int i = 0; i < count; ++i)
      if (id[i] == feature) return true;
    return false;
  }
};

class PlaceSearch {
 public:
  /// Room for the corners of an image; capacity 0: none.
  bool layout(Arena& arena, bool is_asked_for);
  void init();

  /// Describes the corners of the image that the tracker holds, in three resolutions. Costs some milliseconds.
  void describe_image(const Tracker& tracker);
  /// The corner that a point may be: alike, and clearly more so than any other. -1: none.
  int corner_of(const Descriptor& point) const;
  Vec2 pixel(int corner) const { return corner_[corner].pixel; }

  /// The pose from which most of the matches are where they should be. Its covariance allows for what the points share. Returns the number
  /// of inliers, 0 where they are too few. pose: where the place was seen from. is_inlier: of each match.
  int find_pose_of(const Camera& camera, const PlaceMatches& matches, PoseEstimate* pose, bool* is_inlier);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kLevels = 3;  ///< of the image's pyramid, that are described
  struct DescribedCorner {
    Vec2 pixel = Vec2::Zero();
    Descriptor descriptor[kLevels];
    bool has_level[kLevels] = {};
  };

  DescribedCorner* corner_ = nullptr;
  int capacity_ = 0, count_ = 0;
  std::uint32_t random_ = 1;
};

}  // namespace pf
