#include "track/tracker.h"

#include <algorithm>
#include <cmath>

#include "geometry/so3.h"
#include "track/tuning.h"
#include "vision/align.h"
#include "vision/blur.h"
#include "vision/search.h"

namespace pf {
namespace {

using namespace tuning::match;

Scalar largest_eigenvalue(const Mat2& S) {
  const Scalar mean = (S(0, 0) + S(1, 1)) / Scalar(2);
  const Scalar half = (S(0, 0) - S(1, 1)) / Scalar(2);
  return mean + std::sqrt(half * half + S(0, 1) * S(0, 1));
}

Mat2 inverse2(const Mat2& S) {
  Mat2 inverse;
  inverse << S(1, 1), -S(0, 1), -S(1, 0), S(0, 0);
  return inverse / (S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0));
}

}  // namespace

bool Tracker::layout(Arena& arena, int width, int height) {
  pyramid_.layout(arena, width, height, kLevels);
  corner_workspace_.layout(arena, width);
  return arena.ok();
}

bool Tracker::begin_frame(const ImageView& image) {
  pyramid_.build(image);
  const int level = pyramid_.levels > 2 ? 2 : pyramid_.levels - 1;
  const ImageMask* mask = in_use(pyramid_.mask);
  const ImageView& small = pyramid_.level[level];
  return judge_frame(mask == nullptr ? frame_statistics(small) : frame_statistics(small, level, *mask)) ==
         FrameUse::kUsable;
}

bool Tracker::remember(const Vec2& pixel, Appearance* appearance) const {
  return extract_source(pyramid_, pixel, &appearance->patch);
}

/// Source pixels per current pixel at the feature, on its surface; if that is not known, on a plane that faced the first camera:
/// current pixel -> ray -> plane -> source pixel, by central differences.
bool Tracker::warp(const SearchTask& task, Mat2* A) const {
  const CameraView& source = task.first_view;
  constexpr Scalar kStep = 4;
  const Vec3 normal = task.normal_W.isZero(0) ? Vec3(task.p_W - source.c_W) : task.normal_W;
  const Mat3 R_WC = task.q_WC.toRotationMatrix();
  const Mat3 R_SW = source.q_WC.toRotationMatrix().transpose();
  const Scalar height = normal.dot(task.p_W - task.c_W);
  Vec2 at[2][2];
  for (int axis = 0; axis < 2; ++axis)
    for (int side = 0; side < 2; ++side) {
      Vec2 pixel = task.predicted;
      pixel[axis] += side == 0 ? -kStep : kStep;
      Vec3 ray_C;
      if (!unproject(camera_, pixel, &ray_C)) return false;
      const Vec3 ray_W = R_WC.lazyProduct(ray_C);
      const Scalar slope = normal.dot(ray_W);
      if (!(slope * height > Scalar(0))) return false;
      const Vec3 X_W = task.c_W + ray_W * (height / slope);
      if (!project(camera_, R_SW.lazyProduct(X_W - source.c_W), &at[axis][side])) return false;
    }
  for (int axis = 0; axis < 2; ++axis) A->col(axis) = (at[axis][1] - at[axis][0]) / (Scalar(2) * kStep);
  return true;
}

/// The warp, and the finest level at which the source is at least about as sharp as the current image. False: the views are too different.
bool Tracker::choose_level(const SearchTask& task, Mat2* A, int* finest) const {
  if (task.appearance == nullptr || !warp(task, A)) return false;
  const Scalar scale = std::sqrt(std::max(A->determinant(), Scalar(0)));  // negative: the surface is seen from behind
  if (!(scale > kMinScale && scale < kMaxScale)) return false;
  *finest = 0;
  while (*finest + 1 < pyramid_.levels && scale * static_cast<Scalar>(1 << *finest) < kMinSharpness) ++*finest;
  return true;
}

bool Tracker::is_in_scene(const Vec2& pixel, Scalar level_scale) const {
  const ImageMask* mask = in_use(pyramid_.mask);
  return mask == nullptr || mask->is_clear(pixel, kMaskMargin * static_cast<int>(level_scale));
}

bool Tracker::is_comparable(const SearchTask& task) const {
  Mat2 A;
  int finest;
  return is_in_scene(task.predicted) && choose_level(task, &A, &finest) &&
         has_template(task.appearance->patch, A * static_cast<Scalar>(1 << finest), kWarpSize);
}

SearchOutcome Tracker::search(const SearchTask& task) const {
  SearchOutcome outcome;
  Mat2 A;
  int finest;
  if (!choose_level(task, &A, &finest)) return outcome;
  const SourcePatch& patch = task.appearance->patch;

  int level = finest;
  const Scalar radius = std::sqrt(task.gate * largest_eigenvalue(task.innovation));
  while (level + 1 < pyramid_.levels && radius > kSearchRadius * static_cast<Scalar>(1 << level)) ++level;

  float warped[kWarpSize * kWarpSize];
  const auto warp_at = [&](int l) { return warp_template(patch, A * static_cast<Scalar>(1 << l), kWarpSize, warped); };
  // Where the source patch is too small for that level, the coarsest that it has a template for, as far as that reaches.
  outcome.comparable = warp_at(level);
  while (!outcome.comparable && level > finest) outcome.comparable = warp_at(--level);
  if (!outcome.comparable) return outcome;
  SearchTemplate pattern;
  make_search_template(warped, kWarpSize, &pattern);
  SearchEllipse ellipse;
  ellipse.centre = to_level(task.predicted, level);
  const Scalar factor = static_cast<Scalar>(1 << level);
  Mat2 S = task.innovation / (factor * factor);
  S(0, 0) += kSearchFloor;
  S(1, 1) += kSearchFloor;
  ellipse.inverse_covariance = inverse2(S);
  ellipse.gate = task.gate;
  const SearchResult found = pf::search(pyramid_.level[level], pattern, ellipse);
  if (found.score < kMinSearchScore || found.second > found.score - kMinPeakLead) return outcome;

  // Down to the finest level that still shows the template: a smeared image shows it at coarse levels only.
  Vec2 position = found.position;
  for (;; --level) {
    AlignTemplate fine;
    if (!make_align_template(warped, &fine)) break;
    const AlignResult aligned = align(pyramid_.level[level], fine, position);
    if (aligned.converged) position = aligned.position;
    if (aligned.converged && aligned.zncc >= kMinScore) {
      outcome.found = true;
      outcome.pixel = from_level(position, level);
      outcome.level_scale = static_cast<Scalar>(1 << level);
      outcome.noise = aligned.covariance() * (outcome.level_scale * outcome.level_scale);
      outcome.score = aligned.zncc;
    }
    if (level == finest || !warp_at(level - 1)) break;
    position = Vec2((position.x() + Scalar(0.25)) * Scalar(2), (position.y() + Scalar(0.25)) * Scalar(2));
  }
  return outcome;
}

int Tracker::corners(const Rect& cell, int threshold, Corner* out, int capacity) const {
  return detect_corners(pyramid_.level[0], cell, threshold, out, capacity, corner_workspace_, pyramid_.mask);
}

}  // namespace pf
