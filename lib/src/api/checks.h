#pragma once

#include <cmath>

#include "base/eigen.h"
#include "geometry/small_cholesky.h"

/// Checks of numbers that the caller passed in.

namespace pf {

inline bool finite(const double* values, int count) {
  for (int i = 0; i < count; ++i)
    if (!(values[i] - values[i] == 0.0)) return false;
  return true;
}

inline Vec3 vec3(const double* v) {
  return Vec3(static_cast<Scalar>(v[0]), static_cast<Scalar>(v[1]), static_cast<Scalar>(v[2]));
}

/// Larger distances, speeds and variances are rejected: their squares would leave the range of float.
inline constexpr double kMaxMetres = 1e6;  // also [m/s]
inline constexpr double kMaxRate = 1e4;    // [rad/s]
inline constexpr double kMaxVariance = 1e12;
/// Smaller standard deviations are rejected: their information, the inverse square, leaves float no digits for other numbers.
inline constexpr double kMinSigma = 1e-9;  // [m] or [rad], and their rates

inline bool within(const double* v, int n, double max) {
  for (int i = 0; i < n; ++i)
    if (!(std::fabs(v[i]) <= max)) return false;
  return true;
}

/// Unit length, within what is typed by hand; normalised.
inline bool quaternion_from(const double* q, Quat* out) {
  const double norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(norm2 > 0.98 && norm2 < 1.02)) return false;
  *out =
      Quat(static_cast<Scalar>(q[0]), static_cast<Scalar>(q[1]), static_cast<Scalar>(q[2]), static_cast<Scalar>(q[3]));
  out->normalize();
  return true;
}

inline constexpr int kMaxCovariance = 10;  ///< rows of one that crosses the API

/// Whether the correlations of P have no eigenvalue below -rounding; rows of what is exactly known are zero. n <= kMaxCovariance.
inline bool is_semidefinite(const double* P, int n, double rounding) {
  double C[kMaxCovariance * kMaxCovariance];  // correlations, so that radians and metres have the same weight
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      const double scale = std::sqrt(P[i * n + i]) * std::sqrt(P[j * n + j]);
      C[i * n + j] = scale > 0.0 ? P[i * n + j] / scale : 0.0;
    }
    C[i * n + i] = 1.0 + rounding;
  }
  return factor_cholesky(C, n, n);
}

/// Symmetric to rounding, with standard deviations of kMinSigma at least, Cauchy-Schwarz between any two, and semidefinite.
inline bool is_covariance(const double* P, int n) {
  for (int i = 0; i < n; ++i) {
    if (!(P[i * n + i] >= kMinSigma * kMinSigma && P[i * n + i] <= kMaxVariance)) return false;
    for (int j = 0; j < i; ++j) {
      const double scale = std::sqrt(P[i * n + i]) * std::sqrt(P[j * n + j]);
      if (std::fabs(P[i * n + j] - P[j * n + i]) > 1e-9 * scale) return false;
      if (std::fabs(P[i * n + j]) > scale * (1.0 + 1e-9)) return false;
    }
  }
  return is_semidefinite(P, n, 1e-9);
}

}  // namespace pf
