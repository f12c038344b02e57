#include "window/adjust.h"

#include <algorithm>
#include <cmath>

#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "window/tuning.h"

namespace pf {
namespace {

using namespace tuning::adjust;

int host_of(const Bundle& bundle, int point) { return bundle.host == nullptr ? 0 : bundle.host[point]; }

}  // namespace

Scalar huber_cost(Scalar r2, Scalar huber, Scalar* weight) {
  if (r2 <= huber * huber) {
    *weight = Scalar(1);
    return r2;
  }
  const Scalar r = std::sqrt(r2);
  *weight = huber / r;
  return Scalar(2) * huber * r - huber * huber;
}

bool project_bearing(const Camera& camera, const Mat3& R_WC, const Vec3& ray_W, const Vec3& p_HC_W, Scalar rho,
                     Vec2* pixel, Mat26* J_z_C, Mat26* J_z_H, Vec2* J_z_rho) {
  const Mat3 R_CW = R_WC.transpose();
  const Vec3 d = ray_W + rho * p_HC_W;
  if (J_z_C == nullptr) return project(camera, R_CW.lazyProduct(d), pixel);
  Mat23 J_z_d_C;
  if (!project(camera, R_CW.lazyProduct(d), pixel, &J_z_d_C)) return false;
  const Mat23 J_z_d = J_z_d_C.lazyProduct(R_CW);
  J_z_C->leftCols<3>() = J_z_d.lazyProduct(hat(d));
  J_z_C->rightCols<3>() = -rho * J_z_d;
  if (J_z_H != nullptr) {
    J_z_H->leftCols<3>() = -J_z_d.lazyProduct(hat(ray_W));
    J_z_H->rightCols<3>() = rho * J_z_d;
  }
  if (J_z_rho != nullptr) *J_z_rho = J_z_d.lazyProduct(p_HC_W);
  return true;
}

bool BundleAdjuster::layout(Arena& arena, int max_poses, int max_free_poses, int max_points) {
  max_free_ = max_free_poses;
  ld_ = 6 * max_free_poses;
  const std::size_t poses = static_cast<std::size_t>(max_poses), points = static_cast<std::size_t>(max_points);
  const std::size_t columns = static_cast<std::size_t>(ld_);
  column_ = arena.take<int>(poses);
  R_WC_ = arena.take<Mat3>(poses);
  old_pose_ = arena.take<BundlePose>(poses);
  old_rho_ = arena.take<Scalar>(points);
  H_ = arena.take<Scalar>(columns * columns);
  b_ = arena.take<Scalar>(columns);
  W_ = arena.take<Scalar>(points * columns);
  D_ = arena.take<Scalar>(points);
  g_ = arena.take<Scalar>(points);
  return arena.ok();
}

Scalar BundleAdjuster::rho_step(int point) const {
  Scalar g = g_[point];
  for (int a = 0; a < columns_; ++a) g -= W_[point * ld_ + a] * b_[a];
  return g / D_[point];
}

Scalar BundleAdjuster::cost(const Camera& camera, const AdjustOptions& options, const Bundle& bundle) const {
  Scalar sum = 0, weight;
  for (int c = 0; c < bundle.poses; ++c) R_WC_[c] = bundle.pose[c].q_WC.toRotationMatrix();
  for (int c = 0; c < bundle.poses; ++c) {
    const BundlePose& pose = bundle.pose[c];
    for (int i = 0; i < bundle.points && pose.pixel != nullptr; ++i) {
      const int host = host_of(bundle, i);
      if (!pose.pixel[i].seen || host == c) continue;
      Vec2 z;
      const Vec3 ray_W = R_WC_[host].lazyProduct(bundle.ray[i]);
      if (!project_bearing(camera, R_WC_[c], ray_W, bundle.pose[host].p_W - pose.p_W, bundle.rho[i], &z)) {
        sum += options.no_pixel_penalty;
        continue;
      }
      const Vec2 r = pose.pixel[i].pixel() - z;
      sum += huber_cost(r.squaredNorm() / (options.sigma_px * options.sigma_px), options.huber, &weight);
    }
  }
  for (int i = 0; i < bundle.points; ++i) {
    const Scalar e = (bundle.rho[i] - options.rho_mean) / options.rho_sigma;
    sum += e * e;
    if (bundle.rho[i] < Scalar(0)) sum += options.behind_weight * e * e;
  }
  return sum;
}

/// Adds one pixel to H_pp, b and to its point's row of W, D and g.
void BundleAdjuster::add_pixel(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, int pose,
                               int point) {
  const int host = host_of(bundle, point);
  const BundlePixel& measured = bundle.pose[pose].pixel[point];
  if (!measured.seen || host == pose) return;
  const Vec3 ray_W = R_WC_[host].lazyProduct(bundle.ray[point]);
  const Vec3 p_HC_W = bundle.pose[host].p_W - bundle.pose[pose].p_W;
  Vec2 z, J_rho;
  Mat26 J[2];  // with respect to the pose and to the host
  if (!project_bearing(camera, R_WC_[pose], ray_W, p_HC_W, bundle.rho[point], &z, &J[0], &J[1], &J_rho)) return;
  const Vec2 r = measured.pixel() - z;
  const Scalar information = Scalar(1) / (options.sigma_px * options.sigma_px);
  Scalar weight;
  huber_cost(r.squaredNorm() * information, options.huber, &weight);
  weight *= information;
  const int column[2] = {column_[pose], column_[host]};
  Scalar* w = W_ + point * ld_;
  for (int s = 0; s < 2; ++s) {
    if (column[s] < 0) continue;
    for (int a = 0; a < 6; ++a) {
      for (int e = 0; e <= a; ++e)
        H_[(column[s] + a) * ld_ + column[s] + e] += weight * (J[s](0, a) * J[s](0, e) + J[s](1, a) * J[s](1, e));
      b_[column[s] + a] += weight * (J[s](0, a) * r.x() + J[s](1, a) * r.y());
      w[column[s] + a] += weight * (J[s](0, a) * J_rho.x() + J[s](1, a) * J_rho.y());
    }
  }
  if (column[0] >= 0 && column[1] >= 0) {
    const int below = column[0] > column[1] ? 0 : 1;  // the block that lies lower in the triangle
    const Mat26 &J_row = J[below], &J_column = J[1 - below];
    for (int a = 0; a < 6; ++a)
      for (int e = 0; e < 6; ++e)
        H_[(column[below] + a) * ld_ + column[1 - below] + e] +=
            weight * (J_row(0, a) * J_column(0, e) + J_row(1, a) * J_column(1, e));
  }
  D_[point] += weight * J_rho.squaredNorm();
  g_[point] += weight * J_rho.dot(r);
}

/// H_ becomes S without its own damping, b_ its right side; W_, D_ (damped) and g_ as step() writes them.
void BundleAdjuster::linearise(const Camera& camera, const AdjustOptions& options, const Bundle& bundle,
                               Scalar damping) {
  columns_ = 0;
  for (int c = 0; c < bundle.poses; ++c) {
    R_WC_[c] = bundle.pose[c].q_WC.toRotationMatrix();
    column_[c] = bundle.pose[c].free ? columns_ : -1;
    if (bundle.pose[c].free) columns_ += 6;
  }
  PF_ASSERT(columns_ <= ld_);
  for (int i = 0; i < columns_; ++i) {
    for (int j = 0; j <= i; ++j) H_[i * ld_ + j] = Scalar(0);
    b_[i] = Scalar(0);
  }
  for (int i = 0; i < bundle.points; ++i) {
    Scalar* w = W_ + i * ld_;
    for (int j = 0; j < columns_; ++j) w[j] = Scalar(0);
    const Scalar prior = Scalar(1) / (options.rho_sigma * options.rho_sigma) *
                         (bundle.rho[i] < Scalar(0) ? Scalar(1) + options.behind_weight : Scalar(1));
    D_[i] = prior;
    g_[i] = prior * (options.rho_mean - bundle.rho[i]);
    for (int c = 0; c < bundle.poses; ++c)
      if (bundle.pose[c].pixel != nullptr) add_pixel(camera, options, bundle, c, i);
    D_[i] *= Scalar(1) + damping;
    for (int a = 0; a < columns_; ++a) {
      const Scalar t = w[a] / D_[i];
      for (int e = 0; e <= a; ++e) H_[a * ld_ + e] -= t * w[e];
      b_[a] -= t * g_[i];
    }
  }
}

bool BundleAdjuster::step(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping) {
  linearise(camera, options, bundle, damping);
  for (int a = 0; a < columns_; ++a) H_[a * ld_ + a] += damping * std::abs(H_[a * ld_ + a]) + kRegularisation;
  if (!factor_cholesky(H_, columns_, ld_)) return false;
  solve_cholesky(H_, columns_, ld_, b_);
  return true;
}

Scalar BundleAdjuster::adjust(const Camera& camera, const AdjustOptions& options, const Bundle& bundle) {
  Scalar before = cost(camera, options, bundle);
  Scalar damping = kFirstDamping;
  for (int round = 0; round < options.max_rounds; ++round) {
    std::copy(bundle.pose, bundle.pose + bundle.poses, old_pose_);
    std::copy(bundle.rho, bundle.rho + bundle.points, old_rho_);
    bool better = false;
    Scalar after = before;
    if (step(camera, options, bundle, damping)) {
      for (int c = 0; c < bundle.poses; ++c) {
        if (!bundle.pose[c].free) continue;
        const Scalar* dx = b_ + column_[c];
        BundlePose& pose = bundle.pose[c];
        pose.q_WC = exp_so3(Vec3(dx[0], dx[1], dx[2])) * pose.q_WC;
        pose.q_WC.normalize();
        pose.p_W += Vec3(dx[3], dx[4], dx[5]);
      }
      for (int i = 0; i < bundle.points; ++i) bundle.rho[i] += rho_step(i);
      after = cost(camera, options, bundle);
      better = after < before;
    }
    if (better) {
      const bool done = before - after < kSmallGain * before;
      before = after;
      damping = std::max(damping / kDampingDown, kMinDamping);
      if (done) break;
    } else {
      std::copy(old_pose_, old_pose_ + bundle.poses, bundle.pose);
      std::copy(old_rho_, old_rho_ + bundle.points, bundle.rho);
      damping *= kDampingUp;
      if (damping > kMaxDamping) break;
    }
  }
  return before;
}

/// S = L Lᵀ with the last pose's rows last: their covariance is (L_22 L_22ᵀ)⁻¹.
bool BundleAdjuster::last_pose_covariance(const Camera& camera, const AdjustOptions& options, const Bundle& bundle,
                                          Mat6* covariance) {
  linearise(camera, options, bundle, Scalar(0));
  if (columns_ == 0 || !factor_cholesky(H_, columns_, ld_)) return false;
  const Scalar* L = H_ + (columns_ - 6) * (ld_ + 1);
  for (int c = 0; c < 6; ++c) {
    Vec6 x = Vec6::Zero();
    x(c) = Scalar(1);
    solve_cholesky(L, 6, ld_, x.data());
    covariance->col(c) = x;
  }
  return true;
}

}  // namespace pf
