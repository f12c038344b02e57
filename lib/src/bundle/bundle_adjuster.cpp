#include "bundle/bundle_adjuster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bundle/tuning.h"
#include "geometry/camera_distortion.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {
namespace {

using namespace tuning::adjust;

const Camera& camera_of(const Camera& camera, const Bundle& bundle) {
  return bundle.lens == nullptr ? camera : *bundle.lens->camera;
}

bool is_finite(const BundlePose& pose) { return pose.q_WC.coeffs().allFinite() && pose.p_W.allFinite(); }

/// Of kSize unknowns from a column on.
template <int kSize>
Eigen::Matrix<Scalar, kSize, kSize> covariance_of(const NormalEquations& equations, int column) {
  Eigen::Matrix<Scalar, kSize, kSize> covariance;
  for (int c = 0; c < kSize; ++c) {
    equations.solve_unit(column + c);
    for (int a = 0; a < kSize; ++a) covariance(a, c) = equations.b[column + a];
  }
  return covariance;
}

}  // namespace

bool BundleAdjuster::layout(Arena& arena, int max_poses, int max_free_poses, int max_points, int max_planes,
                            int max_lens_rows) {
  old_pose_ = arena.take<BundlePose>(static_cast<std::size_t>(max_poses));
  old_plane_ = arena.take<Vec3>(static_cast<std::size_t>(max_planes));
  old_rho_ = arena.take<Scalar>(static_cast<std::size_t>(max_points));
  old_lens_ = max_lens_rows > 0 ? arena.take<Camera>(1) : nullptr;
  return terms_.layout(arena, max_poses, max_free_poses, max_points, max_planes, max_lens_rows);
}

Scalar BundleAdjuster::rho_step(int point) const {
  return terms_.equations.point_step(point, terms_.free_plane_of(point));
}

bool BundleAdjuster::step(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping) {
  terms_.begin(bundle);
  terms_.linearise(camera_of(camera, bundle), options, bundle, damping);
  return terms_.equations.solve(damping);
}

/// Moves what is free by the step; false when something is then no number.
bool BundleAdjuster::take_step(const Bundle& bundle) {
  bool finite = true;
  const Scalar* dx = terms_.equations.b;
  for (int j = 0; j < bundle.planes && terms_.equations.plane_columns > 0; ++j) {
    BundlePlane& plane = bundle.plane[j];
    if (!plane.free) continue;
    plane.x += Vec3(dx[0], dx[1], dx[2]);
    finite = finite && plane.x.allFinite();
    dx += 3;
  }
  if (terms_.equations.lens_columns > 0) {
    move_lens(bundle.lens->rows, dx, bundle.lens->camera);
    finite = finite && check_camera(*bundle.lens->camera) == nullptr;
    dx += terms_.equations.lens_columns;
  }
  for (int c = 0; c < bundle.poses; ++c) {
    BundlePose& pose = bundle.pose[c];
    if (!pose.free) continue;
    pose.q_WC = exp_so3(Vec3(dx[0], dx[1], dx[2])) * pose.q_WC;
    pose.q_WC.normalize();
    pose.p_W += Vec3(dx[3], dx[4], dx[5]);
    finite = finite && is_finite(pose);
    dx += 6;
  }
  for (int i = 0; i < bundle.points; ++i) {
    bundle.rho[i] += rho_step(i);
    finite = finite && std::isfinite(bundle.rho[i]);
  }
  return finite;
}

void BundleAdjuster::keep(const Bundle& bundle) {
  std::copy(bundle.pose, bundle.pose + bundle.poses, old_pose_);
  std::copy(bundle.rho, bundle.rho + bundle.points, old_rho_);
  for (int j = 0, k = 0; j < bundle.planes && terms_.equations.plane_columns > 0; ++j)
    if (bundle.plane[j].free) old_plane_[k++] = bundle.plane[j].x;
  if (terms_.equations.lens_columns > 0) *old_lens_ = *bundle.lens->camera;
}

void BundleAdjuster::restore(const Bundle& bundle) {
  std::copy(old_pose_, old_pose_ + bundle.poses, bundle.pose);
  std::copy(old_rho_, old_rho_ + bundle.points, bundle.rho);
  for (int j = 0, k = 0; j < bundle.planes && terms_.equations.plane_columns > 0; ++j)
    if (bundle.plane[j].free) bundle.plane[j].x = old_plane_[k++];
  if (terms_.equations.lens_columns > 0) *bundle.lens->camera = *old_lens_;
  for (int i = 0; i < bundle.points && terms_.equations.lens_columns > 0; ++i) terms_.set_ray(bundle, i, nullptr);
}

/// Where a step is tried, cost and linearisation come together, with the damping of the round that follows if the step is kept; so
/// each pixel is projected once a round, and once more after a step that is not. Where the last gain was near to the bound, the step is
/// probably the last one, and its cost is enough.
Scalar BundleAdjuster::adjust(const Camera& calibration, const AdjustOptions& options, const Bundle& bundle) {
  const Camera& camera = camera_of(calibration, bundle);
  terms_.begin(bundle);
  Scalar damping = kFirstDamping;
  Scalar before = terms_.linearise(camera, options, bundle, damping);
  bool last = false;
  for (rounds_ = 0; rounds_ < options.max_rounds;) {
    ++rounds_;
    last = last || rounds_ == options.max_rounds;
    keep(bundle);
    const Scalar next = std::max(damping / kDampingDown, kMinDamping);
    Scalar after = before;
    if (terms_.equations.solve(damping) && take_step(bundle))
      after = last ? terms_.cost(camera, options, bundle) : terms_.linearise(camera, options, bundle, next);
    if (after < before) {
      const Scalar gain = before - after, bound = options.small_gain * before;
      before = after;
      damping = next;
      if (gain < bound) break;
      if (last && rounds_ < options.max_rounds) terms_.linearise(camera, options, bundle, damping);
      last = gain < kNearlyDone * bound;
    } else {
      restore(bundle);
      damping *= kDampingUp;
      if (damping > kMaxDamping) break;
      if (rounds_ < options.max_rounds) terms_.linearise(camera, options, bundle, damping);
    }
  }
  return before;
}

