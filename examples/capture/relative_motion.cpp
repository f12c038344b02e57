#include "relative_motion.h"

#include <algorithm>
#include <cmath>

#include "maths.h"

namespace pf::capture {

namespace {

using Quat = std::array<double, 4>;  ///< w x y z

Quat conjugate(const double q[4]) { return {q[0], -q[1], -q[2], -q[3]}; }

Quat product(const Quat& a, const Quat& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// theta of Exp(theta) = R(q).
Vec3 rotation_log(const Quat& q) {
  const double sign = q[0] < 0.0 ? -1.0 : 1.0;
  const double sine = std::sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double factor = sine > 1e-12 ? 2.0 * std::atan2(sine, sign * q[0]) / sine : 2.0;
  return {sign * factor * q[1], sign * factor * q[2], sign * factor * q[3]};
}

/// x <- L^-1 x for several x, with L L^T = C (6x6); false where C is not positive definite.
template <size_t n>
bool whiten(const double C[36], std::array<double, 6> (&x)[n]) {
  double L[36];
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = C[6 * i + j];
      for (int k = 0; k < j; ++k) {
        sum -= L[6 * i + k] * L[6 * j + k];
      }
      if (i == j && !(sum > 0.0)) {
        return false;
      }
      L[6 * i + j] = i == j ? std::sqrt(sum) : sum / L[6 * j + j];
    }
    for (std::array<double, 6>& of : x) {
      for (int k = 0; k < i; ++k) {
        of[static_cast<size_t>(i)] -= L[6 * i + k] * of[static_cast<size_t>(k)];
      }
      of[static_cast<size_t>(i)] /= L[6 * i + i];
    }
  }
  return true;
}

double dot(const std::array<double, 6>& a, const std::array<double, 6>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < 6; ++i) {
    sum += a[i] * b[i];
  }
  return sum;
}

}  // namespace

bool RelativeMotion::add(pf_slam_t* slam, const FrameView& view, const pf_pose_t* truth) {
  if (frames_ == 0) {
    return false;
  }
  since_ += since_ >= 0 ? 1 : 0;
  if (since_ >= 0 && pf_get_motion_since_mark(slam, &window_.motion) != PF_OK) {
    since_ = -1;  // its map is gone
  }
  if (since_ >= 0 && since_ < frames_) {
    return false;
  }
  const bool tracking = view.status == PF_OK;
  const bool ended = since_ >= 0 && tracking;
  untracked_ += since_ >= 0 && !tracking ? 1 : 0;
  if (ended) {
    ++windows_;
    window_.map = view.map;
    window_.nees = -1.0;
    if (truth != nullptr && has_truth_at_mark_) {
      judge(*truth);
    }
  }
  since_ = -1;
  if (tracking) {
    const pf_status_t marked = pf_mark_pose(slam);
    without_room_ += marked == PF_ERROR_FULL ? 1 : 0;
    since_ = marked == PF_OK ? 0 : -1;
    has_truth_at_mark_ = truth != nullptr;
    truth_at_mark_ = truth != nullptr ? *truth : pf_pose_t{};
  }
  return ended;
}

///   e = a + s b,   a = (theta, -p_KC),   b = (0, true p_KC)
///
/// With s = 1 where the length is known; otherwise the s that makes e^T C^-1 e least, which costs a degree of freedom.
void RelativeMotion::judge(const pf_pose_t& truth) {
  const pf_motion_t& motion = window_.motion;
  const Quat q_KC =
      product(conjugate(truth_at_mark_.q_WC), {truth.q_WC[0], truth.q_WC[1], truth.q_WC[2], truth.q_WC[3]});
  const Vec3 theta = rotation_log(product(q_KC, conjugate(motion.q_KC)));
  const Vec3 d_W = {truth.p_WC[0] - truth_at_mark_.p_WC[0], truth.p_WC[1] - truth_at_mark_.p_WC[1],
                    truth.p_WC[2] - truth_at_mark_.p_WC[2]};
  std::array<double, 6> x[2] = {};
  for (size_t i = 0; i < 3; ++i) {
    x[0][i] = theta[i];
    x[0][3 + i] = -motion.p_KC[i];
    x[1][3 + i] = capture::dot(rotation_column(truth_at_mark_.q_WC, static_cast<int>(i)), d_W);
  }
  if (!whiten(motion.covariance, x)) {
    return;
  }
  const double bb = dot(x[1], x[1]);
  const bool free = !has_length_ && bb > 0.0;
  const double s = free ? -dot(x[0], x[1]) / bb : 1.0;
  window_.nees = std::max(0.0, dot(x[0], x[0]) + 2.0 * s * dot(x[0], x[1]) + s * s * bb);
  window_.nees_dof = free ? 5 : 6;
  nees_ += window_.nees;
  dof_ += window_.nees_dof;
}

}  // namespace pf::capture
