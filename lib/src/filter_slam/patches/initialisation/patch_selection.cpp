#include "filter_slam/patches/initialisation/patch_selection.h"

#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "filter_slam/features/wall_rays.h"
#include "filter_slam/patches/patch_sight.h"
#include "filter_slam/patches/patch_walls.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/so3.h"
#include "model/camera_at.h"

namespace pf {
namespace {

using namespace tuning::patch_selection;

constexpr int kPlaneRows = 3;

/// The weaker eigenvalue of the sum of g g^T over a square of a level, which bounds how well it can be aligned in the worse direction.
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

void PatchSelection::init() {
  std::fill(in_vain_, in_vain_ + kMaxPlanes, 0);
  in_vain_beside_ = 0;
}

int PatchSelection::wanted_on(int wall) const {
  int good = 0, born = 0;
  for (const int i : used_entries(store_)) {
    if (wall_of(map_.planes, store_[i]) != wall) continue;
    born = std::max(born, store_[i].born);
    PatchSight sight;
    good += store_[i].was_found() && expect_patch(filter_, map_.planes, store_[i], wall, &sight) &&
            sight.cosine > kLastingCosine && is_whole_in_view(filter_.lens(), sight) &&
            stay_in_view(sight.middle_W) == Scalar(1);
  }
  const int since = frame_.report.frames - born;
  if (good == 0) return born == 0 || since >= kRetryFrames ? kOnWall : 0;
  return good < kOnWall && since >= kBetween ? 1 : 0;
}

bool PatchSelection::is_on_wall(int wall, const PatchSquare& square, Scalar* cosine, Vec3* middle_W) const {
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  const Vec2 middle = square.middle();
  Vec3 n_W;
  Scalar d_W;
  if (wall >= 0) {
    const Block& plane = filter_.state().block[map_.planes[wall].slot];
    plane_normal(filter_.state().frame_of(plane), plane.xyz(), &n_W, &d_W);
  }
  const Scalar reach = square.reach();
  constexpr int kPlaces = 5;
  const Scalar at[kPlaces][2] = {{0, 0}, {-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int k = 0; k < kPlaces; ++k) {
    Vec3 ray_C;
    if (!unproject(filter_.lens(), Vec2(middle + Vec2(reach * at[k][0], reach * at[k][1])), &ray_C)) return false;
    const Vec3 ray_W = camera.q_WC * ray_C;
    Scalar range = 0;
    if (first_wall(filter_, map_, camera.p_W, ray_W, &range) != wall) return false;
    if (k > 0) continue;
    *middle_W = camera.p_W + range * ray_W;
    *cosine = Scalar(1);  // how slanted it is where there is no wall, nobody knows
    if (wall < 0) continue;
    *cosine = std::abs(n_W.dot(ray_W)) / ray_W.norm();
    if (!(*cosine > kMinBirthCosine)) return false;
  }
  return true;
}

/// At the velocities that the camera has now.
Scalar PatchSelection::stay_in_view(const Vec3& middle_W) const {
  const Body& body = filter_.state().body;
  const Camera& lens = filter_.lens();
  int stays = 1;
  for (int k = 1; k <= kStaySteps; ++k) {
    const Scalar t = static_cast<Scalar>(k) * kStayStep;
    const Quat q_WC = body.q_WC * exp_so3(Vec3(body.w_C * t));
    Vec2 at;
    stays += project(lens, Vec3(q_WC.conjugate() * (middle_W - body.p_W - t * body.v_W)), &at) && is_in_image(lens, at);
  }
  return static_cast<Scalar>(stays) / static_cast<Scalar>(kStaySteps + 1);
}

bool PatchSelection::is_free(const PatchSquare& square) const {
  const Scalar apart = kApart * static_cast<Scalar>(square.side);
  const Vec2 middle = square.middle();
  for (const int i : used_entries(store_)) {
    if (store_[i].status == PatchStatus::kUnseen) continue;
    if (!((middle_of(store_[i].corner) - middle).norm() > apart)) return false;
  }
  return true;
}

int PatchSelection::list_squares(const Pyramid& image, int wall, int side, const PatchObstacles& obstacles,
                                 PatchSquare* square) const {
  const int level = std::min(side >= kCoarseSide ? 2 : 1, image.levels - 1), border = settings_.border_px;
  const int step = std::max(1, side / 4);
  const ImageMask* mask = in_use(image.mask);
  int count = 0;
  for (int top = border; top + side + border <= image.level[0].height; top += step)
    for (int left = border; left + side + border <= image.level[0].width; left += step) {
      if (mask != nullptr && !mask->is_clear(Rect{left, top, side, side})) continue;
      PatchSquare candidate{left, top, side, 0};
      Scalar cosine = 0;
      Vec3 middle_W;
      if (!is_free(candidate) || obstacles.are_in(candidate) || !is_on_wall(wall, candidate, &cosine, &middle_W))
        continue;
      candidate.score = cosine * texture(image.level[level], left >> level, top >> level, side >> level);
      if (wall >= 0) candidate.score *= stay_in_view(middle_W);
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

void PatchSelection::begin_patches(const Pyramid& image) {
  int camera = -1;
  for (const int wall : used_entries(map_.planes)) {
    if (!map_.planes[wall].known || !map_.planes[wall].counts()) continue;
    const int wanted = wanted_on(wall);
    // The lattice costs as much as a patch: where it had no place, or the store no room, not again in the next frame.
    if (wanted > 0 && in_vain_[wall] > 0 && frame_.report.frames < in_vain_[wall] + kRetryFrames) continue;
    in_vain_[wall] = wanted > 0 && !begin_on_wall(image, wall, wanted, &camera) ? frame_.report.frames : 0;
  }
  if (map_.planes.has_known() && !map_.planes.has_apart()) begin_beside_walls(image, &camera);
}

bool PatchSelection::begin_on_wall(const Pyramid& image, int wall, int wanted, int* camera) {
  const PatchObstacles obstacles = find_obstacles(filter_, map_, frame_, refusals_, wall);
  for (int part = kSizes; part > kSmallest && wanted > 0; --part) {
    const int side = settings_.patch_side_px * part / kSizes;
    if (side < kMinSide) break;
    PatchSquare square[kMaxSquares];
    // After each one the lattice is searched again: places beside it are taken then.
    for (bool more = true; more && wanted > 0;) {
      const int count = list_squares(image, wall, side, obstacles, square);
      more = false;
      for (int k = 0; k < count && !more; ++k) more = initialiser_.initialise(image.level[0], wall, square[k], camera);
      wanted -= more;
    }
  }
  return wanted == 0;
}

bool PatchSelection::may_begin_beside_walls(bool has_camera) const {
  if (in_vain_beside_ > 0 && frame_.report.frames < in_vain_beside_ + kBetween) return false;
  int beside = 0, youngest = 0;
  for (const int i : used_entries(store_)) {
    const int entry = wall_of(map_.planes, store_[i]);
    if (entry >= 0 && map_.planes[entry].known) continue;
    beside += store_[i].was_found();
    youngest = std::max(youngest, store_[i].born);
  }
  constexpr int kRows = PatchInitialiser::kCameraRows + PatchMeasurement::kHeight + kPlaneRows;
  const bool has_room =
      store_.find_free() >= 0 && filter_.room() >= kRows && (has_camera || initialiser_.has_camera_left());
  return has_room && beside < kOnWall && frame_.report.frames - youngest >= kBetween;
}

void PatchSelection::begin_beside_walls(const Pyramid& image, int* camera) {
  if (!may_begin_beside_walls(*camera >= 0)) return;
  in_vain_beside_ = frame_.report.frames;
  const PatchObstacles none;
  const int side = settings_.patch_side_px;
  for (int part = kSizes; part > kSmallest && side * part / kSizes >= kMinSide; --part) {
    PatchSquare square[kMaxSquares];
    const int count = list_squares(image, -1, side * part / kSizes, none, square);
    for (int k = 0; k < count; ++k)
      if (initialiser_.initialise(image.level[0], -1, square[k], camera)) return;
  }
}

}  // namespace pf
