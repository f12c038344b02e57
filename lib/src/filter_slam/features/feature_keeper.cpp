#include "filter_slam/features/feature_keeper.h"

#include <algorithm>

#include "base/table_entries.h"
#include "belief/feature_belief.h"
#include "filter_slam/features/tuning.h"
#include "filter_slam/features/wall_rays.h"
#include "frame/start/target_surface.h"
#include "frame/tuning.h"
#include "geometry/ray_plane.h"
#include "map/tuning.h"
#include "model/camera_at.h"
#include "observe/inverse_depth.h"

namespace pf {
namespace {

using namespace tuning::feature_keeper;

}  // namespace
bool FeatureKeeper::layout(Arena& arena, int max_features) {
  scratch_ = arena.take<int>(static_cast<std::size_t>(max_features));
  return arena.ok();
}

void FeatureKeeper::convert_linear() {
  ScaleRow l;
  filter_.scale_row(&l);
  const Vec3 c_W = camera_at(filter_.state(), Scalar(0)).p_W;
  for (const int i : used_entries(map_.features)) {
    const Block& block = filter_.state().block[map_.features[i].slot];
    if (block.kind != BlockKind::kInverseDepth) continue;
    // The unknown global scale is common to all points, so it must not delay conversion.
    const Scalar sigma_rho = filter_.relative_sigma_rho(map_.features[i].slot, l);
    const Vec3 o_W = filter_.state().block[block.parent].xyz();
    if (linearity_index(c_W, o_W, block.inverse_depth(), sigma_rho) < settings_.linearity_index) {
      filter_.convert_to_point(map_.features[i].slot);
      filter_.scale_row(&l);  // it may have been one of its points
    }
  }
}

void FeatureKeeper::drop_failing(bool is_tracked) {
  int count = 0;
  for (const int i : used_entries(map_.features)) {
    const Feature& f = map_.features[i];
    if (!filter_.block_is_sound(f.slot)) {
      scratch_[count++] = i;
      continue;
    }
    if (f.is_target || !is_tracked) continue;
    // A depth that is negative by three sigma is wrong.
    const Block& block = filter_.state().block[f.slot];
    const bool inverted =
        block.kind == BlockKind::kInverseDepth && block.inverse_depth().rho < Scalar(0) &&
        block.inverse_depth().rho * block.inverse_depth().rho > kSureSign * filter_.block_variance(f.slot, 2);
    if (is_no_point(static_cast<Scalar>(f.log_odds)) || inverted) scratch_[count++] = i;
  }
  drop(scratch_, count);
}

/// Removes table entries and their blocks, kChunk at a time in one pass over the covariance.
void FeatureKeeper::drop(const int* entries, int count) {
  constexpr int kChunk = 32;
  int slots[kChunk];
  for (int begin = 0; begin < count; begin += kChunk) {
    const int size = std::min(kChunk, count - begin);
    for (int k = 0; k < size; ++k) {
      const int entry = entries[begin + k];
      slots[k] = map_.features[entry].slot;
      frame_.forget(entry);
      map_.features.remove(entry);
    }
    filter_.remove(slots, size);
  }
  frame_.report.evicted += count;
}

void FeatureKeeper::drop_all() {
  for (const int i : used_entries(map_.features)) drop(&i, 1);
}

void FeatureKeeper::release(int entry) {
  frame_.forget(entry);
  map_.features.remove(entry);
}

/// Makes room for this many rows and one more feature by evicting features that were not seen in this frame. False: not enough of them.
bool FeatureKeeper::make_room(int rows) {
  while (map_.features.count() >= map_.features.capacity() || filter_.room() < rows ||
         filter_.state().find_free() < 0) {
    const int entry = map_.features.least_useful(frame_.report.t_ns);
    if (entry < 0) return false;
    drop(&entry, 1);
  }
  return true;
}

bool FeatureKeeper::make_rows(int rows, std::int64_t not_since_ns) {
  int free = filter_.room();
  for (int i = 0; i < map_.features.capacity(); ++i)
    if (map_.features.may_evict(i, not_since_ns)) free += filter_.state().block[map_.features[i].slot].size;
  if (free < rows) return false;
  while (filter_.room() < rows) {
    const int entry = map_.features.least_useful(not_since_ns);
    drop(&entry, 1);
  }
  return true;
}

bool FeatureKeeper::make_room_at(int* anchor) {
  if (*anchor >= 0) {
    if (!make_room(3)) return false;
    if (filter_.state().block[*anchor].kind == BlockKind::kAnchor) return true;
    *anchor = -1;
  }
  if (!make_room(6)) return false;
  *anchor = filter_.add_anchor();
  return *anchor >= 0;
}

/// Inverse depth for a new feature: the median of what was measured in this frame; if that is the target alone, that of a scene
/// kBehindTarget times as far; otherwise that of the start.
///
/// A target stands in front of the scene. Features that are initialised too near are dangerous while the target leaves the pose
/// uncertain: short depths with a rotation about the target explain the first frames too, and the filter may converge to that
/// (bas-relief ambiguity). Features that are initialised too far only wait for parallax.
Scalar FeatureKeeper::median_inverse_depth() const {
  const Scalar start = Scalar(1) / settings_.start_depth;
  if (!settings_.depth_from_map) return start;
  constexpr int kMost = 128;
  Scalar rho[kMost];
  int count = 0, on_target = 0;
  Scalar target_rho = 0;
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  const Vec3 forward = camera.q_WC.toRotationMatrix().col(2);
  for (int i = 0; i < map_.features.capacity() && count < kMost; ++i) {
    if (!map_.features.used(i) || map_.features[i].last_seen_ns != frame_.report.t_ns) continue;
    const Block& block = filter_.state().block[map_.features[i].slot];
    if (block.kind == BlockKind::kInverseDepth) {
      const Scalar rho_of = block.inverse_depth().rho;
      if (rho_of * rho_of < kSureSign * filter_.block_variance(map_.features[i].slot, 2)) continue;
    }
    const Vec3 p_W = filter_.point(map_.features[i].slot);
    const Scalar distance = (p_W - camera.p_W).norm();
    if (!(forward.dot(p_W - camera.p_W) > Scalar(0))) continue;
    if (map_.features[i].is_target) {
      target_rho += Scalar(1) / distance;
      ++on_target;
    } else {
      rho[count++] = Scalar(1) / distance;
    }
  }
  if (count >= kMinDepths) {
    std::nth_element(rho, rho + count / 2, rho + count);
    return rho[count / 2];
  }
  return on_target > 0 ? target_rho / (kBehindTarget * Scalar(on_target)) : start;
}

/// A point begins at the wall that its ray meets, by the plan; that does not reduce the wall's covariance. Nor do its pixels until it lies
/// on the wall (PixelUpdate): it may stand before it.
int FeatureKeeper::add(int anchor, const Vec2& pixel, const Mat2& noise) {
  Vec3 ray_C;
  Mat32 J_ray_pixel;
  if (!unproject(filter_.lens(), pixel, &ray_C, &J_ray_pixel)) return -1;
  const Scalar tau = row_time(filter_.lens(), pixel.y());
  const CameraAt camera = camera_at(filter_.state(), tau);
  Scalar range;
  const int wall = first_wall(filter_, map_, camera.p_W, camera.q_WC * ray_C, &range);
  int slot = -1;
  if (wall >= 0)
    slot = filter_.add_before_plane(anchor, map_.planes[wall].slot, ray_C, J_ray_pixel, noise,
                                    tuning::plane_walls::kOffWall, tau);
  const bool began_by_wall = slot >= 0;
  if (slot < 0) {
    const Scalar rho = median_inverse_depth();
    slot = filter_.add_inverse_depth(anchor, ray_C, J_ray_pixel, noise, rho,
                                     settings_.inverse_depth_relative_sigma * rho, tau);
  }
  const int entry = slot < 0 ? -1 : add_entry(slot);
  if (entry >= 0) map_.features[entry].began_by_wall = began_by_wall;
  return entry;
}

int FeatureKeeper::plane_at(const Vec2& pixel) const {
  Vec3 ray_C;
  if (!settings_.planes || !unproject(filter_.lens(), pixel, &ray_C)) return -1;
  const CameraAt camera = camera_of_row(filter_.state(), filter_.lens(), pixel.y());
  const Vec3 ray_W = camera.q_WC * ray_C;
  int nearest = -1;
  Scalar range2 = 0;
  for (const int i : used_entries(map_.planes)) {
    if (!map_.planes[i].is_proven(settings_.plane_min_points)) continue;
    const Block& block = filter_.state().block[map_.planes[i].slot];
    const PlaneFrame& frame = filter_.state().frame_of(block);
    Vec3 at;
    if (!intersect_ray_plane(frame, block.xyz(), camera.p_W, ray_W, &at)) continue;
    if (!outline_contains(map_.planes[i].seen, plane_coordinates(frame, at))) continue;
    const Scalar to2 = (at - camera.p_W).squaredNorm();
    if (nearest >= 0 && to2 >= range2) continue;
    nearest = map_.planes[i].slot;
    range2 = to2;
  }
  // Behind a wall nothing is seen of it.
  Scalar to_wall = 0;
  if (nearest >= 0 && first_wall(filter_, map_, camera.p_W, ray_W, &to_wall) >= 0 &&
      to_wall * to_wall * ray_W.squaredNorm() < range2)
    return -1;
  return nearest;
}

int FeatureKeeper::add_on_plane(int plane, const Vec2& pixel, const Mat2& noise) {
  Vec3 ray_C;
  Mat32 J_ray_pixel;
  if (!unproject(filter_.lens(), pixel, &ray_C, &J_ray_pixel)) return -1;
  const int slot = filter_.add_plane_point(plane, ray_C, J_ray_pixel, noise, row_time(filter_.lens(), pixel.y()));
  const int entry = slot < 0 ? -1 : add_entry(slot);
  if (entry >= 0) map_.features[entry].on_trial = true;
  return entry;
}

/// The table's entry of a new block, which goes where the table has no room.
int FeatureKeeper::add_entry(int slot) {
  const int entry = map_.features.add(slot);
  if (entry < 0) {
    filter_.remove(&slot, 1);
    return -1;
  }
  filter_.set_owner(slot, entry);
  Feature& feature = map_.features[entry];
  feature.observations = feature.attempts = 1;
  feature.last_seen_ns = frame_.report.t_ns;
  ++frame_.report.new_features;
  return entry;
}

int FeatureKeeper::add_target_point(const Target& target, int index) {
  return filter_.add_point(target.point_W[index], Mat3::Identity() * (target.sigma_m * target.sigma_m));
}

void FeatureKeeper::add_target_points(const Target& target) {
  map_.target_normal_W = target_normal(target);
  for (int i = 0; i < target.count; ++i) {
    const int slot = add_target_point(target, i);
    if (slot < 0) return;
    const int entry = map_.features.add(slot);
    if (entry < 0) return;
    filter_.set_owner(slot, entry);
    map_.features[entry].is_target = true;
    map_.features[entry].external_id = static_cast<std::uint32_t>(i);
    map_.features[entry].last_seen_ns = frame_.report.t_ns;
  }
}

}  // namespace pf
