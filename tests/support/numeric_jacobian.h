#pragma once

// Any Jacobian against central differences, in double and in float.
//
//   auto f = [&](const Vec3& d) { Vec2 z; project(camera, p + d, &z); return z; };   d: the error state, about zero
//   check_jacobian<2, 3>(J_z_p, f, "J_z_p");
//
// Two step sizes are combined (Richardson), so that the error is of fourth order in the step.

#include <cmath>
#include <cstdio>

#include "base/eigen.h"
#include "unity.h"

namespace pf {

inline constexpr bool kNumericJacobianIsFloat = sizeof(Scalar) == 4;
inline constexpr Scalar kNumericJacobianStep = kNumericJacobianIsFloat ? Scalar(2e-2) : Scalar(5e-4);
inline constexpr Scalar kNumericJacobianTolerance = kNumericJacobianIsFloat ? Scalar(2e-3) : Scalar(1e-8);

/// df/dd at d = 0, (4 D(h/2) - D(h)) / 3 with D the central difference. f: Matrix<Scalar, N, 1> -> Matrix<Scalar, M, 1>.
template <int M, int N, typename F>
Eigen::Matrix<Scalar, M, N> numeric_jacobian(F f, Scalar step) {
  using Input = Eigen::Matrix<Scalar, N, 1>;
  using Output = Eigen::Matrix<Scalar, M, 1>;
  Eigen::Matrix<Scalar, M, N> J;
  for (int i = 0; i < N; ++i) {
    Output slope[2];
    for (int k = 0; k < 2; ++k) {
      const Scalar h = k == 0 ? step : step / 2;
      Input plus = Input::Zero(), minus = Input::Zero();
      plus(i) = h;
      minus(i) = -h;
      const Output high = f(plus), low = f(minus);
      slope[k] = (high - low) / (2 * h);
    }
    J.col(i) = (4 * slope[1] - slope[0]) / 3;
  }
  return J;
}

/// Fails the running test when J differs from the numeric one by more than tolerance x (1 + largest entry + largest f).
/// unit scales the step: about the length over which f bends (0.1 where f bends within 0.1).
template <int M, int N, typename F>
void check_jacobian(const Eigen::Matrix<Scalar, M, N>& J, F f, const char* name, Scalar unit = 1,
                    Scalar tolerance = kNumericJacobianTolerance) {
  const Eigen::Matrix<Scalar, M, N> numeric = numeric_jacobian<M, N>(f, kNumericJacobianStep * unit);
  const Eigen::Matrix<Scalar, M, 1> value = f(Eigen::Matrix<Scalar, N, 1>(Eigen::Matrix<Scalar, N, 1>::Zero()));
  const Scalar size = 1 + numeric.cwiseAbs().maxCoeff() + value.cwiseAbs().maxCoeff();
  for (int r = 0; r < M; ++r) {
    for (int c = 0; c < N; ++c) {
      const Scalar error = std::abs(J(r, c) - numeric(r, c));
      if (error <= tolerance * size) continue;
      char text[160];
      std::snprintf(text, sizeof text, "%s(%d, %d) is %.9g, numerically %.9g", name, r, c, static_cast<double>(J(r, c)),
                    static_cast<double>(numeric(r, c)));
      TEST_FAIL_MESSAGE(text);
    }
  }
}

}  // namespace pf
