#pragma once

// A small map with one observation of each of its features, and ways to compare what a filter holds.

#include "support/filter_cases.h"
#include "support/test_cameras.h"

namespace pf {

inline constexpr double kExact = 1e-9;  // relative to standard deviations

inline double largest(const Dense& A) { return A.cwiseAbs().maxCoeff(); }

/// Largest difference of two covariances, each entry against its standard deviations.
inline double difference(const Dense& A, const Dense& B) {
  double worst = 0;
  for (int i = 0; i < A.rows(); ++i)
    for (int j = 0; j < A.cols(); ++j)
      worst = std::max(worst, std::fabs(A(i, j) - B(i, j)) / std::sqrt(B(i, i) * B(j, j)));
  return worst;
}

struct Scene {
  TestFilter filter;
  std::vector<int> slots;
  std::vector<PixelMeasurement> observations;

  Scene(SeededRandom& random, bool keep_gauge) : filter(keep_gauge) {
    slots = fill_map(random, filter, 5, 6);
    filter.set_P(random_covariance(random, filter.dim(), 0.02));
    for (const int slot : slots) {
      PixelMeasurement o;
      TEST_ASSERT_TRUE(filter->predict_pixel(pinhole_camera(), slot, &o));
      o.measured = o.predicted + random.normals<2>(3);
      const double a = random.uniform(0.3, 1), b = random.uniform(0.3, 1);
      Mat2 R;
      R << static_cast<Scalar>(a), static_cast<Scalar>(0.2 * a * b), static_cast<Scalar>(0.2 * a * b),
          static_cast<Scalar>(b);
      o.set_noise(R);
      observations.push_back(o);
    }
  }
  int count() const { return static_cast<int>(observations.size()); }
};

/// Everything that a filter holds of its state, for comparison bit for bit.
inline std::vector<Scalar> bits_of(const TestFilter& filter_in) {
  TestFilter& filter = const_cast<TestFilter&>(filter_in);
  const State& state = filter->state();
  std::vector<Scalar> all;
  for (int i = 0; i < filter.dim(); ++i)
    for (int j = 0; j <= i; ++j) all.push_back(filter->covariance()(i, j));
  const Body& b = state.body;
  for (const Vec3& v : {b.p_W, b.v_W, b.w_C, Vec3(b.q_WC.vec())}) all.insert(all.end(), v.data(), v.data() + 3);
  for (int s = 0; s < state.slots; ++s) all.insert(all.end(), state.block[s].value, state.block[s].value + 5);
  return all;
}

}  // namespace pf
