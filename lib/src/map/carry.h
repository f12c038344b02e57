#pragma once

#include "base/archive.h"
#include "map/plane_outline.h"

namespace pf {

/// Archive.
inline void carry(Archive& archive, PlaneOutline& outline) {
  auto& [count, uv] = outline;
  archive.within(count, 0, kMaxOutline);
  for (int i = 0; i < count; ++i) archive.numbers(uv[i]);
}

}  // namespace pf
