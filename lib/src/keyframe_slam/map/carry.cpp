#include "bundle/carry.h"

#include "base/table_entries.h"
#include "geometry/carry.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "vision/carry.h"

namespace pf {

/// Which numbers of it are open is the config's.
void KeyframeLens::carry(Archive& archive) {
  pf::carry(archive, camera_);
  archive.numbers(covariance_);
  if (rows_.has_readout()) archive.numbers(prior_camera_.readout, prior_.variance[rows_.count - 1]);
}

void KeyframeTable::carry(Archive& archive, const FeatureTable& features) {
  archive.counts(last_number_);
  archive.within(first_number_, kNone, Archive::kMaxCount + 1);
  archive.within(newest_, -1, capacity_ - 1);
  int count = 0;
  for (int k = 0; k < capacity_; ++k) {
    auto& [number, t_ns, q_WC, p_W, covariance, v_W, w_C, row_depth, matches_by_motion] = keyframe_[k];
    archive.within(number, 0, last_number_);
    if (number == 0) continue;
    ++count;
    archive.any(t_ns);
    archive.numbers(q_WC, p_W, covariance, v_W, w_C, row_depth);
    archive.flags(matches_by_motion);
    for (int i = 0; i < points_; ++i) {
      if (archive.is_reading()) pixels(k)[i] = {0, 0, false};
      if (features.used(i)) pf::carry(archive, pixels(k)[i]);
    }
    for (int other = 0; other < k; ++other) archive.require(keyframe_[other].number != number);
  }
  archive.require(count == 0 || newest_ >= 0);
  if (archive.is_reading()) count_ = count;
}

void KeyframeMap::carry(Archive& archive) {
  const FeatureTable& features = map_.features;
  lens_.carry(archive);
  keyframes.carry(archive, features);
  places.carry(archive);
  for (const int p : used_entries(places))  // as a keyframe again each could leave
    archive.require(static_cast<int>(places[p].id) <= keyframes.numbered());
  for (const int i : used_entries(features)) {
    auto& [host, ray_K, rho, variance, has_depth, faces_host, plane, remembered, pixel, seen_from] = point_[i];
    archive.within(host, 0, keyframes.capacity() - 1);
    archive.numbers(ray_K, rho, variance, remembered.mean, remembered.sigma, pixel);
    archive.flags(has_depth, faces_host);
    archive.within(plane, -1, map_.planes.capacity() - 1);
    pf::carry(archive, seen_from);
    archive.require(keyframes.used(host) && (plane < 0 || map_.planes.used(plane)));
  }
}

}  // namespace pf
