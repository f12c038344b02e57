#include "slam.h"

#include <cmath>

#include "inverse_depth.h"

namespace pfsim::gee {
namespace {

/// Numbers of the state for the camera, all points as inverse depths, the planes, and one transformation under way.
constexpr std::size_t kPlanes = 60;
constexpr int kCapacity = 7 + 6 * 200 + 7 * static_cast<int>(kPlanes) + 8;

}  // namespace

Slam::Slam(const SlamOptions& options, const Camera& camera, const Vec7& first_pose, const std::vector<Vec3>& known,
           std::uint64_t seed)
    : options_(options), camera_(camera), ekf_(kCapacity), known_(known), discovery_(options.discovery, seed) {
  const Mat<4, 3> J = increment_jacobian(first_pose.head<4>());
  MatX P = MatX::Zero(7, 7);
  P.topLeftCorner<4, 4>() = options.sigma_start_turn * options.sigma_start_turn * J * J.transpose();
  P.bottomRightCorner<3, 3>() = options.sigma_start_step * options.sigma_start_step * Mat3::Identity();
  ekf_.augment(first_pose, {}, P);
}

bool Slam::step(int frame, const std::vector<Measurement>& seen) {
  if (frame > 0) {
    // Eq. 1: the mean stays; only the noise adds to the camera's own block.
    const Vec7 v = pose();
    const Mat<4, 3> J = increment_jacobian(v.head<4>());
    MatX Q = MatX::Zero(7, 7);
    Q.topLeftCorner<4, 4>() = options_.sigma_turn * options_.sigma_turn * J * J.transpose();
    Q.bottomRightCorner<3, 3>() = options_.sigma_step * options_.sigma_step * Mat3::Identity();
    ekf_.add_noise(0, Q);
  }
  if (!update(seen)) return false;
  drop_behind();
  convert();
  if (options_.planes) {
    fold();
    discover();
    if (options_.fixing) fix();
  }
  if (frame >= options_.first_birth) begin(seen);
  return true;
}

Vec3 Slam::place(const Feature& feature, std::vector<Touch>* J) const {
  if (feature.kind == Kind::kPoint) {
    if (J) *J = {{feature.block, Mat3::Identity()}};
    return ekf_.value(feature.block);
  }
  if (feature.kind == Kind::kInverseDepth) {
    Mat<3, 6> J_m_f;
    const Vec3 m = inverse_depth_point(ekf_.value(feature.block), &J_m_f);
    if (J) *J = {{feature.block, J_m_f}};
    return m;
  }
  const int plane = planes_[static_cast<std::size_t>(feature.plane)].block;
  const bool fixed = feature.kind == Kind::kFixed;
  UnfoldJacobians J_m;
  const Vec3 m = unfold_point(ekf_.value(plane), fixed ? feature.fixed : Vec2(ekf_.value(feature.block)), &J_m);
  if (J) {
    *J = {{plane, J_m.J_m_s}};
    if (!fixed) J->push_back({feature.block, J_m.J_m_u});
  }
  return m;
}

Mat3 Slam::place_covariance(const Feature& feature) const {
  std::vector<Touch> J;
  place(feature, &J);
  return ekf_.derived(J);
}

bool Slam::update(const std::vector<Measurement>& seen) {
  const Vec7 v = pose();
  std::vector<Innovation> innovations;
  std::vector<Touch> J_m;
  for (const Measurement& measurement : seen) {
    Vec3 m = Vec3::Zero();
    J_m.clear();
    if (measurement.id < static_cast<int>(known_.size())) {
      m = known_[static_cast<std::size_t>(measurement.id)];
    } else {
      const auto found = features_.find(measurement.id);
      if (found == features_.end()) continue;
      m = place(found->second, &J_m);
    }
    // Eq. 2 for points, eq. 9 before it for planar ones; eq. 10 and its like for inverse depths chain the same way.
    Vec2 z = Vec2::Zero();
    PointJacobians J;
    if (!project(camera_, v, m, &z, &J)) continue;
    Innovation innovation{measurement.z - z, {{0, J.J_z_v}}};
    for (const Touch& touch : J_m) innovation.H.push_back({touch.block, J.J_z_m * touch.J});
    innovations.push_back(innovation);
  }
  if (!ekf_.update(innovations, options_.sigma_px * options_.sigma_px)) return false;
  Vec7 after = pose();
  if (!after.allFinite()) return false;
  MatX J = MatX::Identity(7, 7);
  J.topLeftCorner<4, 4>() = normalisation_jacobian(after.head<4>());
  after.head<4>().normalize();
  ekf_.set_value(0, after);
  ekf_.map_first(J);
  return true;
}

void Slam::begin(const std::vector<Measurement>& seen) {
  const Vec7 v = pose();
  for (const Measurement& measurement : seen) {
    if (measurement.id < static_cast<int>(known_.size()) || features_.count(measurement.id)) continue;
    BirthJacobians J;
    const Vec6 f = begin_inverse_depth(camera_, v, measurement.z, options_.rho, &J);
    const double noise = options_.sigma_px * options_.sigma_px;
    const MatX R =
        J.J_f_n * Vec3(noise, noise, options_.sigma_rho * options_.sigma_rho).asDiagonal() * J.J_f_n.transpose();
    Feature feature;
    feature.block = ekf_.augment(f, {{0, J.J_f_v}}, R);
    if (feature.block >= 0) features_[measurement.id] = feature;
  }
}

void Slam::drop_behind() {
  for (auto it = features_.begin(); it != features_.end();) {
    const bool bad = it->second.kind == Kind::kInverseDepth && !(ekf_.value(it->second.block)(5) > 0.02);
    if (bad) ekf_.remove(it->second.block);
    it = bad ? features_.erase(it) : std::next(it);
  }
}

void Slam::convert() {
  const Vec3 t = pose().tail<3>();
  for (auto& [id, feature] : features_) {
    if (feature.kind != Kind::kInverseDepth) continue;
    const Vec6 f = ekf_.value(feature.block);
    if (!(linearity_index(f, ekf_.sigma(feature.block, 5), t) < options_.linearity)) continue;
    std::vector<Touch> J;
    const Vec3 m = place(feature, &J);
    feature.block = ekf_.transform(feature.block, m, J);
    feature.kind = Kind::kPoint;
  }
}

double Slam::largest_sigma(int block) const {
  double largest = 0;
  for (int i = 0; i < ekf_.size(block); ++i) largest = std::max(largest, ekf_.sigma(block, i));
  return largest;
}

int Slam::best_plane(const Vec3& m) const {
  int best = -1;
  double least = options_.discovery.d_T;
  for (int p = 0; p < static_cast<int>(planes_.size()); ++p) {
    const Vec7 s = plane(p);
    const Vec3 way = m - s.head<3>();
    const double d = std::abs(way.dot(plane_normal(s)));
    if (d < least && way.norm() < options_.discovery.d_max) {
      best = p;
      least = d;
    }
  }
  return best;
}

void Slam::fold() {
  for (auto& [id, feature] : features_) {
    if (feature.kind != Kind::kPoint || !(largest_sigma(feature.block) < options_.discovery.sigma_T)) continue;
    const Vec3 m = ekf_.value(feature.block);
    const int p = best_plane(m);
    if (p < 0) continue;
    Plane& plane_of = planes_[static_cast<std::size_t>(p)];
    FoldJacobians J;
    const Vec2 u = fold_point(plane(p), m, &J);
    feature.block = ekf_.transform(feature.block, u, {{plane_of.block, J.J_u_s}, {feature.block, J.J_u_m}});
    feature.kind = Kind::kPlanar;
    feature.plane = p;
    plane_of.points.push_back(id);
  }
}

void Slam::discover() {
  if (planes_.size() >= kPlanes) return;
  std::vector<Vec3> points;
  std::vector<int> blocks;
  for (const auto& [id, feature] : features_) {
    if (feature.kind != Kind::kPoint || !(largest_sigma(feature.block) < options_.discovery.sigma_T)) continue;
    points.push_back(ekf_.value(feature.block));
    blocks.push_back(feature.block);
  }
  PlaneFit fit;
  std::vector<std::size_t> inliers;
  if (!discovery_.find(points, &fit, &inliers)) return;
  std::vector<Touch> J;
  for (std::size_t i = 0; i < inliers.size(); ++i) J.push_back({blocks[inliers[i]], fit.J[i]});
  const int block = ekf_.augment(fit.plane, J, MatX::Zero(7, 7));
  if (block >= 0) planes_.push_back({block, {}});
}

void Slam::fix() {
  for (auto& [id, feature] : features_) {
    if (feature.kind != Kind::kPlanar || !(largest_sigma(feature.block) < options_.sigma_fix)) continue;
    feature.fixed = ekf_.value(feature.block);
    ekf_.remove(feature.block);
    feature.block = -1;
    feature.kind = Kind::kFixed;
  }
}

}  // namespace pfsim::gee
