#include "sim/trajectory.h"

#include <algorithm>

namespace pf::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;
const Vec3 kDown{0, 1, 0};

}  // namespace

void velocities(const Trajectory& trajectory, double t, Vec3& v_W, Vec3& w_C) {
  const double h = 1e-4;
  const Pose a = trajectory(t - h), b = trajectory(t + h);
  v_W = (b.p_WC - a.p_WC) * (0.5 / h);
  w_C = rotation_log(a.R_WC.transposed() * b.R_WC) * (0.5 / h);
}

Trajectory circle(const Circle& c) {
  return [c](double t) {
    const double a = 2 * kPi * t / c.seconds_per_loop;
    const Vec3 radial{std::sin(a), 0, std::cos(a)}, tangent{std::cos(a), 0, -std::sin(a)};
    return Pose{look_along(c.outward ? radial : tangent, kDown), c.centre_W + radial * c.radius};
  };
}

Trajectory spline(std::vector<Waypoint> points, double interval) {
  // Three equal control points at each end make the curve rest there.
  points.insert(points.begin(), 2, points.front());
  points.insert(points.end(), 2, points.back());
  return [points = std::move(points), interval](double t) {
    const double last = static_cast<double>(points.size()) - 3;
    const double s = std::clamp(t / interval, 0.0, last - 1e-9);
    const auto k = static_cast<std::size_t>(s);
    const double u = s - static_cast<double>(k), r = 1 - u;
    const double w[4] = {r * r * r / 6, (3 * u * u * u - 6 * u * u + 4) / 6,
                         (-3 * u * u * u + 3 * u * u + 3 * u + 1) / 6, u * u * u / 6};
    Vec3 eye, at;
    for (std::size_t i = 0; i < 4; ++i) {
      eye += points[k + i].eye_W * w[i];
      at += points[k + i].at_W * w[i];
    }
    return Pose{look_along(at - eye, kDown), eye};
  };
}

Trajectory shaken(Trajectory base, Random& random, double sigma_m, double sigma_rad) {
  struct Wave {
    double frequency;
    Vec3 move, turn, phase;
  };
  std::vector<Wave> waves;
  const int count = 8;
  for (int k = 0; k < count; ++k) {
    const double frequency = 0.7 * std::pow(6.0 / 0.7, (k + random.uniform()) / count);
    // Amplitudes fall with frequency, as those of a hand do.
    const double a = std::sqrt(2.0 / count) / std::max(1.0, frequency / 1.5);
    const Vec3 move = random.normal3() * (a * sigma_m), turn = random.normal3() * (a * sigma_rad);
    waves.push_back({frequency, move, turn, random.normal3() * kPi});
  }
  return [base = std::move(base), waves](double t) {
    Pose pose = base(t);
    Vec3 move, turn;
    for (const Wave& w : waves) {
      const double a = 2 * kPi * w.frequency * t;
      const Vec3 s{std::sin(a + w.phase.x), std::sin(a + w.phase.y), std::sin(a + w.phase.z)};
      move += Vec3{w.move.x * s.x, w.move.y * s.y, w.move.z * s.z};
      turn += Vec3{w.turn.x * s.y, w.turn.y * s.z, w.turn.z * s.x};
    }
    pose.p_WC += move;
    pose.R_WC = pose.R_WC * rotation_exp(turn);
    return pose;
  };
}

Trajectory swinging(Trajectory base, double from_s, double to_s, double rate) {
  const double pulse = 2 * kPi / kSwingPeriod;
  return [=, base = std::move(base)](double t) {
    Pose pose = base(t);
    // Cubic steps of half a period at both ends.
    const double u = std::clamp(2 * std::min(t - from_s, to_s - t) / kSwingPeriod, 0.0, 1.0);
    const double angle = rate / pulse * u * u * (3 - 2 * u) * std::sin(pulse * (t - from_s));
    pose.R_WC = pose.R_WC * rotation_exp({0, angle, 0});
    return pose;
  };
}

Trajectory turning(const Pose& start, Random& random, double pan, double tilt, double seconds) {
  const double a = random.uniform(0.9, 1.1), b = random.uniform(1.4, 1.8);
  return [=](double t) {
    const double s = 2 * kPi * t / seconds;
    // Zero angle and zero speed at the start.
    const double x = 0.5 * pan * (std::sin(2 * a * s) - std::sin(2 * a * s) * std::exp(-3 * s));
    const double y = 0.5 * tilt * (1 - std::cos(2 * b * s));
    return Pose{start.R_WC * rotation_exp({0, x, 0}) * rotation_exp({y, 0, 0}), start.p_WC};
  };
}

void draw_motion(MotionState& state, Random& random, double dt, double linear_density, double angular_density,
                 const Vec3& dv_C, const Vec3& dw_C) {
  // Half a step's share of the velocity goes with it into the position; the rest of the position's noise is its own.
  const double root = std::sqrt(dt), own = dt * root / std::sqrt(12.0);
  const Vec3 b = random.normal3() * (linear_density * root);
  const Vec3 a = b * (0.5 * dt) + random.normal3() * (linear_density * own);
  const Vec3 d = random.normal3() * (angular_density * root);
  const Vec3 c = d * (0.5 * dt) + random.normal3() * (angular_density * own);
  state.v_W += state.pose.R_WC * dv_C;
  state.w_C += dw_C;
  state.pose.p_WC += state.v_W * dt + a;
  state.pose.R_WC = state.pose.R_WC * rotation_exp(state.w_C * dt + c);
  state.v_W += b;
  state.w_C += d;
}

}  // namespace pf::sim
