#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "frame/frame.h"

namespace pf {

class Archive;

/// Follows the newest copy of the camera in the state (of an anchor, a mark, a patch or a place): a pose that the filter gave out, and
/// still estimates. As it moves, so have those that were given out about it. Without one updates are not reported.
class FollowedCamera {
 public:
  explicit FollowedCamera(const Filter& filter) : filter_(filter) {}

  void init() { data_ = Data(); }
  /// Adds how the camera has moved since it was followed, where it is still in the state; then follows the newest one, from where it is.
  void note(MapCorrection* correction) {
    correction->add(moved());
    follow_newest();
  }
  /// Follows the newest one from where it is: the state has been moved as a whole, or has begun again.
  void follow_newest();

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    int slot = -1;
    std::int16_t number = -1;  ///< of the block, by which it is known from others that come into its slot
    Quat q_WK = Quat::Identity();
    Vec3 p_WK = Vec3::Zero();
  };

  Similarity moved() const;

  const Filter& filter_;
  Data data_;
};

}  // namespace pf
