#include "plane_view.h"

#include <algorithm>
#include <cmath>

namespace pf::capture {

namespace {

Vec3 mix(const Vec3& a, const Vec3& b, double share) {
  return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
}

Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// The part of a convex polygon where side · p >= 0.
std::vector<Vec3> cut(const std::vector<Vec3>& polygon, const Vec3& side, double offset) {
  std::vector<Vec3> kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double da = dot(side, a) - offset;
    const double db = dot(side, b) - offset;
    if (da >= 0.0) {
      kept.push_back(a);
    }
    if ((da < 0.0) != (db < 0.0)) {
      kept.push_back(mix(a, b, da / (da - db)));
    }
  }
  return kept;
}

constexpr double kShortestEdge = 1e-3;  ///< of an outline: a millimetre, where the scale is known

/// Leaves out corners that are closer to their neighbour than kShortestEdge: viewers take such edges for damage. An outline that is
/// itself so small stays as it is.
std::vector<Vec3> without_short_edges(const std::vector<Vec3>& outline) {
  std::vector<Vec3> kept;
  const auto is_short = [](const Vec3& a, const Vec3& b) {
    const Vec3 d = minus(a, b);
    return dot(d, d) < kShortestEdge * kShortestEdge;
  };
  for (const Vec3& corner : outline) {
    if (kept.empty() || !is_short(corner, kept.back())) {
      kept.push_back(corner);
    }
  }
  while (kept.size() > 1 && is_short(kept.front(), kept.back())) {
    kept.pop_back();
  }
  return kept.size() >= 3 ? kept : outline;
}

PlaneView view_of(const pf_plane_t& plane) {
  constexpr const char* kOrientations[] = {"unknown", "horizontal_up", "horizontal_down", "vertical", "other"};
  PlaneView view;
  view.id = plane.id;
  view.distance = plane.distance;
  view.points = plane.points;
  view.fixed_points = plane.fixed_points;
  view.trial = plane.trial;
  view.is_wall = plane.is_wall != 0;
  view.rejected = plane.rejected != 0;
  view.orientation = kOrientations[plane.orientation <= 4 ? plane.orientation : 0];
  for (size_t i = 0; i < 3; ++i) {
    view.normal[i] = plane.normal_W[i];
    view.origin[i] = plane.p_WP[i];
    view.u[i] = plane.R_WP[3 * i];
    view.v[i] = plane.R_WP[3 * i + 1];
  }
  double middle[2] = {0.0, 0.0};
  const int count = std::clamp(plane.outline_count, 0, PF_OUTLINE_MAX);
  for (int k = 0; k < count; ++k) {
    const double* at = plane.outline_P[k];
    Vec3 p;
    for (size_t i = 0; i < 3; ++i) {
      p[i] = view.origin[i] + at[0] * view.u[i] + at[1] * view.v[i];
    }
    view.outline.push_back(p);
    middle[0] += at[0] / count;
    middle[1] += at[1] / count;
  }
  view.outline = without_short_edges(view.outline);
  // How far the plane is off along its normal at the middle: delta - alpha x - beta y.
  const double* c = plane.covariance;
  const double J[3] = {-middle[0], -middle[1], 1.0};
  double variance = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      variance += J[i] * c[3 * i + k] * J[k];
    }
  }
  view.sigma = std::sqrt(std::max(0.0, variance));
  view.sigma_normal = ellipse_of(c[0], c[1], c[4]).a;
  return view;
}

}  // namespace

std::vector<PlaneView> read_planes(const pf_slam_t* slam) {
  std::vector<PlaneView> views;
  size_t count = 0;
  pf_get_planes(slam, nullptr, 0, &count);
  std::vector<pf_plane_t> planes(count);
  if (count > 0 && pf_get_planes(slam, planes.data(), planes.size(), &count) >= 0) {
    for (const pf_plane_t& plane : planes) {
      views.push_back(view_of(plane));
    }
  }
  return views;
}

double PlaneView::area() const {
  double twice = 0.0;
  for (size_t i = 2; i < outline.size(); ++i) {
    twice += dot(normal, cross(minus(outline[i - 1], outline[0]), minus(outline[i], outline[0])));
  }
  return 0.5 * std::fabs(twice);
}

