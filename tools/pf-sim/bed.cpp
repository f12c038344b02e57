#include "bed.h"

#include <algorithm>
#include <cmath>

namespace pfsim {

using pf::sim::look_along;
using pf::sim::Pose;
using pf::sim::rotation_exp;
using pf::sim::rotation_log;
using pf::sim::Vec3;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRoomHalf = 2.0;    // walls at +-2 m
constexpr double kWallMargin = 0.1;  // points that lie on no wall keep this distance from all [m]
constexpr double kFreeRadius = 1.2;  // no points where a steered camera walks [m]
constexpr double kNearest = 0.2;     // nothing nearer is measured [m]
constexpr double kBorder = 4;        // nor this close to the border [px]
constexpr double kWalkRadius = 0.5;  // of the nominal way about the middle of the room [m]
constexpr double kHoldSeconds = 2;   // in front of the target

const Vec3 kDown{0, 1, 0};

void set(double out[3], const Vec3& v) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

}  // namespace

pf_camera_t Bed::camera(double fov_deg) {
  const double f = 160.0 / std::tan(fov_deg * kPi / 360);
  return {PF_CAMERA_PINHOLE, 320, 240, f, f, 159.5, 119.5, {}, 0, PF_CAMERA_EXACT, PF_TIMESTAMPS_REAL, 0, 0, 0, {}};
}

Bed::Bed(const BedOptions& options, const pf_config_t& config, std::uint64_t seed)
    : options_(options),
      config_(config),
      lens_(config.camera),
      world_(seed, 11),
      motion_(seed, 12),
      noise_(seed, 13),
      start_draw_(seed, 14) {
  // Either the truth is drawn about the mean or the mean about a fixed truth: the error has the same distribution.
  const double sigma_theta = options.sigma_start_deg * kPi / 180;
  const Vec3 theta = start_draw_.normal3() * sigma_theta, e = start_draw_.normal3() * options.sigma_start_m;
  const Pose named = nominal(0);
  Pose mean = named, true_pose = named;
  if (options.circle) {
    mean = {rotation_exp(-theta) * named.R_WC, named.p_WC - e};
  } else {
    true_pose = {rotation_exp(theta) * named.R_WC, named.p_WC + e};
  }
  truth_.pose = true_pose;
  truth_.v_W = start_draw_.normal3() * options.sigma_start_v;
  truth_.w_C = start_draw_.normal3() * options.sigma_start_w;

  const auto q = quaternion_of(mean.R_WC);
  std::copy(q.begin(), q.end(), start_.q_WC);
  set(start_.p_WC, mean.p_WC);
  for (int i = 0; i < 6; ++i) {
    start_.covariance[7 * i] = i < 3 ? sigma_theta * sigma_theta : options.sigma_start_m * options.sigma_start_m;
    velocity_covariance_[7 * i] =
        i < 3 ? options.sigma_start_v * options.sigma_start_v : options.sigma_start_w * options.sigma_start_w;
  }
  if (options.draw_lens) draw_lens(seed);
  place_target();
  if (options.layout == Layout::kRoom) place_room();
}

void Bed::draw_lens(std::uint64_t seed) {
  pf::sim::Random random(seed, 15);
  const double focal = lens_.sigma_focal * random.normal(), aspect = lens_.sigma_aspect * random.normal();
  lens_.fx *= 1 + focal + aspect / 2;
  lens_.fy *= 1 + focal - aspect / 2;
  lens_.cx += lens_.sigma_centre_px * random.normal();
  lens_.cy += lens_.sigma_centre_px * random.normal();
  lens_.distortion[0] += lens_.sigma_distortion[0] * random.normal();
  if (lens_.distortion[0] != 0) lens_.model = PF_CAMERA_RADTAN;
}

Pose Bed::nominal(int frame) const {
  const double t = frame / options_.rate_hz;
  double angle, radius;
  if (options_.circle) {
    angle = 2 * kPi * t / options_.circle_seconds;
    radius = 1.0;
  } else {
    // Still in front of the target, then smoothly on.
    const double since = std::max(0.0, t - kHoldSeconds);
    angle = 2 * kPi * (since < 2 ? since * since / 4 : since - 1) / options_.steer_seconds;
    radius = kWalkRadius;
  }
  const Vec3 radial{std::sin(angle), 0, std::cos(angle)};
  return {look_along(options_.circle && options_.look_inward ? -radial : radial, kDown), radial * radius};
}

void Bed::place_target() {
  target_.kind = PF_TARGET_POINTS;
  target_.count = options_.target_points;
  target_.sigma = 0.001;
  target_.first_pose = start_;
  const Pose from = nominal(0);
  const int side = static_cast<int>(std::ceil(std::sqrt(options_.target_points)));
  const pf::sim::Mat3 slant = from.R_WC * rotation_exp({0, options_.target_slant_deg * kPi / 180, 0});
  const Vec3 centre = from.p_WC + from.R_WC * Vec3{0, 0, options_.target_distance};
  for (int k = 0; k < target_.count; ++k) {
    const double u = (k % side) / (side - 1.0) - 0.5, v = (k / side) / (side - 1.0) - 0.5;
    const Vec3 p = centre + slant * Vec3{u * options_.target_size, v * options_.target_size, 0};
    set(target_.points_W[k], p);
    points_.push_back({p + world_.normal3() * target_.sigma, false, false, -1});
  }
}

