#pragma once

/// The only include of Eigen: small fixed sizes, our assertions, no allocation.

#include "base/assert.h"
#include "base/scalar.h"

#define eigen_assert(condition) PF_ASSERT(condition)
#ifndef NDEBUG
#define EIGEN_INITIALIZE_MATRICES_BY_NAN
#endif
#define EIGEN_MAX_STATIC_ALIGN_BYTES 0
#define EIGEN_MPL2_ONLY

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#include <Eigen/Core>
#include <Eigen/Geometry>
#pragma GCC diagnostic pop

namespace pf {

using Vec2 = Eigen::Matrix<Scalar, 2, 1>;
using Vec3 = Eigen::Matrix<Scalar, 3, 1>;
using Vec4 = Eigen::Matrix<Scalar, 4, 1>;
using Vec6 = Eigen::Matrix<Scalar, 6, 1>;
using Mat2 = Eigen::Matrix<Scalar, 2, 2>;
using Mat3 = Eigen::Matrix<Scalar, 3, 3>;
using Mat6 = Eigen::Matrix<Scalar, 6, 6>;
using Mat23 = Eigen::Matrix<Scalar, 2, 3>;
using Mat26 = Eigen::Matrix<Scalar, 2, 6>;
using Mat32 = Eigen::Matrix<Scalar, 3, 2>;
using Quat = Eigen::Quaternion<Scalar>;

}  // namespace pf