Vec3 PlaneView::middle() const {
  if (outline.empty()) {
    return origin;
  }
  Vec3 sum{};
  for (const Vec3& p : outline) {
    sum = {sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]};
  }
  const double n = static_cast<double>(outline.size());
  return {sum[0] / n, sum[1] / n, sum[2] / n};
}

std::vector<Vec3> visible_part(const std::vector<Vec3>& outline, const double q_WC[4], const double p_WC[3],
                               const double reach[2]) {
  const Vec3 centre = {p_WC[0], p_WC[1], p_WC[2]};
  const Vec3 axes[3] = {rotation_column(q_WC, 0), rotation_column(q_WC, 1), rotation_column(q_WC, 2)};
  std::vector<Vec3> polygon;
  for (const Vec3& p : outline) {
    const Vec3 r = minus(p, centre);
    polygon.push_back({dot(axes[0], r), dot(axes[1], r), dot(axes[2], r)});
  }
  double size = 0.0;
  for (const Vec3& p : polygon) {
    size = std::max(size, std::sqrt(dot(p, p)));
  }
  polygon = cut(polygon, {0.0, 0.0, 1.0}, 1e-4 * size);
  for (double sign : {-1.0, 1.0}) {
    polygon = cut(polygon, {sign, 0.0, reach[0]}, 0.0);
    polygon = cut(polygon, {0.0, sign, reach[1]}, 0.0);
  }
  return polygon;
}

bool clip_to_outline(const std::vector<Vec3>& outline, const Vec3& normal, Vec3& a, Vec3& b) {
  if (outline.size() < 3) {
    return false;
  }
  double low = 0.0;
  double high = 1.0;
  Vec3 middle{};
  for (const Vec3& p : outline) {
    middle = {middle[0] + p[0], middle[1] + p[1], middle[2] + p[2]};
  }
  const double n = static_cast<double>(outline.size());
  middle = {middle[0] / n, middle[1] / n, middle[2] / n};
  for (size_t i = 0; i < outline.size(); ++i) {
    const Vec3& corner = outline[i];
    Vec3 side = cross(normal, minus(outline[(i + 1) % outline.size()], corner));
    if (dot(side, minus(middle, corner)) < 0.0) {
      side = {-side[0], -side[1], -side[2]};
    }
    const double da = dot(side, minus(a, corner));
    const double db = dot(side, minus(b, corner));
    if (da < 0.0 && db < 0.0) {
      return false;
    }
    if (da < 0.0) {
      low = std::max(low, da / (da - db));
    } else if (db < 0.0) {
      high = std::min(high, da / (da - db));
    }
  }
  if (low >= high) {
    return false;
  }
  const Vec3 from = a;
  const Vec3 to = b;
  a = mix(from, to, low);
  b = mix(from, to, high);
  return true;
}

std::vector<Vec3> grid_lines(const PlaneView& plane, double step) {
  std::vector<Vec3> lines;
  const Vec3* axes[2] = {&plane.u, &plane.v};
  for (int along = 0; along < 2; ++along) {
    const Vec3& run = *axes[along];
    const Vec3& across = *axes[1 - along];
    double low[2] = {1e300, 1e300};
    double high[2] = {-1e300, -1e300};
    for (const Vec3& p : plane.outline) {
      const Vec3 r = minus(p, plane.origin);
      const double at[2] = {dot(run, r), dot(across, r)};
      for (int k = 0; k < 2; ++k) {
        low[k] = std::min(low[k], at[k]);
        high[k] = std::max(high[k], at[k]);
      }
    }
    if (!(high[1] - low[1] < 200.0 * step)) {
      continue;
    }
    const Vec3 foot = plane.outline.empty() ? plane.origin : plane.outline[0];
    const double lift = dot(plane.normal, minus(foot, plane.origin));
    for (double c = step * std::ceil(low[1] / step); c < high[1]; c += step) {
      Vec3 ends[2];
      for (int k = 0; k < 2; ++k) {
        const double s = k == 0 ? low[0] : high[0];
        for (size_t i = 0; i < 3; ++i) {
          ends[k][i] = plane.origin[i] + s * run[i] + c * across[i] + lift * plane.normal[i];
        }
      }
      if (clip_to_outline(plane.outline, plane.normal, ends[0], ends[1])) {
        lines.push_back(ends[0]);
        lines.push_back(ends[1]);
      }
    }
  }
  return lines;
}

}  // namespace pf::capture
