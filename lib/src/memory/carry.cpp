#include "vision/carry.h"

#include "memory/place_recall.h"

namespace pf {
namespace {

void carry_point(Archive& archive, PlacePoint& point) {
  auto& [id, plane, observations, ray_K, rho, covariance, q_KV, c_K, descriptor, patch] = point;
  auto& [centre, begin, end, pixels] = patch;
  archive.any(id, plane, descriptor.word);
  archive.counts(observations);
  archive.numbers(ray_K, rho, covariance, q_KV, c_K);
  carry_pixels(archive, centre[0], centre[1]);
  archive.require(rho > 1e-9f && rho < 1e9f);  // its position is a number
  for (int axis = 0; axis < 2; ++axis) {
    archive.within(begin[axis], 0, PlacePatch::kSize);
    archive.within(end[axis], begin[axis], PlacePatch::kSize);
  }
  archive.bytes(pixels, sizeof pixels);
}

}  // namespace

void PlaceTable::carry(Archive& archive) {
  archive.counts(returned_);
  for (int i = 0; i < capacity_; ++i) {
    auto& [id, map_id, is_back, count, depth, q_WK, p_WK, covariance, point] = place_[i];
    archive.within(id, 0, INT32_MAX);
    if (id == 0) continue;
    archive.any(map_id);
    archive.flags(is_back);
    archive.within(count, 0, KeptPlace::kMaxPoints);
    archive.numbers(depth, q_WK, p_WK, covariance);
    for (int k = 0; k < count; ++k) carry_point(archive, point[k]);
  }
}

/// What describes the corners of the last image that was asked for.
void PlaceSearch::carry(Archive& archive) {
  archive.any(random_);
  archive.within(count_, 0, capacity_);
  for (int i = 0; i < count_; ++i) {
    auto& [pixel, descriptor, has_level] = corner_[i];
    archive.numbers(pixel);
    for (int l = 0; l < kLevels; ++l) {
      archive.flags(has_level[l]);
      if (has_level[l]) archive.any(descriptor[l].word);
    }
  }
}

void PlaceRecall::carry(Archive& archive) { search_.carry(archive); }

}  // namespace pf
