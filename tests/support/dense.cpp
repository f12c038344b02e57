#include "support/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace pf {

Dense inverse_of(const Dense& A) { return A.inverse(); }
Dense solved(const Dense& A, const Dense& b) { return A.ldlt().solve(b); }
Dense lower_factor(const Dense& S) { return S.llt().matrixL(); }

Eigen::VectorXd eigenvalues_of(const Dense& A, Dense* vectors) {
  const Eigen::SelfAdjointEigenSolver<Dense> solver(
      A, vectors == nullptr ? Eigen::EigenvaluesOnly : Eigen::ComputeEigenvectors);
  if (vectors != nullptr) *vectors = solver.eigenvectors();
  return solver.eigenvalues();
}

double error_after_sim3(const std::vector<Eigen::Vector3d>& found, const std::vector<Eigen::Vector3d>& truth) {
  const Eigen::Index n = static_cast<Eigen::Index>(found.size());
  const Eigen::Map<const Eigen::Matrix3Xd> F(found[0].data(), 3, n), T(truth[0].data(), 3, n);
  const Eigen::Matrix4d S = Eigen::umeyama(F, T, true);
  const Eigen::Matrix3Xd moved = (S.topLeftCorner<3, 3>() * F).colwise() + Eigen::Vector3d(S.topRightCorner<3, 1>());
  return std::sqrt((moved - T).squaredNorm() / static_cast<double>(n));
}

}  // namespace pf
