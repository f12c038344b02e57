#include "vio_world.h"

#include <algorithm>
#include <cmath>

#include "sim/imu.h"

namespace pfsim {
namespace {

using pf::sim::Pose;
using pf::sim::Random;
using pf::sim::Vec3;

constexpr double kHalfX = 3, kHalfY = 1.3, kHalfZ = 4;  // of the room [m]
constexpr double kWalkX = 1.6, kWalkZ = 2.6;            // of the ellipse that the walk follows [m]
constexpr double kInterval = 1.2;                       // between way points [s]
constexpr double kStep = 0.6;                           // from one to the next [m]
constexpr double kShakeM = 0.004, kShakeRad = 0.012;    // of the hand
constexpr double kRamp = 0.5;                           // from rest to the walk's speed [s]
constexpr double kBorder = 4;                           // nothing is measured this close to the border [px]
constexpr double kIntoWalk = 2;                         // of a camera that moves from the first frame on [s]
constexpr int kHand = 24;                               // points of a hand
constexpr double kNearest = 0.3;                        // nor nearer [m]
constexpr int kRowTurns = 3;                            // in which a pixel's row is found

/// Points on the walls, the floor and the ceiling, and every third one inside.
Vec3 place(Random& random, int k) {
  const double u = random.uniform(-1, 1), v = random.uniform(-1, 1);
  const double side = k % 2 == 0 ? 1 : -1;
  if (k % 3 == 2) {
    Vec3 p;
    do {
      p = {kHalfX * random.uniform(-1, 1), kHalfY * random.uniform(-1, 1), kHalfZ * random.uniform(-1, 1)};
    } while (std::hypot(p.x / kWalkX, p.z / kWalkZ) < 1.35 && std::hypot(p.x / kWalkX, p.z / kWalkZ) > 0.65);
    return p;
  }
  if (k % 5 == 0) return {kHalfX * u, kHalfY * side, kHalfZ * v};
  return k % 4 < 2 ? Vec3{kHalfX * side, kHalfY * u, kHalfZ * v} : Vec3{kHalfX * u, kHalfY * v, kHalfZ * side};
}

pf_camera_t camera_of_points() {
  const double f = 320 / std::tan(40 * 3.14159265358979 / 180);  // 80 degrees
  return {PF_CAMERA_PINHOLE, 640, 480, f, f, 319.5, 239.5, {}, 0, PF_CAMERA_EXACT, PF_TIMESTAMPS_REAL, 0, 0, 0, {}};
}

pf_pose_t view_of(const Pose& pose) {
  pf_pose_t view = {};
  const auto q = pf::sim::quaternion_of(pose.R_WC);
  std::copy(q.begin(), q.end(), view.q_WC);
  view.p_WC[0] = pose.p_WC.x;
  view.p_WC[1] = pose.p_WC.y;
  view.p_WC[2] = pose.p_WC.z;
  return view;
}

}  // namespace

VioWorld::VioWorld(std::uint64_t seed, int points, double seconds, double rest_s, double turn_rad_s)
    : camera_(camera_of_points()) {
  Random world(seed, 51), way(seed, 52);
  for (int k = 0; k < points; ++k) points_.push_back(place(world, k));
  // Round and round an ellipse, looking ahead and about, up and down.
  std::vector<pf::sim::Waypoint> waypoints;
  double angle = way.uniform(0, 6.283);
  for (double t = 0; t < seconds + 4 * kInterval; t += kInterval) {
    const Vec3 eye = {kWalkX * std::sin(angle), 0, kWalkZ * std::cos(angle)};
    const Vec3 ahead = {kWalkX * std::cos(angle), 0, -kWalkZ * std::sin(angle)};
    const Vec3 at = eye + ahead.unit() * 2.5 + Vec3{way.normal(), 0.5 * way.normal(), way.normal()};
    waypoints.push_back({eye + way.normal3() * 0.12, at});
    angle += kStep / ahead.norm() * way.uniform(0.6, 1.4);
  }
  path_ = pf::sim::after_rest(pf::sim::shaken(pf::sim::spline(waypoints, kInterval), way, kShakeM, kShakeRad), rest_s,
                              kRamp);
  if (turn_rad_s == 0) return;
  const Pose begin = path_(0);
  path_ = [begin, turn_rad_s](double t) {
    return Pose{pf::sim::rotation_exp({0, turn_rad_s * t, 0}) * begin.R_WC, begin.p_WC};
  };
}

VioWorld::VioWorld(std::uint64_t seed, int points, double seconds, Motion motion)
    : VioWorld(seed, points, seconds + kIntoWalk, 0, 0) {
  Random kind(seed, 56);
  const double speed = kind.uniform(0.6, 1.4);
  const auto walk = path_;
  const auto later = [walk, speed](double t) { return walk(kIntoWalk + speed * t); };
  path_ = later;
  const Pose begin = later(0);
  const Vec3 v = (later(0.01).p_WC - begin.p_WC) * 100;
  if (motion == Motion::kRotation) path_ = [later, begin](double t) { return Pose{later(t).R_WC, begin.p_WC}; };
  if (motion == Motion::kEven) path_ = [later, begin, v](double t) { return Pose{later(t).R_WC, begin.p_WC + v * t}; };
}

void VioWorld::wave(double t, double sigma_px, Random& noise, std::vector<pf_observation_t>* seen) const {
  for (int k = 0; k < kHand; ++k) {
    const double a = 0.02 * (k % 6) + 0.12 * std::sin(2.1 * t), b = 0.02 * (k / 6) + 0.08 * std::sin(3.3 * t + 1);
    const double p[3] = {a - 0.05, b - 0.05, 0.4 + 0.03 * std::sin(1.3 * t)};
    double pixel[2];
    if (pf_camera_project(&camera_, p, pixel) != PF_OK) continue;
    const double e[2] = {noise.normal(), noise.normal()};
    seen->push_back({static_cast<std::uint32_t>(points_.size()) + static_cast<std::uint32_t>(k),
                     {pixel[0] + sigma_px * e[0], pixel[1] + sigma_px * e[1]},
                     sigma_px});
  }
}

VioWorld::VioWorld(std::uint64_t seed, const std::string& scene, double rest_s, double shake) {
  pf_sim_options_t options;
  pf_sim_options_default(scene.c_str(), &options);
  options.seed = seed;
  options.shake_m *= shake;
  options.shake_rad *= shake;
  room_.reset(pf_sim_open(scene.c_str(), &options), pf_sim_close);
  pf_sim_camera(room_.get(), &camera_);
  const auto base = [room = room_](double t) {
    pf_pose_t pose;
    pf_sim_pose_at(room.get(), static_cast<std::int64_t>(std::llround(t * 1e9)), &pose);
    return Pose{pf::sim::rotation_of(pose.q_WC), {pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]}};
  };
  path_ = pf::sim::after_rest(base, rest_s, kRamp);
}

