#include "filter/gauge_information.h"

#include <cmath>

namespace pf {
namespace {

constexpr int kDirections = 7;
constexpr double kTolerance = sizeof(Scalar) == 8 ? 1e-10 : 1e-4;  ///< of a pivot, relative to its variance

/// The seven directions as columns of N (n x 8, the last column unused), in double.
void directions(const State& state, const BlockFilter& blocks, double* N) {
  for (int i = 0; i < blocks.dim() * 8; ++i) N[i] = 0.0;
  const auto three = [&](int first, const Vec3& a, bool shifts) {
    const double x = static_cast<double>(a.x()), y = static_cast<double>(a.y()), z = static_cast<double>(a.z());
    const double turn[3][3] = {{0, z, -y}, {-z, 0, x}, {y, -x, 0}};  // -[a]x
    for (int i = 0; i < 3; ++i) {
      if (shifts) N[(first + i) * 8 + i] = 1.0;
      for (int j = 0; j < 3; ++j) N[(first + i) * 8 + 3 + j] = turn[i][j];
      N[(first + i) * 8 + 6] = static_cast<double>(a[i]);
    }
  };
  for (int i = 0; i < 3; ++i) N[(Body::kTheta + i) * 8 + 3 + i] = 1.0;
  three(Body::kPosition, state.body.p_W, true);
  if (state.layout.has(BodyPart::kVelocity)) three(state.layout.row(BodyPart::kVelocity), state.body.v_W, false);
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    if (block.size == 0) continue;
    const GaugeRows rows = gauge_rows(state, block);
    for (int i = 0; i < block.size; ++i)
      for (int d = 0; d < kDirections; ++d) N[(blocks.first(s) + i) * 8 + d] = static_cast<double>(rows(i, d));
  }
}

}  // namespace

bool gauge_information(const Filter& filter, double* scratch, double information[49]) {
  const int n = filter.dim();
  double* L = scratch;
  double* N = scratch + static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) L[i * n + j] = static_cast<double>(filter.covariance()(i, j));
  directions(filter.state(), filter.blocks(), N);
  for (int i = 0; i < n; ++i) {
    const double before = L[i * n + i];
    for (int j = 0; j <= i; ++j) {
      double sum = L[i * n + j];
      for (int k = 0; k < j; ++k) sum -= L[i * n + k] * L[j * n + k];
      L[i * n + j] = j < i ? (L[j * n + j] > 0 ? sum / L[j * n + j] : 0.0) : sum;
    }
    // A row that others determine (a new anchor is the body's position) says nothing new; one below zero is no covariance.
    const double pivot = L[i * n + i];
    if (!(pivot > -kTolerance * before) || !(before > 0)) return false;
    L[i * n + i] = pivot > kTolerance * before ? std::sqrt(pivot) : 0.0;
    for (int c = 0; c < kDirections; ++c) {  // N <- L^-1 N, row by row
      double sum = N[i * 8 + c];
      for (int k = 0; k < i; ++k) sum -= L[i * n + k] * N[k * 8 + c];
      N[i * 8 + c] = L[i * n + i] > 0 ? sum / L[i * n + i] : 0.0;
    }
  }
  for (int a = 0; a < kDirections; ++a)
    for (int b = 0; b < kDirections; ++b) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += N[i * 8 + a] * N[i * 8 + b];
      information[a * kDirections + b] = sum;
    }
  return true;
}

}  // namespace pf
