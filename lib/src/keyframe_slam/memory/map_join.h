#pragma once

#include "geometry/similarity.h"
#include "keyframe_slam/memory/keyframe_recall.h"

/// Finds out where the present map is in an earlier one, which was left after a loss (lib/docs/theory/places.md).

namespace pf {

class Archive;

/// Where the present map is in another one.
struct MapJoin {
  std::uint32_t map_id = 0;        ///< of the other one; 0: nowhere
  Similarity T;                    ///< from W of the present map to W of the other one
  CameraView view;                 ///< of the present map, by which it was recognised
  Mat6 covariance = Mat6::Zero();  ///< of (theta, p) of that view in the other map
  Scalar sigma_scale = 0;          ///< relative
};

/// Two views that share little must say the same: that an image looks like a place of another map can have other reasons.
class JoinFinder {
 public:
  JoinFinder(const KeyframeMap& map, KeyframeRecall& recall) : map_(map), recall_(recall) {}

  void init() { before_ = found_ = MapJoin(); }
  /// After the image of this view was described. depth: median, of what it sees.
  void look(const CameraView& view, Scalar depth);
  /// What that has found, once.
  MapJoin take() {
    const MapJoin found = found_;
    found_ = MapJoin();
    return found;
  }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  bool recognise(const CameraView& view, MapJoin* out);
  int list_ratios(const PlaceMatches& matches, const PoseEstimate& there, const CameraView& view, Scalar* ratio) const;

  const KeyframeMap& map_;
  KeyframeRecall& recall_;
  MapJoin before_;  ///< by the last view that was recognised
  MapJoin found_;
};

}  // namespace pf
