#pragma once

/// The largest capacities that a config may have (api/config.cpp). Arrays on the stack have room for them.

namespace pf {

inline constexpr int kMaxObservations = 200;  ///< capacity.max_observations
inline constexpr int kMaxPlanes = 64;         ///< capacity.max_planes
inline constexpr int kMaxPatches = 32;        ///< capacity.max_patches
inline constexpr int kMaxPlaces = 200;        ///< capacity.max_places
inline constexpr int kMaxAnchors = 64;        ///< capacity.max_anchors

}  // namespace pf
