#pragma once

#include "base/archive.h"
#include "vision/appearance.h"
#include "vision/planar_template.h"
#include "vision/plane_patch.h"

/// Archive: what the structs of this room hold.

namespace pf {

inline void carry(Archive& archive, CameraView& view) {
  auto& [q_WC, c_W] = view;
  archive.numbers(q_WC, c_W);
}

void carry(Archive& archive, SourcePatch& patch);
void carry(Archive& archive, PlanarTemplate& shape, int max_side);
void carry(Archive& archive, PlanePatch& patch, int max_side);

/// A place that is counted in pixels, on one axis of an image or a patch.
template <typename... T>
void carry_pixels(Archive& archive, T&... x) {
  constexpr double kMaxPixel = 1e6;
  archive.numbers(x...);
  archive.require(((std::abs(static_cast<double>(x)) <= kMaxPixel) && ...));
}

}  // namespace pf