std::vector<double> VioWorld::distances(const Pose& pose, const std::vector<Vec3>& p_C) const {
  const auto width = static_cast<std::size_t>(camera_.width), height = static_cast<std::size_t>(camera_.height);
  std::vector<float> depth(width * height);
  const pf_pose_t view = view_of(pose);
  pf_sim_depth(room_.get(), &view, depth.data(), nullptr);
  std::vector<double> out;
  for (const Vec3& p : p_C) {
    const double point[3] = {p.x, p.y, p.z};
    double pixel[2];
    out.push_back(-1);
    if (pf_camera_project(&camera_, point, pixel) != PF_OK) continue;
    const double u = std::round(pixel[0]), v = std::round(pixel[1]);
    if (!(u >= 0 && v >= 0 && u < camera_.width && v < camera_.height)) continue;
    const float z = depth[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)];
    if (z > 0) out.back() = z / p.z * p.norm();
  }
  return out;
}

bool VioWorld::draw(double t, double readout_s, double noise_grey, Random& noise,
                    std::vector<std::uint8_t>* grey) const {
  if (room_ == nullptr) return false;
  std::vector<pf_pose_t> views;
  for (int j = 0; readout_s > 0 && j < camera_.height; ++j) views.push_back(view_of(path_(t + row_time(readout_s, j))));
  const pf_pose_t view = view_of(path_(t));
  pf_image_t image;
  const pf_status_t status =
      views.empty() ? pf_sim_render(room_.get(), &view, &image) : pf_sim_render_rows(room_.get(), views.data(), &image);
  if (status != PF_OK) return false;
  grey->resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (std::size_t i = 0; i < grey->size(); ++i) {
    const double value = image.pixels[i] + noise_grey * noise.normal();
    (*grey)[i] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
  }
  return true;
}

double VioWorld::row_time(double readout_s, double row) const {
  return readout_s * ((row + 0.5) / camera_.height - 0.5);
}

bool VioWorld::project(const Pose& pose, const Vec3& point, double pixel[2]) const {
  const Vec3 p_C = pose.R_WC.transposed() * (point - pose.p_WC);
  const double p[3] = {p_C.x, p_C.y, p_C.z};
  return p_C.z >= kNearest && pf_camera_project(&camera_, p, pixel) == PF_OK && pixel[0] >= kBorder &&
         pixel[1] >= kBorder && pixel[0] <= camera_.width - 1 - kBorder && pixel[1] <= camera_.height - 1 - kBorder;
}

std::vector<pf_observation_t> VioWorld::observe(double t, double readout_s, double sigma_px, Random& noise) const {
  const Pose pose = path_(t);
  std::vector<pf_observation_t> seen;
  for (std::size_t id = 0; id < points_.size(); ++id) {
    double pixel[2];
    bool in_view = project(pose, points_[id], pixel);
    // A row's time says where the point is, and that says which row it is in: the camera moves little in between.
    for (int turn = 0; readout_s > 0 && in_view && turn < kRowTurns; ++turn)
      in_view = project(path_(t + row_time(readout_s, pixel[1])), points_[id], pixel);
    if (!in_view) continue;
    const double e[2] = {noise.normal(), noise.normal()};
    seen.push_back(
        {static_cast<std::uint32_t>(id), {pixel[0] + sigma_px * e[0], pixel[1] + sigma_px * e[1]}, sigma_px});
  }
  return seen;
}

}  // namespace pfsim
