#pragma once

#include <Eigen/Eigenvalues>
#include <vector>

#include "angles.h"

namespace pfsim::gee {

/// The plane through points by principal components: origin their mean, basis the eigenvectors of M^T M, M the points less
/// their mean, of the largest and the middle eigenvalue.   src Gee 2007, section 3.3
struct PlaneFit {
  Vec7 plane;                ///< p_o, theta_1, phi_1, theta_2, phi_2
  Vec3 normal;               ///< eigenvector of the smallest eigenvalue
  double lambda[3];          ///< ascending; lambda[0] is the sum of squares off the plane [m^2]
  std::vector<Mat<7, 3>> J;  ///< of the plane with respect to each point
};

/// dc_k/dm = sum over j != k of c_j ((c_k . r) c_j^T + (c_j . r) c_k^T) / (lambda_k - lambda_j), r = m less the mean.
///
/// The derivative of an eigenvector of A = sum of r r^T: dA = dm r^T + r dm^T, because the mean's own share sums to nothing.
/// c   eigenvectors in columns, with lambda; the k-th must stand alone.
/// src The eigenvectors' part of Gee 2007 (8); there by the derivative of the singular value decomposition
inline Mat3 eigenvector_jacobian(const Mat3& c, const double lambda[3], int k, const Vec3& r) {
  Mat3 J = Mat3::Zero();
  for (int j = 0; j < 3; ++j) {
    if (j == k) continue;
    const Vec3 cj = c.col(j), ck = c.col(k);
    J += cj * (ck.dot(r) * cj.transpose() + cj.dot(r) * ck.transpose()) / (lambda[k] - lambda[j]);
  }
  return J;
}

/// Fits at least three points; false when two eigenvalues coincide or a basis vector points at the pole of eq. 5.
/// src    Gee 2007 (8)
inline bool fit_plane(const std::vector<Vec3>& points, PlaneFit* fit) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& m : points) mean += m;
  mean /= static_cast<double>(points.size());
  Mat3 A = Mat3::Zero();
  for (const Vec3& m : points) A += (m - mean) * (m - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(A);
  Mat3 c = eigen.eigenvectors();
  for (int k = 0; k < 3; ++k) fit->lambda[k] = eigen.eigenvalues()(k);
  if (!(fit->lambda[2] - fit->lambda[1] > 1e-9) || !(fit->lambda[1] - fit->lambda[0] > 1e-9)) return false;
  if (c.col(2).cross(c.col(1)).dot(c.col(0)) < 0) c.col(0) *= -1;
  fit->normal = c.col(0);
  Mat<2, 3> J_angles[2];
  fit->plane.head<3>() = mean;
  for (int b = 0; b < 2; ++b) {
    const Vec3 basis = c.col(2 - b);
    if (!(std::abs(basis.y()) < 1 - 1e-9)) return false;
    fit->plane.segment<2>(3 + 2 * b) = angles_of(basis, &J_angles[b]);
  }
  fit->J.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 r = points[i] - mean;
    fit->J[i].topRows<3>() = Mat3::Identity() / static_cast<double>(points.size());
    for (int b = 0; b < 2; ++b)
      fit->J[i].block<2, 3>(3 + 2 * b, 0) = J_angles[b] * eigenvector_jacobian(c, fit->lambda, 2 - b, r);
  }
  return true;
}

}  // namespace pfsim::gee
