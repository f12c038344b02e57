#pragma once

#include <functional>
#include <vector>

#include "sim/linear.h"
#include "sim/random.h"

namespace pf::sim {

/// Camera pose at a time [s], smooth.
using Trajectory = std::function<Pose(double)>;

/// Velocities of a trajectory at a time, by central differences: v_W [m/s] and w_C [rad/s].
void velocities(const Trajectory& trajectory, double t, Vec3& v_W, Vec3& w_C);

/// Circle in the level plane (W's y is down) about a centre, looking outward or along a tangent.
struct Circle {
  Vec3 centre_W;
  double radius = 1;  // [m]
  double seconds_per_loop = 180;
  bool outward = true;
};
Trajectory circle(const Circle& circle);

/// Where the camera is and what it looks at.
struct Waypoint {
  Vec3 eye_W, at_W;
};

/// Uniform cubic B-spline through the neighbourhood of the way points, one each `interval` seconds, level horizon;
/// twice continuously differentiable. It rests at the first and the last one.
Trajectory spline(std::vector<Waypoint> points, double interval);

/// Like a hand: sums of sines between 0.7 and 6 Hz on top of another trajectory.
Trajectory shaken(Trajectory base, Random& random, double sigma_m, double sigma_rad);

/// Another trajectory that also swings left and right about the camera's vertical axis from one time to another, with an angular
/// velocity of up to rate [rad/s]. Swings take kSwingPeriod and begin and end within half of that, without a jump of the velocity.
constexpr double kSwingPeriod = 0.8;  // [s]
Trajectory swinging(Trajectory base, double from_s, double to_s, double rate);

/// The pose at time 0 of another trajectory, turning only: pan and tilt within the given amplitudes [rad].
Trajectory turning(const Pose& start, Random& random, double pan, double tilt, double seconds);

/// State of a constant-velocity body: x right, y down, z forward in C.
struct MotionState {
  Pose pose;
  Vec3 v_W, w_C;
};

/// One step of the constant-velocity model with continuous white accelerations, drawn exactly in position and velocity:
///
///   v = v + R_WC dv_C,  w = w + dw_C                                      the steering, at the start of the step
///   p' = p + v dt + a,  v' = v + b                                        (a, b) ~ density^2 [dt^3/3 dt^2/2; dt^2/2 dt]
///   R' = R Exp(w dt + c),  w' = w + d                                     (c, d) likewise
///
/// linear_density   [m/s^2/sqrt(Hz)]
/// angular_density  [rad/s^2/sqrt(Hz)]
/// dv_C, dw_C       known steering [m/s], [rad/s]
void draw_motion(MotionState& state, Random& random, double dt, double linear_density, double angular_density,
                 const Vec3& dv_C, const Vec3& dw_C);

}  // namespace pf::sim
