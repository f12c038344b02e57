#pragma once

#include "base/archive.h"
#include "geometry/camera.h"
#include "geometry/held_pose.h"
#include "geometry/plane.h"

/// Archive: what the structs of this room hold.

namespace pf {

/// The numbers of a calibration, whose model and image size are the config's.
inline void carry(Archive& archive, Camera& camera) {
  archive.numbers(camera.fx, camera.fy, camera.cx, camera.cy, camera.distortion, camera.readout, camera.max_r2);
  archive.require(check_camera(camera) == nullptr);
}

inline void carry(Archive& archive, PlaneFrame& frame) {
  auto& [R_WP, o_W] = frame;
  archive.numbers(R_WP, o_W);
}

inline void carry(Archive& archive, RelativePlace& place) {
  auto& [q, p] = place;
  archive.numbers(q, p);
}

}  // namespace pf
