#include "map/carry.h"

#include "geometry/carry.h"
#include "map/map.h"
#include "vision/carry.h"

namespace pf {
namespace {

constexpr std::uint32_t kMaxTargetPoints = 16;  ///< Target::kMaxPoints

}  // namespace

void FeatureTable::carry(Archive& archive, int slots) {
  archive.any(next_id_);
  int count = 0;
  for (int i = 0; i < capacity_; ++i) {
    auto& [last_seen_ns, id, external_id, slot, observations, attempts, log_odds, residuals, rejections, is_target,
           has_appearance, began_by_wall, on_trial, was_missed] = feature_[i];
    archive.within(slot, -1, slots - 1);
    if (slot < 0) continue;
    ++count;
    archive.any(last_seen_ns, id, external_id, rejections);
    archive.counts(observations, attempts, residuals.frame);
    archive.numbers(log_odds, residuals.mean);
    archive.flags(is_target, has_appearance, began_by_wall, on_trial, was_missed);
    archive.require(id != 0 && (!is_target || external_id < kMaxTargetPoints));
  }
  if (archive.is_reading()) count_ = count;
}

void PlaneTable::carry(Archive& archive, int slots) {
  archive.any(next_id_);
  archive.within(next_merged_, 0, capacity_ * kMergesPerPlane - 1);
  for (int i = 0; i < capacity_ * kMergesPerPlane; ++i) archive.any(merged_[i].from, merged_[i].into);
  for (int i = 0; i < capacity_; ++i) {
    auto& [id, slot, age, weak, max_points, outliers, upheld, refused, seen, known, doubted, apart, two_sided,
           remembered, roughness, prior, plan, support] = entry_[i];
    archive.within(slot, -1, slots - 1);
    if (slot < 0) continue;
    archive.any(id);
    for (SmallCount* count : {&age, &weak, &max_points, &outliers, &upheld, &refused}) {
      int n = *count;
      archive.within(n, 0, SmallCount::kMax);
      if (archive.is_reading()) *count = n;
    }
    archive.flags(known, doubted, apart, two_sided, remembered);
    archive.numbers(roughness, prior);
    for (PlaneOutline* outline : {&seen, &plan, &support}) pf::carry(archive, *outline);
    archive.require(id != 0);
  }
}

void AnchorTable::carry(Archive& archive, int slots) {
  archive.any(last_id_);
  for (int i = 0; i < capacity_; ++i) {
    auto& [id, map_id, plane, is_on_plane, place, camera, t_ns, T_KV, between, T_VA, beside, pixel, T_WV, covariance_WV,
           T_WA, covariance] = anchor_[i];
    archive.any(id);
    if (id == 0) continue;
    archive.any(map_id, plane, place, t_ns);
    archive.flags(is_on_plane);
    archive.within(camera, Anchor::kAwaitsCamera, slots - 1);
    for (RelativePlace* each : {&T_KV, &T_VA, &T_WV, &T_WA}) pf::carry(archive, *each);
    archive.numbers(between, beside, pixel, covariance_WV, covariance);
  }
}

void Map::carry(Archive& archive, int slots) {
  features.carry(archive, slots);
  planes.carry(archive, slots);
  anchors.carry(archive, slots);
  archive.within(mark.camera, -1, slots - 1);
  archive.any(mark.t_ns);
  archive.numbers(target_normal_W);
  archive.flags(target_withdrawn);
  for (int i = 0; i < features.capacity(); ++i) {
    if (!features.used(i) || !features[i].has_appearance) continue;
    pf::carry(archive, appearance_[i].patch);
    pf::carry(archive, first_view_[i]);
    if (!has_templates()) continue;
    pf::carry(archive, template_[i], template_side_);
    archive.bytes(mask(i), static_cast<std::size_t>(mask_size_));
  }
}

}  // namespace pf
