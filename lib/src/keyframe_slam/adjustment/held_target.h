#pragma once

#include "frame/start/start.h"
#include "keyframe_slam/adjustment/keyframe_bundle.h"

namespace pf {

class Archive;

/// Holds the target's points at the caller's coordinates while keyframes are adjusted.
class HeldTarget {
 public:
  void init() { target_ = Target(); }
  /// Holds the points of this target from now on. seen_from: any pose in front of them.
  void hold(const CameraView& seen_from, const Target& target) {
    view_ = seen_from;
    target_ = target;
  }

  /// Gives the target's points in the bundle a fixed pose as host, and their known inverse depths:
  ///
  ///   sigma_rho = sigma_m rho²
  void add_to(const KeyframeMap& map, AdjustedPoses* poses, AdjustedPoints* points) const;
  /// The keyframe that hosts the target's points has moved; they have not.
  void put_back(KeyframeMap* map) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  CameraView view_;
  Target target_;
};

}  // namespace pf
