#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

/// The paper's filter, written down plainly and apart from the library: dense double matrices on the heap.
///
/// Frames as everywhere: W world, C camera; here a Jacobian is with respect to the state's own numbers (quaternion, angles,
/// coordinates), as the paper has it, and to no error state.
namespace pfsim::gee {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec4 = Eigen::Vector4d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Vec7 = Eigen::Matrix<double, 7, 1>;
using VecX = Eigen::VectorXd;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;
using Mat4 = Eigen::Matrix4d;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using MatX = Eigen::MatrixXd;

template <int M, int N>
using Mat = Eigen::Matrix<double, M, N>;

inline Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace pfsim::gee
