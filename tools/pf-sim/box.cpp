#include "box.h"

#include <algorithm>
#include <cmath>

namespace pfsim {

using pf::sim::box_axes;
using pf::sim::Mat3;
using pf::sim::Pose;
using pf::sim::rotation_exp;
using pf::sim::Vec3;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180;
using pf::sim::kBoxHalf;
using pf::sim::kBoxPoster;
constexpr double kMaxSlantDeg = 66;   // beyond, nobody finds a point of a poster again
constexpr double kBorder = 8;         // nothing is measured so close to the border [px]
constexpr double kSigmaSpeed = 0.1;   // of the first velocities [m/s], [rad/s]
constexpr double kExactSigma = 1e-6;  // [rad], [m]
constexpr double kAbsentAhead = 0.5;  // of the wall that is not there, before its side [m]
constexpr double kShift = 1.0;        // of the wall that is elsewhere [m]

enum Stream : std::uint64_t { kPointStream = 51, kPathStream, kNoiseStream, kPlanStream, kStartStream };

void set(const Mat3& R, const Vec3& p, pf_wall_prior_t* wall) {
  for (int i = 0; i < 9; ++i) wall->R_WP[i] = R.m[static_cast<std::size_t>(i)];
  wall->p_WP[0] = p.x;
  wall->p_WP[1] = p.y;
  wall->p_WP[2] = p.z;
}

Vec3 origin_of(const pf_wall_prior_t& wall) { return {wall.p_WP[0], wall.p_WP[1], wall.p_WP[2]}; }
Vec3 axis_of(const pf_wall_prior_t& wall, int axis) {
  return {wall.R_WP[axis], wall.R_WP[3 + axis], wall.R_WP[6 + axis]};
}

void move_along_normal(double metres, pf_wall_prior_t* wall) {
  for (int i = 0; i < 3; ++i) wall->p_WP[i] += metres * wall->R_WP[3 * i + 2];
}

}  // namespace

Vec3 Box::normal(int side) { return pf::sim::box_normal(side); }

Vec3 Box::centre(int side) { return normal(side) * kBoxHalf; }

Box::Box(const BoxOptions& options, const pf_camera_t& camera, double sigma_px, std::uint64_t seed,
         const pf_sim_t* film)
    : options_(options), camera_(camera), sigma_px_(sigma_px), noise_(seed, kNoiseStream) {
  pf::sim::Random place(seed, kPointStream), way(seed, kPathStream), plan(seed, kPlanStream), draw(seed, kStartStream);
  for (int side = 0; side < kBoxSides; ++side) {
    const Mat3 R = box_axes(side);
    for (int k = 0; k < options.points_on_side; ++k) {
      const double u = place.uniform(-kBoxPoster, kBoxPoster), v = place.uniform(-kBoxPoster, kBoxPoster);
      points_.push_back({centre(side) + R * Vec3{u, v, 0}, side});
    }
    // Even over a disk of that radius: each of the two angles has half of the radius as its standard deviation.
    const double angle = options.max_angle_deg * kDegree * std::sqrt(plan.uniform());
    const double direction = plan.uniform(0, 2 * kPi);
    const Mat3 wrong = R * rotation_exp(Vec3{std::cos(direction), std::sin(direction), 0} * angle);
    pf_wall_prior_t& wall = plan_[side];
    set(wrong, centre(side), &wall);
    move_along_normal(options.sigma_offset * plan.normal(), &wall);
    const double sigma = 0.5 * options.max_angle_deg * kDegree;
    wall.covariance[0] = wall.covariance[4] = sigma * sigma;
    wall.covariance[8] = options.sigma_offset * options.sigma_offset;
    wall.outline_count = 4;
    const double corner[4][2] = {
        {-kBoxHalf, -kBoxHalf}, {kBoxHalf, -kBoxHalf}, {kBoxHalf, kBoxHalf}, {-kBoxHalf, kBoxHalf}};
    std::copy(&corner[0][0], &corner[0][0] + 8, &wall.outline_P[0][0]);
  }
  if (film != nullptr) {
    path_ = [film](double t) {
      pf_pose_t pose;
      pf_sim_pose_at(film, std::llround(1e9 * t), &pose);
      return Pose{pf::sim::rotation_of(pose.q_WC), {pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]}};
    };
  } else {
    // It begins at a corner of the box, where two sides are seen.
    path_ = shaken(pf::sim::box_circle(options.loop_seconds, 0.25 * kPi), way, options.shake_m, options.shake_rad);
  }

  const Pose first = path_(0);
  Vec3 v, w;
  velocities(path_, 0, v, w);
  const double sigma_theta = options.sigma_start_deg * kDegree;
  const Mat3 R = rotation_exp(draw.normal3() * sigma_theta) * first.R_WC;
  const Vec3 p = first.p_WC + draw.normal3() * options.sigma_start_m;
  v += draw.normal3() * kSigmaSpeed;
  w += draw.normal3() * kSigmaSpeed;
  const auto q = quaternion_of(R);
  std::copy(q.begin(), q.end(), start_.q_WC);
  const double numbers[9] = {p.x, p.y, p.z, v.x, v.y, v.z, w.x, w.y, w.z};
  std::copy(numbers, numbers + 3, start_.p_WC);
  std::copy(numbers + 3, numbers + 6, start_.v_W);
  std::copy(numbers + 6, numbers + 9, start_.w_C);
  for (int i = 0; i < 6; ++i) {
    const double sigma = i < 3 ? sigma_theta : options.sigma_start_m;
    start_.covariance[7 * i] = sigma * sigma;
    velocity_covariance_[7 * i] = kSigmaSpeed * kSigmaSpeed;
  }
}

