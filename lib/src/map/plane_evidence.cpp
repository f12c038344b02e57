#include "map/plane_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pf {
namespace {

constexpr Scalar kNone = -std::numeric_limits<Scalar>::infinity();

/// L of V = L L^T, a row after the other; what it solves goes along: x = L^-1 (u, v, 1, d).
class Whitening {
 public:
  /// Row i of V, its lower half. False where V is no covariance.
  bool add(int i, const Scalar* row, const JointDistances& points) {
    for (int j = 0; j <= i; ++j) {
      Scalar sum = row[j];
      for (int k = 0; k < j; ++k) sum -= L_[i][k] * L_[j][k];
      if (j < i) {
        L_[i][j] = sum / L_[j][j];
        continue;
      }
      if (!(sum > Scalar(0))) return false;
      L_[i][i] = std::sqrt(sum);
      log_det_ += std::log(sum);
    }
    Vec3 a(points.uv[i].x(), points.uv[i].y(), Scalar(1));
    Scalar d = points.d[i];
    for (int k = 0; k < i; ++k) {
      a -= L_[i][k] * a_[k];
      d -= L_[i][k] * d_[k];
    }
    a_[i] = a / L_[i][i];
    d_[i] = d / L_[i][i];
    N_ += a_[i] * a_[i].transpose();
    b_ += a_[i] * d_[i];
    chi2_ += d_[i] * d_[i];
    return true;
  }

  Scalar log_density() const {
    const Scalar det = N_.determinant();
    if (!(det > Scalar(0))) return kNone;
    const Vec3 best = N_.inverse() * b_;
    return Scalar(-0.5) * (log_det_ + std::log(det) + chi2_ - b_.dot(best));
  }

 private:
  Scalar L_[kMaxJoint][kMaxJoint], d_[kMaxJoint];
  Vec3 a_[kMaxJoint];
  Scalar log_det_ = 0, chi2_ = 0;
  Mat3 N_ = Mat3::Zero();
  Vec3 b_ = Vec3::Zero();
};

}  // namespace

Scalar log_odds_of_plane(const JointDistances& points, Scalar first, Scalar roughness) {
  Whitening now, before;
  for (int i = 0; i < points.count; ++i) {
    Scalar row_now[kMaxJoint], row_before[kMaxJoint] = {};
    for (int j = 0; j < i; ++j) row_now[j] = points.S[i * points.count + j];
    row_now[i] = points.S[i * points.count + i] + roughness * roughness;
    row_before[i] = first * first + roughness * roughness;
    if (!now.add(i, row_now, points) || !before.add(i, row_before, points)) return kNone;
  }
  const Scalar a = now.log_density(), b = before.log_density();
  return std::isfinite(a) && std::isfinite(b) ? a - b : kNone;
}

Scalar log_choices(int chosen, int near, int all) {
  Scalar sum = std::log(static_cast<Scalar>(near + 1)) + 2 * std::log(static_cast<Scalar>(std::max(all, 1)));
  for (int i = 0; i < chosen; ++i) sum += std::log(static_cast<Scalar>(near - i) / static_cast<Scalar>(i + 1));
  return sum;
}

}  // namespace pf
