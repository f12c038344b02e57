#pragma once

#include "base/eigen.h"
#include "vision/patch.h"

namespace pf {

/// How a feature looked when it was first seen: the image around it. A plain copy: no pointers.
struct Appearance {
  SourcePatch patch;
};

/// A camera that has seen something: its orientation and its centre.
struct CameraView {
  Quat q_WC = Quat::Identity();
  Vec3 c_W = Vec3::Zero();
};

}  // namespace pf