/// S = L Lᵀ with the last pose's rows last: their covariance is (L_22 L_22ᵀ)⁻¹.
bool BundleAdjuster::last_pose_covariance(const Camera& camera, const AdjustOptions& options, const Bundle& bundle,
                                          Mat6* covariance) {
  const NormalEquations& equations = terms_.equations;
  if (!begin_covariances(camera, options, bundle) || equations.columns == equations.pose_column(0)) return false;
  const Scalar* L = equations.H + (equations.columns - 6) * (equations.ld + 1);
  for (int c = 0; c < 6; ++c) {
    Vec6 x = Vec6::Zero();
    x(c) = Scalar(1);
    solve_cholesky(L, 6, equations.ld, x.data());
    covariance->col(c) = x;
  }
  return true;
}

bool BundleAdjuster::begin_covariances(const Camera& camera, const AdjustOptions& options, const Bundle& bundle) {
  terms_.begin(bundle);
  terms_.linearise(camera_of(camera, bundle), options, bundle, Scalar(0));
  return terms_.equations.columns > 0 && terms_.equations.factor();
}

Mat6 BundleAdjuster::pose_covariance(int pose) const {
  const int free = terms_.free_pose(pose);
  return free < 0 ? Mat6(Mat6::Zero()) : covariance_of<6>(terms_.equations, terms_.equations.pose_column(free));
}

Mat3 BundleAdjuster::plane_covariance(int plane) const {
  const int free = terms_.free_plane(plane);
  return free < 0 ? Mat3(Mat3::Zero()) : covariance_of<3>(terms_.equations, 3 * free);
}

void BundleAdjuster::lens_covariance(Scalar* covariance) const {
  const NormalEquations& equations = terms_.equations;
  const int rows = equations.lens_columns, first = equations.plane_columns;
  for (int c = 0; c < rows; ++c) {
    equations.solve_unit(first + c);
    for (int a = 0; a < rows; ++a) covariance[a * rows + c] = equations.b[first + a];
  }
}

/// With the other unknowns x: drho = -wᵀ dx / D + e, var(e) = 1 / D.
Scalar BundleAdjuster::rho_variance(int point) const {
  const NormalEquations& equations = terms_.equations;
  const Scalar D = equations.D[point];
  if (!(D > Scalar(0))) return std::numeric_limits<Scalar>::infinity();
  const int plane = terms_.free_plane_of(point);
  equations.spread(point, plane, Scalar(1) / D);
  equations.solve_factored();
  return Scalar(1) / D + equations.gather(point, plane) / D;
}

/// dp = M dx + j e,  M = dp/dx_H + R_WH dr/dc / rho - j wᵀ / D,  j = dp/drho = -q / rho.
bool BundleAdjuster::point_covariance(const Bundle& bundle, int point, Scalar sigma_bearing, Mat3* covariance) const {
  const NormalEquations& equations = terms_.equations;
  const Scalar D = equations.D[point], rho = bundle.rho[point];
  if (!(D > Scalar(0)) || !(rho > Scalar(0))) return false;
  const int host = host_of(bundle, point), free_host = terms_.free_pose(host), plane = terms_.free_plane_of(point);
  const int lens_columns = equations.lens_columns;
  const Vec3 q = bundle.pose[host].q_WC * bundle.ray[point] / rho, j = -q / rho;
  const Mat3 by_rotation = -hat(q);
  RayByLens by_lens = RayByLens::Zero();
  if (lens_columns > 0) terms_.set_ray(bundle, point, &by_lens);
  const auto by = [&](int row, int k) { return by_lens(row, bundle.lens->rows.parameter[k]) / rho; };
  Mat3 P = j * j.transpose() / D;
  P += sigma_bearing * sigma_bearing * (q.squaredNorm() * Mat3::Identity() - q * q.transpose());
  Scalar* of_host = free_host >= 0 ? equations.b + equations.pose_column(free_host) : nullptr;
  Scalar* of_lens = equations.b + equations.plane_columns;
  for (int c = 0; c < 3; ++c) {
    equations.spread(point, plane, -j(c) / D);
    for (int a = 0; a < 3 && of_host != nullptr; ++a) of_host[a] += by_rotation(c, a);
    if (of_host != nullptr) of_host[3 + c] += Scalar(1);
    for (int k = 0; k < lens_columns; ++k) of_lens[k] += by(c, k);
    equations.solve_factored();
    const Scalar along_w = equations.gather(point, plane) / D;
    for (int r = 0; r < 3; ++r) {
      P(r, c) -= j(r) * along_w;
      for (int a = 0; a < 3 && of_host != nullptr; ++a) P(r, c) += by_rotation(r, a) * of_host[a];
      if (of_host != nullptr) P(r, c) += of_host[3 + r];
      for (int k = 0; k < lens_columns; ++k) P(r, c) += by(r, k) * of_lens[k];
    }
  }
  *covariance = (P + P.transpose()) / 2;
  return true;
}

}  // namespace pf
