#pragma once

#include <cmath>

#include "geometry/similarity.h"
#include "geometry/so3.h"

/// Errors (theta, x, ln s) of a similarity about a place c, in double, since sums of many are subtracted from each other:
///
///   p -> p + theta x (p - c) + x + ln s (p - c)

namespace pf {

using SimilarityError = Eigen::Matrix<double, 7, 1>;
using SimilarityCovariance = Eigen::Matrix<double, 7, 7>;

/// Takes an error about a to one about b, of which c = b - a:   x + theta x c + ln s c.
inline SimilarityCovariance similarity_error_at(const Vec3& c) {
  const Eigen::Vector3d d = c.cast<double>();
  SimilarityCovariance J = SimilarityCovariance::Identity();
  J.block<3, 3>(3, 0) << 0, d.z(), -d.y(), -d.z(), 0, d.x(), d.y(), -d.x(), 0;
  J.block<3, 1>(3, 6) = d;
  return J;
}

/// The covariance of an error about the origin as that about c, and back with -c.
inline SimilarityCovariance similarity_covariance_at(const Vec3& c, const SimilarityCovariance& at_origin) {
  const SimilarityCovariance J = similarity_error_at(c);
  return J.lazyProduct(at_origin).lazyProduct(J.transpose());
}

/// Of an error about the origin of a world that T moves:
///
///   theta -> R theta,   x about the origin -> s R x - theta' x t - ln s t
inline SimilarityCovariance moved_covariance(const Similarity& T, const SimilarityCovariance& at_origin) {
  SimilarityCovariance A = SimilarityCovariance::Identity();
  const Eigen::Matrix3d R = T.q.toRotationMatrix().cast<double>();
  A.block<3, 3>(0, 0) = R;
  A.block<3, 3>(3, 3) = static_cast<double>(T.s) * R;
  const SimilarityCovariance J = similarity_error_at(-T.t) * A;
  return J.lazyProduct(at_origin).lazyProduct(J.transpose());
}

/// The similarity of an error about c.
inline Similarity similarity_of(const SimilarityError& error, const Vec3& c) {
  Similarity T;
  T.q = exp_so3(error.head<3>().cast<Scalar>());
  T.s = static_cast<Scalar>(std::exp(error(6)));
  T.t = c + error.segment<3>(3).cast<Scalar>() - T.s * (T.q * c);
  return T;
}

}  // namespace pf
