#include "filter_slam/patches/initialisation/patch_initialiser.h"

#include <algorithm>

#include "base/table_entries.h"
#include "geometry/ray_plane.h"
#include "model/camera_at.h"

namespace pf {

void drop_patch(Filter& filter, PatchStore& store, int entry) {
  const StoredPatch& patch = store[entry];
  if (patch.is_proven())
    filter.remove(&patch.block, 1);
  else
    filter.unpin(patch.camera);
  store.remove(entry);
}

bool PatchInitialiser::initialise(const ImageView& image, int wall, const PatchSquare& square, int* camera) {
  if (!make_room(PatchMeasurement::kHeight + (*camera < 0 ? kCameraRows : 0), *camera < 0)) return false;
  const int i = store_.find_free();
  if (i < 0 || !extract_plane_patch(image, square.left, square.top, square.side, &store_[i].pixels)) return false;
  const int slot = *camera >= 0 ? *camera : filter_.add_reference_camera();
  if (slot < 0) return false;
  StoredPatch& patch = store_.begin(i);
  noise_.forget(i);
  *camera = patch.camera = slot;
  filter_.pin(slot);
  patch.plane = wall < 0 ? 0 : map_.planes[wall].id;
  patch.born = frame_.report.frames;
  patch.last_seen_ns = frame_.report.t_ns;
  if (rows_roll(filter_.state(), filter_.lens())) correct_rows(wall, &patch);
  return true;
}

void PatchInitialiser::correct_rows(int wall, StoredPatch* patch) const {
  const Camera& lens = filter_.lens();
  const CameraAt now = camera_at(filter_.state(), Scalar(0));
  for (int k = 0; k < 4; ++k) {
    const Vec2 pixel = patch->pixels.corner(k);
    const CameraAt then = camera_of_row(filter_.state(), lens, pixel.y());
    Vec3 ray_C, from_camera_W;
    if (!unproject(lens, pixel, &ray_C)) continue;
    from_camera_W = then.q_WC * ray_C;  // far away, where there is no wall
    if (wall >= 0) {
      const Block& plane = filter_.state().block[map_.planes[wall].slot];
      Vec3 hit_W;
      if (!intersect_ray_plane(filter_.state().frame_of(plane), plane.xyz(), then.p_W, from_camera_W, &hit_W)) continue;
      from_camera_W = hit_W - now.p_W;
    }
    project(lens, Vec3(now.q_WC.conjugate() * from_camera_W), &patch->reference_px[k]);
  }
}

bool PatchInitialiser::drop_oldest_camera() {
  int oldest = -1;
  std::int64_t oldest_ns = 0;
  for (const int i : used_entries(store_)) {
    std::int64_t last_ns = 0;
    bool in_view = false;
    for (const int k : used_entries(store_)) {
      if (store_[k].camera != store_[i].camera) continue;
      in_view = in_view || store_[k].was_found();
      last_ns = std::max(last_ns, store_[k].last_seen_ns);
    }
    if (in_view || (oldest >= 0 && last_ns >= oldest_ns)) continue;
    oldest = store_[i].camera;
    oldest_ns = last_ns;
  }
  if (oldest < 0) return false;
  for (const int i : used_entries(store_))
    if (store_[i].camera == oldest) drop_patch(filter_, store_, i);
  return true;
}

bool PatchInitialiser::make_room(int rows, bool for_camera) {
  const auto is_full = [&] { return store_.find_free() < 0 || (for_camera && !has_camera_left()); };
  while (is_full() || filter_.room() < rows) {
    if (drop_oldest_camera()) continue;
    if (is_full()) return false;
    return features_.make_rows(rows, frame_.report.t_ns);
  }
  return true;
}

}  // namespace pf
