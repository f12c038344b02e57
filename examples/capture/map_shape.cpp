#include "map_shape.h"

#include <planefold/planefold_research.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "maths.h"

namespace pf::capture {

namespace {

constexpr size_t kGauge = 7;  ///< shift, turn, log scale
using Triangle = std::array<double, kGauge * kGauge>;

/// A = L Lᵀ in place. false: A is not positive.
bool factor(Triangle& a) {
  for (size_t j = 0; j < kGauge; ++j) {
    for (size_t i = j; i < kGauge; ++i) {
      double sum = a[i * kGauge + j];
      for (size_t k = 0; k < j; ++k) {
        sum -= a[i * kGauge + k] * a[j * kGauge + k];
      }
      if (i == j && !(sum > 0.0)) {
        return false;
      }
      a[i * kGauge + j] = i == j ? std::sqrt(sum) : sum / a[j * kGauge + j];
    }
  }
  return true;
}

/// Solves L y = b in place.
void solve(const Triangle& l, std::array<double, kGauge>& b) {
  for (size_t i = 0; i < kGauge; ++i) {
    for (size_t k = 0; k < i; ++k) {
      b[i] -= l[i * kGauge + k] * b[k];
    }
    b[i] /= l[i * kGauge + i];
  }
}

}  // namespace

std::vector<double> sigmas_in_map(const pf_slam_t* slam, const std::vector<pf_feature_t>& features) {
  std::vector<double> sigmas;
  pf_report_t report{};
  if (pf_get_report(slam, &report) < PF_OK || report.state_dim < 1) {
    return sigmas;
  }
  const auto dimension = static_cast<size_t>(report.state_dim);
  std::vector<double> scratch(dimension * (dimension + 8));
  Triangle information{};
  if (pf_get_gauge_information(slam, scratch.data(), scratch.size(), information.data()) != PF_OK) {
    return sigmas;
  }
  // Units differ: a diagonal of ones keeps the digits.
  std::array<double, kGauge> unit{};
  for (size_t i = 0; i < kGauge; ++i) {
    unit[i] = 1.0 / std::sqrt(information[i * kGauge + i]);
  }
  for (size_t i = 0; i < kGauge * kGauge; ++i) {
    information[i] *= unit[i / kGauge] * unit[i % kGauge];
  }
  if (!factor(information)) {
    return sigmas;
  }
  for (const pf_feature_t& feature : features) {
    const double* x = feature.p_W;
    // Row r of N is what shift, turn and scale do to coordinate r.
    std::array<double, kGauge> rows[3] = {
        {1, 0, 0, 0, x[2], -x[1], x[0]}, {0, 1, 0, -x[2], 0, x[0], x[1]}, {0, 0, 1, x[1], -x[0], 0, x[2]}};
    for (auto& row : rows) {
      for (size_t i = 0; i < kGauge; ++i) {
        row[i] *= unit[i];
      }
      solve(information, row);
    }
    double rest[9];
    for (size_t i = 0; i < 9; ++i) {
      const auto& a = rows[i / 3];
      const auto& b = rows[i % 3];
      double shared = 0.0;
      for (size_t k = 0; k < kGauge; ++k) {
        shared += a[k] * b[k];
      }
      rest[i] = feature.covariance[i] - shared;
    }
    sigmas.push_back(largest_sigma(rest));
  }
  return sigmas;
}

}  // namespace pf::capture
