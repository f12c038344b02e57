#pragma once

// Random states for the tests of the filter, a filter with memory of its own, and dense views of what it holds.

#include <cstring>
#include <vector>

#include "filter/filter.h"
#include "filter/gauge_information.h"
#include "filter/state_rows.h"
#include "geometry/so3.h"
#include "support/dense.h"
#include "support/seeded_random.h"
#include "support/textured_images.h"
#include "unity.h"

namespace pf {

inline Quat random_turn(SeededRandom& random, double sigma) { return exp_so3(random.normals<3>(sigma)); }

inline Body random_body(SeededRandom& random) {
  Body body;
  body.q_WC = random_turn(random, 1.5);
  body.p_W = random.normals<3>(1);
  body.v_W = random.normals<3>(0.5);
  body.w_C = random.normals<3>(0.7);
  return body;
}

/// A point in W that a body sees well inside the picture of every test camera, 1 to 4 m away.
inline Vec3 point_in_view(SeededRandom& random, const Body& body) {
  const Scalar z = static_cast<Scalar>(random.uniform(1, 4));
  const Vec3 p_C(z * static_cast<Scalar>(random.uniform(-0.4, 0.4)), z * static_cast<Scalar>(random.uniform(-0.4, 0.4)),
                 z);
  return body.p_W + body.q_WC * p_C;
}

/// Inverse depth of a point in W as seen from o_W, with the tangent basis turned by chance.
inline InverseDepth inverse_depth_of(SeededRandom& random, const Vec3& p_W, const Vec3& o_W) {
  const Vec3 d = p_W - o_W;
  InverseDepth feature;
  const Vec3 roll(0, 0, static_cast<Scalar>(random.uniform(-3, 3)));
  feature.q_b = turn_z_to(d.normalized()) * exp_so3(roll);
  feature.q_b.normalize();
  feature.rho = Scalar(1) / d.norm();
  return feature;
}

/// Error (theta, p) on a body, and (e_1, e_2, e_rho) on an inverse depth, as State says.
inline Body moved(Body body, const Vec6& e) {
  body.q_WC = exp_so3(e.head<3>()) * body.q_WC;
  body.p_W += e.tail<3>();
  return body;
}

inline InverseDepth moved(InverseDepth feature, const Vec3& e) {
  const Mat3 R = feature.q_b.toRotationMatrix();
  feature.q_b = exp_so3(R.col(1) * e.x() - R.col(0) * e.y()) * feature.q_b;
  feature.rho += e.z();
  return feature;
}

/// Rows of the constant-velocity body.
inline constexpr int kBodyRows = 12, kVelocityRow = 6, kAngularVelocityRow = 9;

class TestFilter {
 public:
  explicit TestFilter(bool keep_gauge, const BodyLayout& layout = BodyLayout::with_constant_velocity(),
                      int state_dim = 160, int features = 40) {
    TEST_ASSERT_TRUE(filter_.layout(*arena_, {state_dim, features, 40, 6}));
    filter_.init(select_kernels_of_tests(), layout, keep_gauge);
  }
  Filter* operator->() { return &filter_; }
  Filter& operator*() { return filter_; }
  const Filter& operator*() const { return filter_; }
  int dim() const { return filter_.dim(); }
  int held_dim() const { return filter_.blocks().held_dim(); }
  /// First row of a block in the covariance.
  int first(int slot) const { return filter_.first_row(slot); }
  /// Moves the state by an error, and the covariance not at all.
  void move(const Scalar* dx) { apply_error(const_cast<State&>(filter_.state()), filter_.blocks(), dx); }
  void set_unobservable(gauge::Set set) { const_cast<State&>(filter_.state()).unobservable = set; }

  /// The whole covariance, dense.
  Dense P() const {
    Dense out(dim(), dim());
    for (int i = 0; i < dim(); ++i)
      for (int j = 0; j < dim(); ++j) out(i, j) = static_cast<double>(filter_.covariance()(i, j));
    return out;
  }
  void set_P(const Dense& P) {
    Triangle triangle = filter_.covariance();  // the same memory
    for (int i = 0; i < dim(); ++i)
      for (int j = 0; j <= i; ++j) triangle.set(i, j, static_cast<Scalar>(P(i, j)));
  }

  /// The unobservable directions at the state as it is: n x 7, translation, turn, log scale.
  Dense gauge() const {
    const int n = dim();
    Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows(7, n);
    rows.setZero();
    add_gauge_rows(filter_.state(), filter_.blocks(), Scalar(1), rows.data(), rows.data() + 3 * n, rows.data() + 6 * n,
                   n);
    const Dense N = rows.transpose().cast<double>();
    return N;
  }
  /// What P says of them: N^T P^-1 N, 7 x 7.
  Dense gauge_information() const {
    std::vector<double> scratch(static_cast<std::size_t>(dim() * (dim() + 8)));
    double out[49];
    TEST_ASSERT_TRUE(pf::gauge_information(filter_, scratch.data(), out));
    return Eigen::Map<const Eigen::Matrix<double, 7, 7, Eigen::RowMajor>>(out);
  }

 private:
  static const Kernels* select_kernels_of_tests() { return &reference_kernels(); }

  TestArena arena_;
  Filter filter_;
};

/// Rows of one measurement over the whole state.
inline Dense dense_rows(const Filter& filter, const Rows& rows) {
  Dense H = Dense::Zero(rows.rows, filter.dim());
  int column[SparseRows::kMaxColumns];
  const int columns = filter.blocks().columns(rows, column);
  for (int a = 0; a < rows.rows; ++a)
    for (int c = 0; c < columns; ++c) H(a, column[c]) = static_cast<double>(rows.h[a * columns + c]);
  return H;
}

/// Positive definite, standard deviations of about sigma.
inline Dense random_covariance(SeededRandom& random, int n, double sigma) {
  Dense A(n, n + 4);
  for (int i = 0; i < A.rows(); ++i)
    for (int j = 0; j < A.cols(); ++j) A(i, j) = random.normal();
  return sigma * sigma / n * (A * A.transpose());
}

/// Map of `points` 3-D points and `inverse` inverse-depth ones on two anchors, all in view of a random body. Slots of the features.
inline std::vector<int> fill_map(SeededRandom& random, TestFilter& filter, int points, int inverse) {
  const Body body = random_body(random);
  filter->set_mean(body);
  std::vector<int> slots;
  for (int i = 0; i < points; ++i) slots.push_back(filter->add_point(point_in_view(random, body), Mat3::Identity()));
  for (int k = 0; k < 2 && inverse > 0; ++k) {
    Body begun = body;
    begun.p_W += random.normals<3>(0.2);
    filter->set_mean(begun);
    const int anchor = filter->add_anchor();
    for (int i = k; i < inverse; i += 2) {
      const Vec3 d = point_in_view(random, body) - begun.p_W;
      slots.push_back(filter->add_inverse_depth(anchor, begun.q_WC.conjugate() * d.normalized(), Mat32::Zero(),
                                                Mat2::Zero(), Scalar(1) / d.norm(), Scalar(1)));
    }
    filter->set_mean(body);
  }
  return slots;
}

}  // namespace pf
