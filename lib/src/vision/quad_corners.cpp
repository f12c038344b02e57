#include "vision/quad_corners.h"

#include <cmath>

#include "vision/tuning.h"

namespace pf {
namespace {

using namespace tuning::quad;

Vec2 at(const Contour& contour, int i) {
  return Vec2(static_cast<Scalar>(contour.points[i].x), static_cast<Scalar>(contour.points[i].y));
}

Scalar cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Index of the point for which measure is largest.
template <typename Measure>
int farthest(const Contour& contour, Measure measure) {
  int best = 0;
  Scalar most = measure(at(contour, 0));
  for (int i = 1; i < contour.count; ++i) {
    const Scalar value = measure(at(contour, i));
    if (value > most) {
      most = value;
      best = i;
    }
  }
  return best;
}

/// Four indices: farthest from the middle, from that, from the line of both, and from the triangle of the three. Each is
/// a corner, whatever the shape of the quadrilateral, because the largest distance from a convex set is at a corner.
void extreme_points(const Contour& contour, int index[4]) {
  Vec2 middle = Vec2::Zero();
  for (int i = 0; i < contour.count; ++i) middle += at(contour, i) / static_cast<Scalar>(contour.count);
  index[0] = farthest(contour, [&](const Vec2& p) { return (p - middle).squaredNorm(); });
  const Vec2 a = at(contour, index[0]);
  index[1] = farthest(contour, [&](const Vec2& p) { return (p - a).squaredNorm(); });
  const Vec2 b = at(contour, index[1]);
  index[2] = farthest(contour, [&](const Vec2& p) { return std::abs(cross(b - a, p - a)); });
  const Vec2 c = at(contour, index[2]);
  const Scalar turn = cross(b - a, c - a) > 0 ? Scalar(1) : Scalar(-1);
  const Scalar ab = (b - a).norm() + 1, bc = (c - b).norm() + 1, ca = (a - c).norm() + 1;
  index[3] = farthest(contour, [&](const Vec2& p) {
    const Scalar d0 = -turn * cross(b - a, p - a) / ab, d1 = -turn * cross(c - b, p - b) / bc,
                 d2 = -turn * cross(a - c, p - c) / ca;
    const Scalar d = d0 > d1 ? d0 : d1;
    return d > d2 ? d : d2;
  });
}

void sort4(int index[4]) {
  for (int i = 1; i < 4; ++i) {
    for (int k = i; k > 0 && index[k] < index[k - 1]; --k) {
      const int keep = index[k];
      index[k] = index[k - 1];
      index[k - 1] = keep;
    }
  }
}

/// Every outline point between two corners is near their line.
bool is_straight(const Contour& contour, int from, int to) {
  const Vec2 a = at(contour, from), side = at(contour, to) - a;
  const Scalar length = side.norm();
  const Scalar bulge = kMaxBulge * length, limit = bulge > 2 ? bulge : Scalar(2);
  for (int i = from; i != to; i = i + 1 == contour.count ? 0 : i + 1) {
    if (std::abs(cross(side, at(contour, i) - a)) > limit * length) return false;
  }
  return true;
}

}  // namespace

bool quad_corners(const Contour& contour, Vec2 corners[4]) {
  if (contour.count < 4) return false;
  int index[4];
  extreme_points(contour, index);
  sort4(index);
  for (int i = 0; i < 4; ++i) corners[i] = at(contour, index[i]);
  Scalar twice_area = 0;
  for (int i = 0; i < 4; ++i) {
    const Vec2 next = corners[(i + 1) & 3] - corners[i], last = corners[i] - corners[(i + 3) & 3];
    const Scalar length = next.norm();
    if (!(length >= kMinSide) || !(cross(last, next) > kMinSine * length * last.norm())) return false;
    twice_area += cross(corners[i], corners[(i + 1) & 3]);
  }
  const Scalar area = twice_area / 2, gap = std::abs(area - static_cast<Scalar>(contour.area));
  if (!(gap < kMaxAreaGap * area)) return false;
  for (int i = 0; i < 4; ++i) {
    if (!is_straight(contour, index[i], index[(i + 1) & 3])) return false;
  }
  for (int i = 0; i < 4; ++i) corners[i] -= Vec2(Scalar(0.5), Scalar(0.5));
  return true;
}

void order_upright(Vec2 corners[4]) {
  int best = 0;
  Scalar most = 0;
  for (int i = 0; i < 4; ++i) {
    const Vec2 top = (corners[(i + 1) & 3] - corners[i]).normalized();
    const Vec2 bottom = (corners[(i + 2) & 3] - corners[(i + 3) & 3]).normalized();
    const Scalar value = top.x() + bottom.x();
    if (i == 0 || value > most) {
      most = value;
      best = i;
    }
  }
  const Vec2 copy[4] = {corners[0], corners[1], corners[2], corners[3]};
  for (int i = 0; i < 4; ++i) corners[i] = copy[(best + i) & 3];
}

}  // namespace pf
