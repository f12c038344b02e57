#include "vision/quad.h"

#include <cmath>

#include "vision/quad_corners.h"
#include "vision/tuning.h"

namespace pf {
namespace {

using namespace tuning::quad;

constexpr int kLevels = 7;

/// Grey levels below which 0.1 % and 99.9 % of the pixels are, from every second row: the smallest quadrilateral is twice
/// that.
void grey_range(const ImageView& image, int* low, int* high) {
  int histogram[256] = {};
  int count = 0;
  for (int y = 0; y < image.height; y += 2) {
    const std::uint8_t* row = image.row(y);
    for (int x = 0; x < image.width; ++x) ++histogram[row[x]];
    count += image.width;
  }
  int below = 0;
  *low = 0;
  *high = 255;
  for (int i = 0; i < 256; ++i) {
    if (below <= count / 1000) *low = i;
    below += histogram[i];
    if (below < count - count / 1000) *high = i + 1;
  }
}

/// Mean grey level along a side, `offset` pixels outwards of it, between a fifth and four fifths of its length.
Scalar mean_along(const ImageView& image, const Vec2& a, const Vec2& b, Scalar offset) {
  constexpr int kSamples = 16;
  const Vec2 side = b - a;
  const Vec2 outwards = Vec2(side.y(), -side.x()).normalized() * offset;
  int sum = 0, count = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Scalar t = Scalar(0.2) + Scalar(0.6) * static_cast<Scalar>(i) / (kSamples - 1);
    const Vec2 p = a + t * side + outwards;
    const int x = static_cast<int>(std::lround(p.x())), y = static_cast<int>(std::lround(p.y()));
    if (!image.contains(x, y)) continue;
    sum += image.at(x, y);
    ++count;
  }
  return count > 0 ? static_cast<Scalar>(sum) / static_cast<Scalar>(count) : 0;
}

/// Contrast of the weakest side, and the grey level midway.
Scalar side_contrast(const ImageView& image, const Vec2 corners[4], Scalar* middle) {
  Scalar weakest = 256, sum = 0;
  for (int i = 0; i < 4; ++i) {
    const Scalar inside = mean_along(image, corners[i], corners[(i + 1) & 3], -3);
    const Scalar outside = mean_along(image, corners[i], corners[(i + 1) & 3], 3);
    if (outside - inside < weakest) weakest = outside - inside;
    sum += inside + outside;
  }
  *middle = sum / 8;
  return weakest;
}

Scalar corner_distance(const Quad& a, const Quad& b) {
  Scalar sum = 0;
  for (int i = 0; i < 4; ++i) sum += (a.corners[i] - b.corners[i]).norm();
  return sum / 4;
}

/// What is kept of one found quadrilateral. misfit: distance of its level from the middle one, kept in rms_px meanwhile.
void keep(const Quad& quad, Quad* out, int capacity, int* count) {
  int place = *count;
  for (int i = 0; i < *count; ++i) {
    if (corner_distance(out[i], quad) > kSameCorners) continue;
    if (quad.rms_px < out[i].rms_px) out[i] = quad;
    return;
  }
  if (place == capacity) {
    place = 0;
    for (int i = 1; i < capacity; ++i) {
      if (out[i].contrast < out[place].contrast) place = i;
    }
    if (!(out[place].contrast < quad.contrast)) return;
  } else {
    ++*count;
  }
  out[place] = quad;
}

bool is_candidate(const ImageView& image, const Contour& contour) {
  const Scalar pixels = static_cast<Scalar>(image.width) * static_cast<Scalar>(image.height);
  if (contour.count == 0 || static_cast<Scalar>(contour.area) < kMinArea * pixels) return false;
  if (contour.min_x < kBorder || contour.max_x > image.width - kBorder) return false;
  if (contour.min_y < kBorder || contour.max_y > image.height - kBorder) return false;
  const int box = 2 * (contour.max_x - contour.min_x + contour.max_y - contour.min_y);
  return contour.count * 2 <= box * 3;
}

}  // namespace

QuadWorkspace take_quad_workspace(Arena* arena, int width, int height) {
  QuadWorkspace workspace;
  workspace.buffers.marks = arena->take<std::uint8_t>(contour_mark_bytes(width, height));
  workspace.buffers.points = arena->take<ContourPoint>(contour_points(width, height));
  return workspace;
}

int find_dark_quads(const ImageView& image, const QuadWorkspace& workspace, Quad* out, int capacity) {
  int count = 0, low, high;
  if (capacity <= 0) return 0;
  grey_range(image, &low, &high);
  if (high - low < kMinRange) return 0;
  for (int k = 1; k <= kLevels; ++k) {
    const int level = low + (high - low) * k / (kLevels + 1);
    ContourWalk walk(image, level, workspace.buffers);
    Contour contour;
    while (walk.next(&contour)) {
      Quad quad;
      if (!is_candidate(image, contour) || !quad_corners(contour, quad.corners)) continue;
      Scalar middle;
      quad.contrast = side_contrast(image, quad.corners, &middle);
      if (quad.contrast < kMinContrast) continue;
      quad.area = static_cast<Scalar>(contour.area);
      quad.rms_px = std::abs(static_cast<Scalar>(level) - middle);
      order_upright(quad.corners);
      keep(quad, out, capacity, &count);
    }
  }
  for (int i = 0; i < count; ++i) {
    out[i].rms_px = 0;
    for (int k = i; k > 0 && out[k].contrast > out[k - 1].contrast; --k) {
      const Quad swap = out[k];
      out[k] = out[k - 1];
      out[k - 1] = swap;
    }
  }
  return count;
}

}  // namespace pf
