#include <algorithm>
#include <cmath>

#include "filter_slam/features/wall_rays.h"
#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/ray_plane.h"
#include "model/camera_at.h"

/// New patches: where on the walls in view, and when.

namespace pf {
namespace {

using namespace tuning::patch_selection;

constexpr int kCameraRows = 6, kPlaneRows = 3;

/// The weaker eigenvalue of the sum of g g^T over a square of a level, which says how well it can be aligned in the worse direction.
Scalar texture(const ImageView& image, int left, int top, int side) {
  int xx = 0, xy = 0, yy = 0;
  for (int y = top + 1; y < top + side - 1; ++y) {
    const std::uint8_t* row = image.row(y);
    for (int x = left + 1; x < left + side - 1; ++x) {
      const int gx = row[x + 1] - row[x - 1], gy = row[x + image.stride] - row[x - image.stride];
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
    }
  }
  const Scalar difference = static_cast<Scalar>(xx - yy), twice = static_cast<Scalar>(2) * static_cast<Scalar>(xy);
  return (static_cast<Scalar>(xx + yy) - std::sqrt(difference * difference + twice * twice)) / 2;
}

}  // namespace

/// How many patches should begin on a wall now. Those that will soon be too slanted do not count, so that the next ones have frames in
/// common with them.
int PatchKeeper::wanted_on(int wall, int* youngest) const {
  int good = 0, born = 0;
  for (int i = 0; i < store_.capacity(); ++i) {
    if (!store_.used(i) || wall_of(store_[i]) != wall) continue;
    born = std::max(born, store_[i].born);
    Sight sight;
    good += store_[i].was_found() && expect(store_[i], wall, &sight) && sight.cosine > kLastingCosine;
  }
  *youngest = born;
  const int since = frame_.report.frames - born;
  if (good == 0) return born == 0 || since >= kRetryFrames ? kOnWall : 0;
  return good < kOnWall && since >= kBetween ? 1 : 0;
}

/// Whether the wall (-1: no wall) is what is seen first in all of a square, and how slanted in its middle.
bool PatchKeeper::is_on_wall(int wall, const Square& square, Scalar* cosine) const {
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  const Scalar half = static_cast<Scalar>(square.side - 1) / 2;
  const Vec2 middle(static_cast<Scalar>(square.left) + half, static_cast<Scalar>(square.top) + half);
  Vec3 n_W;
  Scalar d_W;
  if (wall >= 0) {
    const Block& plane = filter_.state().block[map_.planes[wall].slot];
    plane_normal(filter_.state().frame_of(plane), plane.xyz(), &n_W, &d_W);
  }
  const Scalar reach = half * (Scalar(1) + kMargin);
  constexpr int kPlaces = 5;
  const Scalar at[kPlaces][2] = {{0, 0}, {-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int k = 0; k < kPlaces; ++k) {
    Vec3 ray_C;
    if (!unproject(filter_.lens(), Vec2(middle + Vec2(reach * at[k][0], reach * at[k][1])), &ray_C)) return false;
    const Vec3 ray_W = camera.q_WC * ray_C;
    Scalar range = 0;
    if (first_wall(filter_, map_, camera.p_W, ray_W, &range) != wall) return false;
    if (k > 0) continue;
    *cosine = Scalar(1);  // how slanted it is where there is no wall, nobody knows
    if (wall < 0) continue;
    *cosine = std::abs(n_W.dot(ray_W)) / ray_W.norm();
    if (!(*cosine > kMinBirthCosine)) return false;
  }
  return true;
}

/// Whether no patch that is in view has its middle near the square's.
bool PatchKeeper::is_free(const Square& square) const {
  const Scalar half = static_cast<Scalar>(square.side - 1) / 2, apart = kApart * static_cast<Scalar>(square.side);
  const Vec2 middle(static_cast<Scalar>(square.left) + half, static_cast<Scalar>(square.top) + half);
  for (int i = 0; i < store_.capacity(); ++i) {
    if (!store_.used(i) || store_[i].status == PatchStatus::kUnseen) continue;
    const Vec2* c = store_[i].corner;
    if (!(((c[0] + c[1] + c[2] + c[3]) / 4 - middle).norm() > apart)) return false;
  }
  return true;
}

/// The best squares of a lattice, the best first. Returns how many.
int PatchKeeper::list_squares(const Pyramid& image, int wall, int side, const Obstacles& obstacles,
                              Square* square) const {
  const int level = std::min(side >= kCoarseSide ? 2 : 1, image.levels - 1), border = settings_.border_px;
  const int step = std::max(1, side / 4);
  int count = 0;
  for (int top = border; top + side + border <= image.level[0].height; top += step)
    for (int left = border; left + side + border <= image.level[0].width; left += step) {
      Square candidate{left, top, side, 0};
      Scalar cosine = 0;
      if (!is_free(candidate) || obstacles.are_in(candidate) || !is_on_wall(wall, candidate, &cosine)) continue;
      candidate.score = cosine * texture(image.level[level], left >> level, top >> level, side >> level);
      int at = count;
      if (count == kMaxSquares) {
        if (!(square[count - 1].score < candidate.score)) continue;
        at = count - 1;
      } else {
        ++count;
      }
      for (; at > 0 && square[at - 1].score < candidate.score; --at) square[at] = square[at - 1];
      square[at] = candidate;
    }
  return count;
}

void PatchKeeper::begin_patches(const Pyramid& image) {
  int camera = -1;
  for (int wall = 0; wall < map_.planes.capacity(); ++wall) {
    if (!map_.planes.used(wall) || !map_.planes[wall].known || !map_.planes[wall].counts()) continue;
    int youngest = 0;
    int wanted = wanted_on(wall, &youngest);
    // The lattice costs as much as a patch: where it had no place, or the store no room, not again in the next frame.
    if (wanted > 0 && in_vain_[wall] > 0 && frame_.report.frames < in_vain_[wall] + kRetryFrames) continue;
    Obstacles obstacles;
    if (wanted > 0) list_obstacles(wall, &obstacles);
    for (int part = kSizes; part > kSmallest && wanted > 0; --part) {
      const int side = settings_.patch_side_px * part / kSizes;
      if (side < kMinSide) break;
      Square square[kMaxSquares];
      // After each one the lattice is searched again: places beside it are taken then.
      for (bool more = true; more && wanted > 0;) {
        const int count = list_squares(image, wall, side, obstacles, square);
        more = false;
        for (int k = 0; k < count && !more; ++k) more = begin_at(image.level[0], wall, square[k], &camera);
        wanted -= more;
      }
    }
    in_vain_[wall] = wanted > 0 ? frame_.report.frames : 0;
  }
  if (map_.planes.has_known() && !map_.planes.has_apart()) begin_beside_walls(image, &camera);
}

/// One patch where the plan has no wall, which waits for the plane that it lies on. It takes nobody else's room.
void PatchKeeper::begin_beside_walls(const Pyramid& image, int* camera) {
  if (in_vain_beside_ > 0 && frame_.report.frames < in_vain_beside_ + kBetween) return;
  int beside = 0, youngest = 0;
  for (int i = 0; i < store_.capacity(); ++i) {
    if (!store_.used(i)) continue;
    const int entry = wall_of(store_[i]);
    if (entry >= 0 && map_.planes[entry].known) continue;
    beside += store_[i].was_found();
    youngest = std::max(youngest, store_[i].born);
  }
  const bool has_room = store_.find_free() >= 0 && filter_.room() >= kCameraRows + z_.kHeight + kPlaneRows &&
                        (*camera >= 0 || store_.cameras() < settings_.max_cameras);
  if (!has_room || beside >= kOnWall || frame_.report.frames - youngest < kBetween) return;
  in_vain_beside_ = frame_.report.frames;
  Obstacles none;
  const int side = settings_.patch_side_px;
  for (int part = kSizes; part > kSmallest && side * part / kSizes >= kMinSide; --part) {
    Square square[kMaxSquares];
    const int count = list_squares(image, -1, side * part / kSizes, none, square);
    for (int k = 0; k < count; ++k)
      if (begin_at(image.level[0], -1, square[k], camera)) return;
  }
}

bool PatchKeeper::begin_at(const ImageView& image, int wall, const Square& square, int* camera) {
  if (!make_room(z_.kHeight + (*camera < 0 ? kCameraRows : 0), *camera < 0)) return false;
  const int i = store_.find_free();
  if (i < 0 || !extract_plane_patch(image, square.left, square.top, square.side, &store_[i].pixels)) return false;
  const int slot = *camera >= 0 ? *camera : filter_.add_reference_camera();
  if (slot < 0) return false;
  StoredPatch& patch = store_.begin(i);
  for (ResidualTrace& trace : residuals_[i]) trace = ResidualTrace();
  *camera = patch.camera = slot;
  filter_.pin(slot);
  patch.plane = wall < 0 ? 0 : map_.planes[wall].id;
  patch.born = frame_.report.frames;
  patch.last_seen_ns = frame_.report.t_ns;
  const Camera& lens = filter_.lens();
  if (lens.readout == Scalar(0) || !filter_.state().layout.has(BodyPart::kVelocity)) return true;
  // Rays of rows that were read out earlier or later go to where the camera at the frame's own time sees the same places.
  const CameraAt now = camera_at(filter_.state(), Scalar(0));
  for (int k = 0; k < 4; ++k) {
    const Vec2 pixel = patch.pixels.corner(k);
    const CameraAt then = camera_at(filter_.state(), row_time(lens, pixel.y()));
    Vec3 ray_C, from_camera_W;
    if (!unproject(lens, pixel, &ray_C)) continue;
    from_camera_W = then.q_WC * ray_C;  // far away, where there is no wall
    if (wall >= 0) {
      const Block& plane = filter_.state().block[map_.planes[wall].slot];
      Vec3 hit_W;
      if (!intersect_ray_plane(filter_.state().frame_of(plane), plane.xyz(), then.p_W, from_camera_W, &hit_W)) continue;
      from_camera_W = hit_W - now.p_W;
    }
    project(lens, Vec3(now.q_WC.conjugate() * from_camera_W), &patch.reference_px[k]);
  }
  return true;
}

/// Drops all patches of the camera whose patches are out of view for longest. False where each camera has one in view.
bool PatchKeeper::drop_oldest_camera() {
  int oldest = -1;
  std::int64_t oldest_ns = 0;
  for (int i = 0; i < store_.capacity(); ++i) {
    if (!store_.used(i)) continue;
    std::int64_t last_ns = 0;
    bool in_view = false;
    for (int k = 0; k < store_.capacity(); ++k) {
      if (!store_.used(k) || store_[k].camera != store_[i].camera) continue;
      in_view = in_view || store_[k].was_found();
      last_ns = std::max(last_ns, store_[k].last_seen_ns);
    }
    if (in_view || (oldest >= 0 && last_ns >= oldest_ns)) continue;
    oldest = store_[i].camera;
    oldest_ns = last_ns;
  }
  if (oldest < 0) return false;
  for (int i = 0; i < store_.capacity(); ++i)
    if (store_.used(i) && store_[i].camera == oldest) drop(i);
  return true;
}

/// Room for a patch, and a camera: in the store, among the cameras and in the state.
bool PatchKeeper::make_room(int rows, bool for_camera) {
  while (store_.find_free() < 0 || (for_camera && store_.cameras() >= settings_.max_cameras) || filter_.room() < rows) {
    if (drop_oldest_camera()) continue;
    if (store_.find_free() < 0 || (for_camera && store_.cameras() >= settings_.max_cameras)) return false;
    return features_.make_rows(rows, frame_.report.t_ns);
  }
  return true;
}

}  // namespace pf
