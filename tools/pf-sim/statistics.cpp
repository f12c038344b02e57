#include "statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pfsim {
namespace {

/// Regularised lower incomplete gamma function P(a, x): the series below a + 1, the continued fraction above.
double lower_gamma(double a, double x) {
  if (x <= 0) return 0;
  const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && term > 1e-16 * sum; ++n) sum += term *= x / (a + n);
    return sum * scale;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int n = 1; n < 10000; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    const double step = c * d;
    h *= step;
    if (std::fabs(step - 1) < 1e-15) break;
  }
  return 1 - scale * h;
}

/// Lower Cholesky factor in place, n <= 7; false when A is not positive definite.
bool cholesky(double* A, int n) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = A[i * n + j];
      for (int k = 0; k < j; ++k) sum -= A[i * n + k] * A[j * n + k];
      if (i == j) {
        if (!(sum > 0)) return false;
        A[i * n + i] = std::sqrt(sum);
      } else {
        A[i * n + j] = sum / A[j * n + j];
      }
    }
  return true;
}

}  // namespace

double chi_square_quantile(double p, double degrees) {
  double low = 0, high = degrees + 10 * std::sqrt(2 * degrees) + 50;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (lower_gamma(0.5 * degrees, 0.5 * middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double normalised_error(const double* e, const double* P, int n, int ld, int first) {
  double L[49], sum = 0, y[7];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) L[i * n + j] = P[(first + i) * ld + first + j];
  if (!cholesky(L, n)) return -1;
  for (int i = 0; i < n; ++i) {
    y[i] = e[i];
    for (int k = 0; k < i; ++k) y[i] -= L[i * n + k] * y[k];
    y[i] /= L[i * n + i];
    sum += y[i] * y[i];
  }
  return sum;
}

double largest_ratio(const double* A, const double* B, int n, int ld) {
  double L[49], M[49];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      L[i * n + j] = A[i * ld + j];
      M[i * n + j] = B[i * ld + j];
    }
  if (!cholesky(L, n)) return std::numeric_limits<double>::quiet_NaN();
  // M = L^-1 B L^-T, one side after the other.
  for (int side = 0; side < 2; ++side) {
    for (int c = 0; c < n; ++c)
      for (int i = 0; i < n; ++i) {
        double sum = M[i * n + c];
        for (int k = 0; k < i; ++k) sum -= L[i * n + k] * M[k * n + c];
        M[i * n + c] = sum / L[i * n + i];
      }
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < i; ++j) std::swap(M[i * n + j], M[j * n + i]);
  }
  // Jacobi rotations until nothing is left off the diagonal.
  for (int sweep = 0; sweep < 60; ++sweep) {
    double off = 0;
    for (int p = 0; p < n; ++p)
      for (int q = p + 1; q < n; ++q) {
        const double apq = 0.5 * (M[p * n + q] + M[q * n + p]);
        off += apq * apq;
        if (apq == 0) continue;
        const double theta = 0.5 * std::atan2(2 * apq, M[q * n + q] - M[p * n + p]);
        const double c = std::cos(theta), s = std::sin(theta);
        for (int k = 0; k < n; ++k) {
          const double a = M[k * n + p], b = M[k * n + q];
          M[k * n + p] = c * a - s * b;
          M[k * n + q] = s * a + c * b;
        }
        for (int k = 0; k < n; ++k) {
          const double a = M[p * n + k], b = M[q * n + k];
          M[p * n + k] = c * a - s * b;
          M[q * n + k] = s * a + c * b;
        }
      }
    if (off < 1e-30) break;
  }
  double largest = M[0];
  for (int i = 1; i < n; ++i) largest = std::max(largest, M[i * n + i]);
  return largest;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace pfsim
