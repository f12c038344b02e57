#pragma once

#include <cstdint>

#include "base/eigen.h"

namespace pf {

/// A second place of the camera that the caller knows: its distance from the first one is the scale.
struct SecondPose {
  bool given = false;
  std::int64_t t_ns = 0;    ///< of its frame
  Vec3 p_W = Vec3::Zero();  ///< the camera's
  bool estimated = false;   ///< the frame was recorded, and the record was solved
  Vec3 estimate_W = Vec3::Zero();
};

}  // namespace pf
