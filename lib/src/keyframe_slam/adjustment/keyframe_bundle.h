#pragma once

#include <cstdint>

#include "base/arena.h"
#include "bundle/bundle.h"
#include "keyframe_slam/map/keyframe_map.h"

/// The keyframes, points and planes of one adjustment, in the form that the bundle adjustment reads.

namespace pf {

/// Poses: first those that are adjusted, then fixed ones whose pixels count, then hosts of points alone.
struct AdjustedPoses {
  int free = 0;             ///< that are adjusted, the newest keyframe's last
  int seen_in = 0;          ///< with these: whose pixels count
  int count = 0;            ///< all
  int* keyframe = nullptr;  ///< of each, -1 of the target's host
  BundlePose* pose = nullptr;
  BundlePixel* pixel = nullptr;  ///< max_features for each
  BundleRates* rates = nullptr;  ///< of each; null where the readout is exact
};

/// Points: first those that the poses see, then others of the same planes.
struct AdjustedPoints {
  int seen = 0;
  int count = 0;                ///< all
  std::int16_t* row = nullptr;  ///< of each in the map
  Vec3* ray = nullptr;
  int* host = nullptr;
  Scalar* rho = nullptr;
  Scalar* rho_before = nullptr;
  RhoPrior* prior = nullptr;
  int* plane_of = nullptr;          ///< or -1
  HostPixel* host_pixel = nullptr;  ///< null where the lens is exact
};

struct AdjustedPlanes {
  int count = 0;
  int* row = nullptr;  ///< of each in the table
  BundlePlane* plane = nullptr;
};

struct KeyframeBundle {
  AdjustedPoses poses;
  AdjustedPoints points;
  AdjustedPlanes planes;

  bool layout(Arena& arena, const Settings& settings);
};

/// Most poses of a bundle: all keyframes, and the target's host.
int max_bundle_poses();

/// Poses of the keyframes that were chosen, with the pixels of `stride` points each.
void fill_poses(const KeyframeMap& map, int stride, AdjustedPoses* poses);
/// Points that were chosen, and their pixels. Their hosts become fixed poses without pixels where they are not in the bundle yet.
void fill_points(const KeyframeMap& map, int stride, AdjustedPoses* poses, AdjustedPoints* points);
/// With which velocities the rows of each pose were read out.
void fill_rates(const KeyframeMap& map, const AdjustedPoses& poses);
/// A weak prior on inverse depths that leaves the scale where it is: it holds what nothing else does.
RhoPrior weak_prior(const AdjustedPoints& points);
/// Holds points that the bundle has no pixels of by the pixels of their own keyframes.
void hold_by_pixels(const KeyframeMap& map, Scalar sigma_px, AdjustedPoints* points);

}  // namespace pf
