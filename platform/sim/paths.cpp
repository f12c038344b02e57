#include "sim/paths.h"

#include <cmath>

namespace pf::sim {
namespace {

/// Way points, one a second, about a nominal walk; `spread` is how far a seed moves them.
std::vector<Waypoint> vary(std::vector<Waypoint> points, Random& random, double spread) {
  for (std::size_t k = 2; k + 2 < points.size(); ++k) {
    points[k].eye_W += random.normal3() * spread;
    points[k].at_W += random.normal3() * (2 * spread);
  }
  return points;
}

}  // namespace

Trajectory desk_path(Random& random) {
  const std::vector<Waypoint> points = {
      {{0.02, -0.02, -0.66}, {0, 0, 0}},          {{0.16, -0.08, -0.64}, {0, 0, 0}},
      {{0.26, -0.12, -0.60}, {0.02, 0, 0}},       {{0.20, -0.18, -0.56}, {0, 0.02, 0}},
      {{0.05, -0.15, -0.60}, {-0.1, 0, 0.1}},     {{-0.12, -0.12, -0.62}, {-0.3, 0, 0.2}},
      {{-0.28, -0.10, -0.60}, {-0.4, 0.05, 0.2}}, {{-0.40, -0.16, -0.56}, {-0.35, 0, 0.3}},
      {{-0.36, -0.26, -0.52}, {-0.1, 0, 0.3}},    {{-0.20, -0.32, -0.56}, {0.1, 0.02, 0.2}},
      {{0.02, -0.30, -0.62}, {0.3, 0, 0.2}},      {{0.22, -0.24, -0.62}, {0.5, -0.02, 0.3}},
      {{0.40, -0.18, -0.56}, {0.55, 0, 0.3}},     {{0.48, -0.16, -0.50}, {0.4, 0, 0.3}},
      {{0.42, -0.22, -0.58}, {0.2, 0, 0.2}},      {{0.28, -0.26, -0.68}, {0.05, -0.1, 0.3}},
      {{0.12, -0.20, -0.74}, {0, -0.15, 0.4}},    {{0.00, -0.12, -0.70}, {0, -0.05, 0.2}},
      {{-0.05, -0.06, -0.66}, {0, 0, 0}},         {{0.00, -0.03, -0.64}, {0, 0, 0}}};
  return spline(vary(points, random, 0.025), 1.0);
}

Trajectory room_path(Random& random) {
  std::vector<Waypoint> points = {{{0.05, 0.0, -0.72}, {0, 0, 0}},     {{0.22, -0.08, -0.74}, {0, 0, 0}},
                                  {{0.30, -0.12, -0.86}, {0, 0, 0}},   {{0.12, -0.10, -1.1}, {-0.1, 0, 0}},
                                  {{-0.1, -0.06, -1.4}, {-0.2, 0, 0}}, {{-0.1, 0.0, -1.7}, {-0.3, 0, 0}}};
  // Then once around the middle, looking outward, at an eighth of a turn in 1.6 way points.
  for (int k = 0; k <= 26; ++k) {
    const double a = -2 * 3.14159265358979 * k / 26;
    const Vec3 radial{std::sin(a), 0, std::cos(a)};
    const Vec3 centre{-0.05, 0.02 * (k % 3), -2.0};
    points.push_back({centre + radial * 0.35, centre + radial * 2.0});
  }
  return spline(vary(points, random, 0.03), 0.9);
}

Trajectory corridor_path(Random& random) {
  std::vector<Waypoint> points = {{{0.02, 0.0, -0.70}, {0, 0, 0}},     {{0.20, -0.05, -0.72}, {0, 0, 0}},
                                  {{0.32, -0.08, -0.85}, {0.1, 0, 0}}, {{0.38, -0.08, -0.95}, {0.6, 0, 0}},
                                  {{0.45, -0.06, -1.0}, {1.2, 0, 0}},  {{0.55, -0.05, -1.05}, {2.0, 0, -0.2}}};
  for (int k = 0; k < 14; ++k) {
    const double along = 0.8 + 0.7 * k;
    points.push_back({{along, 0.02 * (k % 3) - 0.04, -1.05 + 0.08 * std::sin(1.3 * k)},
                      {along + 2.5, 0.05 * std::sin(k), -1.05 + 0.9 * std::cos(0.9 * k)}});
  }
  return spline(vary(points, random, 0.03), 0.9);
}

Trajectory wall_path(Random& random) {
  const std::vector<Waypoint> points = {{{0.02, 0.0, -0.7}, {0, 0, 0}},       {{0.22, -0.05, -0.68}, {0, 0, 0}},
                                        {{0.32, -0.1, -0.7}, {0.05, 0, 0}},   {{0.15, -0.15, -0.85}, {-0.05, 0, 0}},
                                        {{-0.15, -0.1, -1.0}, {-0.3, 0, 0}},  {{-0.45, 0.05, -1.1}, {-0.6, 0.1, 0}},
                                        {{-0.6, 0.2, -1.0}, {-0.8, 0.2, 0}},  {{-0.4, 0.3, -1.1}, {-0.3, 0.3, 0}},
                                        {{0.0, 0.2, -1.2}, {0.2, 0.2, 0}},    {{0.45, 0.05, -1.1}, {0.6, 0.0, 0}},
                                        {{0.6, -0.15, -1.0}, {0.7, -0.3, 0}}, {{0.35, -0.3, -1.05}, {0.3, -0.4, 0}},
                                        {{0.1, -0.2, -0.9}, {0.1, -0.2, 0}},  {{0.0, -0.05, -0.75}, {0, 0, 0}}};
  return spline(vary(points, random, 0.03), 1.0);
}

Trajectory checker_path(Random& random) {
  const double height = random.uniform(-0.03, 0.03);
  return [height](double t) {
    constexpr double kSpeed = 0.24;  // [m/s]
    return Pose{look_along({0, 0, 1}, {0, 1, 0}), {-0.2 + kSpeed * t, height, -0.8}};
  };
}

Trajectory clutter_path(Random& random) {
  const std::vector<Waypoint> points = {{{0.02, -0.01, -0.72}, {0, 0, 0}},     {{0.14, -0.06, -0.70}, {0, 0, 0}},
                                        {{0.24, -0.10, -0.70}, {0.03, 0, 0}},  {{0.12, -0.16, -0.74}, {-0.05, 0, 0}},
                                        {{-0.10, -0.12, -0.78}, {-0.1, 0, 0}}, {{-0.26, 0.00, -0.74}, {-0.05, 0, 0}},
                                        {{-0.14, 0.12, -0.72}, {0, 0.05, 0}},  {{0.08, 0.10, -0.76}, {0.05, 0, 0}},
                                        {{0.22, 0.02, -0.74}, {0.03, 0, 0}},   {{0.05, -0.02, -0.72}, {0, 0, 0}}};
  return spline(vary(points, random, 0.03), 1.0);
}

Trajectory bushes_path(Random& random) {
  std::vector<Waypoint> points;
  for (int k = 0; k <= 22; ++k) {
    const double t = k;
    points.push_back({{0.26 * std::sin(0.7 * t), -0.12 * std::sin(0.45 * t), -0.72 + 0.05 * std::sin(0.9 * t)},
                      {0.10 * std::sin(0.5 * t), 0.06 * std::sin(0.35 * t), 0.1}});
  }
  return spline(vary(points, random, 0.02), 1.0);
}

}  // namespace pf::sim
