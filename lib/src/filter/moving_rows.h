#pragma once

#include <cmath>

#include "filter/moving_start.h"

/// Rows of the least squares of a start while moving, and their covariance (filter/moving_start.h).

namespace pf::moving_rows {

inline constexpr int kMaxSums = 32;
inline constexpr int kMaxRows = kMaxSums + 2;  ///< and two of a rest

/// The sums up to one pose; or their means over neighbours; or the same factors in a row of a rest.
struct Sum {
  Scalar t, t2;     ///< t2: of t^2
  Scalar variance;  ///< of the position
  Vec3 p, m, S;
  Mat3 B;

  static Sum zero() { return {0, 0, 0, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Mat3::Zero()}; }
};

/// Those of all poses, and behind them those of a rest: of the force, and of the velocity.
struct Sums {
  Sum sum[kMaxRows];
  int poses = 0, count = 0;
  Scalar T = 0;  ///< of all poses

  /// Position that a rate of one, which tilts gravity by t - T / 2, adds to row k.
  Scalar turned(int k) const {
    const Scalar t = sum[k].t;
    if (k < poses) return t * t * (t / 6 - T / 4);
    return k == poses ? -T / 2 : Scalar(0);
  }
  void add(const MovingRest& rest) {
    sum[count] = sum[count + 1] = Sum::zero();
    sum[count].t2 = 2;
    sum[count].S = rest.f_W;
    sum[count].B = rest.f_b;
    sum[count + 1].t = 1;
    count += 2;
  }
};

/// Cholesky factor of the covariance of the rows along an axis, row-major.
struct Whitener {
  Scalar L[kMaxRows][kMaxRows];

  bool factor(const Sums& sums, const MovingStartNoise& noise, Scalar sigma_0, Scalar u) {
    const Scalar q_d = noise.drift, q_a = u * noise.accel_density;
    const Scalar q_r = u * (noise.gravity * noise.tilt_density), q_t = u * (noise.gravity * noise.turn);
    for (int j = 0; j < sums.count; ++j)
      for (int k = 0; k <= j; ++k) {
        Scalar C = 0;
        if (j < sums.poses) {
          const Scalar t = sums.sum[k].t, v = sums.sum[j].t;  // t <= v
          const Scalar G2 = t * t * (3 * v - t) / 6;
          const Scalar G3 = t * t * t * (t * t - 5 * t * v + 10 * v * v) / 120;
          C = sigma_0 * sigma_0 + q_d * q_d * t + q_a * q_a * G2 + q_r * q_r * G3;
        }
        C += q_t * q_t * sums.turned(k) * sums.turned(j);
        if (j == k) C += j < sums.poses ? sums.sum[k].variance : rest_variance(sums, *noise.rest, k, u);
        for (int i = 0; i < k; ++i) C -= L[j][i] * L[k][i];
        if (j == k && !(C > Scalar(0))) return false;
        L[j][k] = j == k ? std::sqrt(C) : C / L[k][k];
      }
    return true;
  }
  static Scalar rest_variance(const Sums& sums, const MovingRest& rest, int k, Scalar u) {
    const Scalar sigma = k == sums.poses ? u * rest.sigma_force : rest.sigma_speed;
    return sigma * sigma;
  }
  /// x <- L^-1 x of n numbers that are `stride` apart.
  void apply(Scalar* x, int n, int stride) const {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < j; ++i) x[j * stride] -= L[j][i] * x[i * stride];
      x[j * stride] /= L[j][j];
    }
  }
};

}  // namespace pf::moving_rows
