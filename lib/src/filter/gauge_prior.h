#pragma once

#include "filter/block_filter.h"
#include "model/state.h"

namespace pf {

class Archive;

/// Covariance of gauge directions that is kept apart from P (lib/docs/theory/float.md):
///
///   covariance of the state = P + N V N^T     N(x): gauge rows of the state (model/gauge.h); V: 7x7, translation, rotation, log scale
///
/// Pixels do not measure these directions (H N = 0), so updates do not change V, and N(x) follows the state as the transport of P does. P
/// then has only errors that few rows share, which float can distinguish from zero, and the prior depth of a new point does not constrain
/// the scale of all others.
class GaugePrior {
 public:
  using Matrix = Eigen::Matrix<Scalar, gauge::kDirections, gauge::kDirections>;

  bool any() const { return any_; }
  const Matrix& V() const { return V_; }
  void clear();
  /// Adds this variance to the log scale, independently of all else; pivot: the place in W that the scale does not move.
  void add_scale(Scalar variance, const Vec3& pivot = Vec3::Zero());
  /// Pose of the body (theta, p; row-major with leading dimension ld), on which nothing else depends yet: takes all of its covariance as
  /// one of W.
  void set_pose(const State& state, const Scalar* covariance, int ld);

  /// Adds N V N^T over the first `rows` rows of the body (rows x rows, row-major).
  void add_leading(const State& state, int rows, Scalar* covariance) const;
  /// J N V N^T J^T
  template <int kRows>
  Eigen::Matrix<Scalar, kRows, kRows> covariance_of(const State& state, const Rows& J) const {
    Eigen::Matrix<Scalar, kRows, gauge::kDirections> JN;
    PF_ASSERT(J.rows == kRows);
    project(state, J, JN.data());
    const Eigen::Matrix<Scalar, kRows, gauge::kDirections> JNV = JN.lazyProduct(V_);
    return JNV.lazyProduct(JN.transpose());
  }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// J N, column-major.
  static void project(const State& state, const Rows& J, Scalar* JN);

  Matrix V_ = Matrix::Zero();
  bool any_ = false;
};

}  // namespace pf