void Bed::place_room() {
  const double h = options_.room_half_height;
  for (int k = 0; k < 200; ++k) {
    Vec3 p;
    if (k < 100) {
      const double along = world_.uniform(-kRoomHalf, kRoomHalf), y = world_.uniform(-h, h);
      const Vec3 wall[4] = {
          {along, y, kRoomHalf}, {along, y, -kRoomHalf}, {kRoomHalf, y, along}, {-kRoomHalf, y, along}};
      p = wall[k % 4];
    } else {
      const double half = kRoomHalf - kWallMargin;
      do {
        const double x = world_.uniform(-half, half), z = world_.uniform(-half, half);
        p = {x, world_.uniform(-h, h), z};
      } while (!options_.circle && std::hypot(p.x, p.z) < kFreeRadius);
    }
    points_.push_back({p, false, false, k < 100 ? k % 4 : -1});
  }
}

Vec3 Bed::wall_normal(int wall) {
  const Vec3 normal[4] = {{0, 0, -1}, {0, 0, 1}, {-1, 0, 0}, {1, 0, 0}};
  return normal[wall];
}

void Bed::steer(int frame, const pf_pose_t& estimate, double dv_C[3], double dw_C[3]) const {
  set(dv_C, {});
  set(dw_C, {});
  if (options_.circle) return;
  // A damped spring to the nominal way: 3 rad/s in position, 6 rad/s in rotation, both critically damped.
  const double dt = 1 / options_.rate_hz;
  const Pose now = nominal(frame), next = nominal(frame + 1);
  const Vec3 v_nominal = (next.p_WC - now.p_WC) * options_.rate_hz;
  const Vec3 w_nominal = rotation_log(now.R_WC.transposed() * next.R_WC) * options_.rate_hz;
  const pf::sim::Mat3 R = pf::sim::rotation_of(estimate.q_WC);
  const Vec3 p{estimate.p_WC[0], estimate.p_WC[1], estimate.p_WC[2]};
  const Vec3 v{estimate.v_W[0], estimate.v_W[1], estimate.v_W[2]};
  const Vec3 w{estimate.w_C[0], estimate.w_C[1], estimate.w_C[2]};
  const Vec3 turn_C = rotation_log(R.transposed() * now.R_WC);
  set(dv_C, R.transposed() * ((now.p_WC - p) * 9.0 + (v_nominal - v) * 6.0) * dt);
  set(dw_C, (turn_C * 36.0 + (w_nominal - w) * 12.0) * dt);
}

void Bed::move(int frame, const double dv_C[3], const double dw_C[3]) {
  if (options_.circle) {
    truth_.pose = nominal(frame);
    return;
  }
  draw_motion(truth_, motion_, 1 / options_.rate_hz, config_.motion.linear_acceleration_density,
              config_.motion.angular_acceleration_density, {dv_C[0], dv_C[1], dv_C[2]}, {dw_C[0], dw_C[1], dw_C[2]});
}

bool Bed::in_view(const Vec3& p_W, double pixel[2]) const {
  const Vec3 p_C = truth_.pose.R_WC.transposed() * (p_W - truth_.pose.p_WC);
  const double p[3] = {p_C.x, p_C.y, p_C.z};
  return p_C.z > 0 && p_C.norm() > kNearest && pf_camera_project(&lens_, p, pixel) == PF_OK && pixel[0] >= kBorder &&
         pixel[1] >= kBorder && pixel[0] <= lens_.width - 1 - kBorder && pixel[1] <= lens_.height - 1 - kBorder;
}

std::vector<pf_observation_t> Bed::observe(int frame, int* births) {
  std::vector<pf_observation_t> seen;
  *births = 0;
  const bool may_begin = frame >= options_.first_birth;
  const auto measure = [&](std::size_t id, const double pixel[2]) {
    const double noise[2] = {noise_.normal(), noise_.normal()};
    seen.push_back(
        {static_cast<std::uint32_t>(id),
         {pixel[0] + config_.measurement.sigma_px * noise[0], pixel[1] + config_.measurement.sigma_px * noise[1]},
         0});
    if (!points_[id].begun && id >= static_cast<std::size_t>(target_.count)) ++*births;
    points_[id].begun = true;
  };
  double pixel[2];
  for (std::size_t id = 0; id < points_.size(); ++id) {
    const bool known = points_[id].begun || id < static_cast<std::size_t>(target_.count);
    if (!points_[id].retired && (known || may_begin) && in_view(points_[id].p_W, pixel)) measure(id, pixel);
  }
  if (options_.layout == Layout::kModel && may_begin) {
    while (static_cast<int>(seen.size()) < options_.points_in_view) {
      pixel[0] = world_.uniform(kBorder, lens_.width - 1 - kBorder);
      pixel[1] = world_.uniform(kBorder, lens_.height - 1 - kBorder);
      double rho = 0;
      const double rho0 = 1 / config_.first_depth.depth;
      while (rho < 0.02 * rho0) rho = rho0 * (1 + config_.first_depth.relative_sigma * world_.normal());
      double ray[3];
      if (pf_camera_unproject(&lens_, pixel, ray) != PF_OK) break;
      points_.push_back(
          {truth_.pose.p_WC + truth_.pose.R_WC * (Vec3{ray[0], ray[1], ray[2]} * (1 / rho)), false, false, -1});
      measure(points_.size() - 1, pixel);
    }
  }
  return seen;
}

}  // namespace pfsim