std::vector<pf_wall_prior_t> Box::walls(Plan plan) const {
  if (plan == Plan::kNone) return {};
  std::vector<pf_wall_prior_t> walls(plan_, plan_ + kBoxSides);
  if (plan == Plan::kExact || plan == Plan::kUngated)
    for (pf_wall_prior_t& wall : walls)
      for (int i = 0; i < 9; i += 4) wall.covariance[i] = kExactSigma * kExactSigma;
  if (plan == Plan::kAbsent) {
    walls.push_back(plan_[1]);
    set(box_axes(1), centre(1), &walls.back());
    move_along_normal(kAbsentAhead, &walls.back());
    for (int k = 0; k < 4; ++k) walls.back().outline_P[k][0] *= 0.5;
  }
  if (plan == Plan::kShifted) move_along_normal(kShift, &walls[1]);
  if (plan == Plan::kMissing) walls.erase(walls.begin() + 1);
  if (plan == Plan::kHalf) walls = {walls[0], walls[2]};
  return walls;
}

bool Box::in_view(const Point& point, const Pose& pose, double pixel[2]) const {
  const Vec3 ray_W = point.p_W - pose.p_WC, p = pose.R_WC.transposed() * ray_W;
  if (-ray_W.dot(normal(point.side)) < ray_W.norm() * std::cos(kMaxSlantDeg * kDegree)) return false;
  const double p_C[3] = {p.x, p.y, p.z};
  return p.z > 0 && pf_camera_project(&camera_, p_C, pixel) == PF_OK && pixel[0] >= kBorder && pixel[1] >= kBorder &&
         pixel[0] <= camera_.width - 1 - kBorder && pixel[1] <= camera_.height - 1 - kBorder;
}

std::vector<pf_observation_t> Box::observe(int frame) {
  std::vector<pf_observation_t> seen;
  const Pose pose = truth(frame);
  double pixel[2];
  for (std::size_t id = 0; id < points_.size(); ++id) {
    const double noise[2] = {noise_.normal(), noise_.normal()};  // drawn for all, so that every plan has the same
    if (!in_view(points_[id], pose, pixel)) continue;
    seen.push_back(
        {static_cast<std::uint32_t>(id), {pixel[0] + sigma_px_ * noise[0], pixel[1] + sigma_px_ * noise[1]}, 0});
  }
  return seen;
}

int Box::count_behind(const pf_wall_prior_t& wall, int frame) const {
  const Pose pose = truth(frame);
  const Vec3 o = origin_of(wall), n = axis_of(wall, 2);
  const double height = n.dot(pose.p_WC - o);
  int count = 0;
  double pixel[2];
  for (const Point& point : points_) {
    const Vec3 ray = point.p_W - pose.p_WC;
    if (height <= 0 || n.dot(ray) >= 0 || !in_view(point, pose, pixel)) continue;
    const Vec3 at = pose.p_WC + ray * (-height / n.dot(ray)) - o;
    count += std::fabs(at.dot(axis_of(wall, 0))) < wall.outline_P[1][0] &&
             std::fabs(at.dot(axis_of(wall, 1))) < wall.outline_P[2][1];
  }
  return count;
}

}  // namespace pfsim
