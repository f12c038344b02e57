#include "base/archive.h"
#include "keyframe_slam/keyframe_slam.h"

namespace pf {

void KeyframeMapping::carry(Archive& archive) {
  planes_.carry(archive);
  adjustment_.carry(archive);
  loops_.carry(archive);
  saving_.carry(archive);
}

void MapPlacement::carry(Archive& archive) {
  auto& [is_set, t_ns, q_WC, p_W, covariance] = mark_;
  archive.flags(is_set);
  archive.any(t_ns);
  archive.numbers(q_WC, p_W, covariance);
  walls_.carry(archive);
}

/// The tables of the map have been carried. Where there is a pose there is a keyframe, except in a map that was loaded and is not found.
void KeyframeSlam::carry(Archive& archive) {
  auto& [body_ns, since_last_ns, median_depth, is_map_fixed, has_image, young, second, frozen, warnings] = data_;
  auto& [given, second_ns, second_W, estimated, estimate_W] = second;
  archive.any(body_ns, since_last_ns, second_ns);
  archive.numbers(median_depth, second_W, estimate_W);
  archive.flags(is_map_fixed, has_image, young, given, estimated);
  frozen.carry(archive);
  warnings.carry(archive);
  map_.carry(archive);
  frame_.carry(archive, map_.tables().features);
  noise_.carry(archive);
  tracking_.carry(archive);
  motion_.carry(archive);
  planes_.carry(archive);
  search_.carry(archive);
  pose_.carry(archive);
  measuring_.carry(archive);
  relocaliser_.carry(archive);
  record_.carry(archive);
  mapping_.carry(archive);
  start_.carry(archive);
  placement_.carry(archive);
  unit_.carry(archive);
  if (!archive.is_reading()) return;
  const bool is_lost_in_loaded = start_.is_in_loaded_map() && map_.tables().features.count() == 0;
  archive.require(!tracking_.has_pose() || (motion_.is_sound() && (map_.keyframes.count() > 0 || is_lost_in_loaded)));
}

}  // namespace pf
