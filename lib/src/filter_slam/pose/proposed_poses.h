#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "frame/settings.h"

/// Poses that the matches of frames in a row propose before any of them is believed.

namespace pf {

/// After a gap a single frame may agree with the map by chance, or because a picture like the last one is shown once more: of frames in
/// random order one in twenty is a neighbour of the one before. What tells is that the next frame proposes a pose to which a hand can have
/// moved the camera in the meantime.
class ProposedPoses {
 public:
  ProposedPoses(const Settings& settings, const Filter& filter) : settings_(settings), filter_(filter) {}

  struct Proposal {
    int frames = 0;  ///< in a row, up to this one, whose proposals follow each other; 0: none
    Quat q_WC = Quat::Identity();
    Vec3 p_W = Vec3::Zero();
    Scalar depth = 1;  ///< of what is seen, median
  };

  void init() { last_ = now_ = Proposal(); }
  /// A frame begins, dt_ns after the one before, and has proposed nothing yet.
  void begin_frame(std::int64_t dt_ns);
  /// That of the frame before.
  const Proposal& last() const { return last_; }
  /// This frame's proposal; a second one takes the place of the first. Returns Proposal::frames.
  int propose(const Quat& q_WC, const Vec3& p_W, Scalar depth);

 private:
  bool follows(const Proposal& next) const;

  const Settings& settings_;
  const Filter& filter_;
  Proposal last_, now_;
  std::int64_t dt_ns_ = 0;
};

}  // namespace pf
