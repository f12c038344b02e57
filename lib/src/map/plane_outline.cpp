#include "map/plane_outline.h"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr int kRoom = 64;  // vertices so far and points of one round

bool comes_first(const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); }

void sort_points(Vec2* points, int count) {
  for (int i = 1; i < count; ++i) {
    const Vec2 p = points[i];
    int k = i;
    for (; k > 0 && comes_first(p, points[k - 1]); --k) points[k] = points[k - 1];
    points[k] = p;
  }
}

/// Monotone chain: the lower side from left to right, then the upper one back. points are sorted; returns the vertices' number.
int hull_of(const Vec2* points, int count, Vec2* hull) {
  int size = 0;
  for (int side = 0; side < 2; ++side) {
    const int base = size;  // the last vertex of the lower side begins the upper one and is not written twice
    for (int i = 0; i < count; ++i) {
      const Vec2& p = points[side == 0 ? i : count - 1 - i];
      if (side == 1 && i == 0) continue;
      while (size - base >= (side == 0 ? 2 : 1) && !(twice_area(hull[size - 2], hull[size - 1], p) > 0)) {
        --size;
      }
      hull[size++] = p;
    }
  }
  return size > 1 ? size - 1 : size;  // the upper side ends where the lower one began
}

/// The vertex whose triangle with its neighbours is the smallest.
int cheapest_vertex(const Vec2* hull, int size) {
  int cheapest = 0;
  Scalar least = 0;
  for (int i = 0; i < size; ++i) {
    const Scalar loss = twice_area(hull[(i + size - 1) % size], hull[i], hull[(i + 1) % size]);
    if (i == 0 || loss < least) {
      least = loss;
      cheapest = i;
    }
  }
  return cheapest;
}

}  // namespace

void extend_outline(PlaneOutline* outline, const Vec2* uv, int count) {
  Vec2 points[kRoom], hull[kRoom + 1];
  int next = 0;
  while (next < count) {
    int held = outline->count;
    for (int i = 0; i < held; ++i) points[i] = outline->uv[i];
    for (; next < count && held < kRoom; ++next) {
      if (std::isfinite(uv[next].x()) && std::isfinite(uv[next].y())) points[held++] = uv[next];
    }
    sort_points(points, held);
    int size = hull_of(points, held, hull);
    while (size > kMaxOutline) {
      const int gone = cheapest_vertex(hull, size);
      for (int i = gone; i + 1 < size; ++i) hull[i] = hull[i + 1];
      --size;
    }
    outline->count = size;
    for (int i = 0; i < size; ++i) outline->uv[i] = hull[i];
  }
}

int reject_isolated(Vec2* uv, int count) {
  if (count < 6 || count > kOutlineBatch) return count;
  Scalar second[kOutlineBatch], sorted[kOutlineBatch];
  for (int i = 0; i < count; ++i) {
    Scalar nearest = -1, next = -1;
    for (int k = 0; k < count; ++k) {
      if (k == i) continue;
      const Scalar d = (uv[k] - uv[i]).squaredNorm();
      if (nearest < 0 || d < nearest) {
        next = nearest;
        nearest = d;
      } else if (next < 0 || d < next) {
        next = d;
      }
    }
    second[i] = next;
    int k = i;
    for (; k > 0 && next < sorted[k - 1]; --k) sorted[k] = sorted[k - 1];
    sorted[k] = next;
  }
  const Scalar limit = 25 * sorted[count / 2];
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    if (second[i] <= limit) uv[kept++] = uv[i];
  }
  return kept;
}

Scalar twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

Scalar outline_area(const PlaneOutline& outline) {
  Scalar twice = 0;
  for (int i = 2; i < outline.count; ++i) twice += twice_area(outline.uv[0], outline.uv[i - 1], outline.uv[i]);
  return twice / 2;
}

bool outline_contains(const PlaneOutline& outline, const Vec2& uv, Scalar margin) {
  if (outline.count < 3) return false;
  for (int i = 0; i < outline.count; ++i) {
    const Vec2 &a = outline.uv[i], &b = outline.uv[(i + 1) % outline.count];
    if (!(twice_area(a, b, uv) >= -margin * (b - a).norm())) return false;
  }
  return true;
}

}  // namespace pf
