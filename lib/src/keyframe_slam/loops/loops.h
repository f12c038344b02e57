#pragma once

#include "keyframe_slam/loops/loop_finder.h"
#include "keyframe_slam/loops/loop_return.h"

/// Loops in the run's own map (lib/docs/theory/places.md): how far the window may have drifted, where its camera comes back to a place, and
/// what moves then. Without room for places nothing of it.

namespace pf {

class Archive;

class Loops {
 public:
  Loops(const Settings& settings, KeyframeMap& map, KeyframePlanes& planes, const NoiseModel& noise,
        const ImageSearch& images, const PoseBelief& belief)
      : settings_(settings), map_(map), finder_(settings, map, noise, images, belief), return_(settings, map, planes) {}

  bool layout(Arena& arena);
  /// A map begins.
  void init() {
    chain_.init();
    finder_.init();
  }

  /// After the adjustment of the newest keyframe.
  void add_keyframe(const KeyframeAdjustment& adjustment);
  /// After a tracked frame that is no keyframe: a return to a place, once (LoopFinder::look()).
  LoopClosure look(const KeyframeMotion& motion, Scalar depth) { return finder_.look(motion, depth, chain_); }
  /// Moves what the return moves (LoopReturn::close()).
  bool close(const LoopClosure& loop, bool* seen, Mat6* covariance) {
    return return_.close(loop, seen, &chain_, covariance);
  }
  /// How close() has moved what is nearest to a view.
  Similarity near(const Quat& q_WC, const Vec3& p_W, Scalar depth) const { return return_.near(q_WC, p_W, depth); }
  /// All of W is moved.
  void move(const Similarity& T) {
    chain_.move(T);
    finder_.forget();
  }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  const Settings& settings_;
  KeyframeMap& map_;
  DriftChain chain_;
  LoopFinder finder_;
  LoopReturn return_;
};

}  // namespace pf
