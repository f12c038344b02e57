// The peer of the bundle adjuster: Ceres with analytic Jacobians, points eliminated first (DENSE_SCHUR), one thread. A module of its own,
// because Ceres brings a BLAS that must not be loaded before the covariance suite has chosen its core type.
#include <ceres/ceres.h>

#include <cmath>
#include <exception>
#include <memory>

#include "../adjust_peer.h"

namespace {

using Row = Eigen::Matrix<double, 1, 3>;
using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

/// (w x y z, p), moved by (theta, p) with the rotation on the world side. Residuals give their derivatives by (theta, p) in the first six
/// of seven columns, and this one's Jacobian picks them.
class PoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* sum) const override {
    const Vector3 theta(delta[0], delta[1], delta[2]);
    const double angle = theta.norm(), k = angle < 1e-6 ? 0.5 : std::sin(angle / 2) / angle;
    const Eigen::Quaterniond turn(std::cos(angle / 2), k * theta.x(), k * theta.y(), k * theta.z());
    const Eigen::Quaterniond q = (turn * Eigen::Quaterniond(x[0], x[1], x[2], x[3])).normalized();
    sum[0] = q.w(), sum[1] = q.x(), sum[2] = q.y(), sum[3] = q.z();
    for (int i = 0; i < 3; ++i) sum[4 + i] = x[4 + i] + delta[3 + i];
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> J(jacobian);
    J.setIdentity();
    return true;
  }
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }
};

/// A pixel by pose, host and inverse depth; residuals in standard deviations.
class Pixel : public ceres::SizedCostFunction<2, 7, 7, 1> {
 public:
  Pixel(const pf_bench_bundle& b, const double* ray, const double* z)
      : fx_(b.fx / b.sigma_px), fy_(b.fy / b.sigma_px), ray_(ray[0], ray[1], ray[2]) {
    z_[0] = (z[0] - b.cx) / b.sigma_px;
    z_[1] = (z[1] - b.cy) / b.sigma_px;
  }

  bool Evaluate(double const* const* x, double* r, double** J) const override {
    const double *pose = x[0], *host = x[1], rho = x[2][0];
    const Matrix3 R_CW = Eigen::Quaterniond(pose[0], pose[1], pose[2], pose[3]).toRotationMatrix().transpose();
    const Vector3 ray_W = Eigen::Quaterniond(host[0], host[1], host[2], host[3]).toRotationMatrix() * ray_;
    const Vector3 p_HC(host[4] - pose[4], host[5] - pose[5], host[6] - pose[6]);
    const Vector3 d = ray_W + rho * p_HC, d_C = R_CW * d;
    if (!(d_C.z() > 1e-9)) return false;
    const double w = 1 / d_C.z(), mx = d_C.x() * w, my = d_C.y() * w;
    r[0] = fx_ * mx - z_[0];
    r[1] = fy_ * my - z_[1];
    if (J == nullptr) return true;
    const Row row[2] = {fx_ * w * (R_CW.row(0) - mx * R_CW.row(2)), fy_ * w * (R_CW.row(1) - my * R_CW.row(2))};
    for (int k = 0; k < 2; ++k) {
      if (J[0] != nullptr) {
        Eigen::Map<Eigen::Matrix<double, 1, 7>> to(J[0] + 7 * k);
        to << row[k].cross(d.transpose()), -rho * row[k], 0;
      }
      if (J[1] != nullptr) {
        Eigen::Map<Eigen::Matrix<double, 1, 7>> to(J[1] + 7 * k);
        to << ray_W.transpose().cross(row[k]), rho * row[k], 0;
      }
      if (J[2] != nullptr) J[2][k] = row[k].dot(p_HC);
    }
    return true;
  }

 private:
  double fx_, fy_, z_[2];
  Vector3 ray_;
};

class RhoPrior : public ceres::SizedCostFunction<1, 1> {
 public:
  RhoPrior(double mean, double sigma) : mean_(mean), sigma_(sigma) {}
  bool Evaluate(double const* const* x, double* r, double** J) const override {
    r[0] = (x[0][0] - mean_) / sigma_;
    if (J != nullptr && J[0] != nullptr) J[0][0] = 1 / sigma_;
    return true;
  }

 private:
  double mean_, sigma_;
};

}  // namespace

extern "C" {

const char* pf_bench_adjust_name() { return "Ceres " CERES_VERSION_STRING " DENSE_SCHUR"; }

/// False when Ceres refused. Pose and rho are adjusted in place.
bool pf_bench_adjust(const pf_bench_bundle* b, pf_bench_adjusted* out) {
  try {
    ceres::Problem::Options ownership;
    ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    PoseManifold manifold;
    ceres::HuberLoss loss(b->huber);
    ceres::Problem problem(ownership);
    auto* ordering = new ceres::ParameterBlockOrdering;
    for (int c = 0; c < b->poses; ++c) {
      double* pose = b->pose + 7 * c;
      problem.AddParameterBlock(pose, 7, &manifold);
      if (b->free[c] == 0) problem.SetParameterBlockConstant(pose);
      ordering->AddElementToGroup(pose, 1);
    }
    for (int i = 0; i < b->points; ++i) {
      problem.AddParameterBlock(b->rho + i, 1);
      ordering->AddElementToGroup(b->rho + i, 0);
      problem.AddResidualBlock(new RhoPrior(b->rho_mean, b->rho_sigma), nullptr, b->rho + i);
      for (int c = 0; c < b->poses; ++c) {
        const int at = c * b->points + i;
        if (b->seen[at] == 0 || b->host[i] == c) continue;
        problem.AddResidualBlock(new Pixel(*b, b->ray + 3 * i, b->pixel + 2 * at), &loss, b->pose + 7 * c,
                                 b->pose + 7 * b->host[i], b->rho + i);
      }
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering.reset(ordering);
    options.num_threads = 1;
    options.max_num_iterations = b->max_rounds;
    options.function_tolerance = b->small_gain;
    options.gradient_tolerance = 0;
    options.parameter_tolerance = 0;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable()) return false;
    out->cost = 2 * summary.final_cost;
    out->us = 1e6 * summary.minimizer_time_in_seconds;
    out->prepare_us = 1e6 * summary.preprocessor_time_in_seconds;
    out->rounds = static_cast<int>(summary.iterations.size()) - 1;
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // extern "C"
