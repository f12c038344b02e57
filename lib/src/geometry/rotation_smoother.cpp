#include "geometry/rotation_smoother.h"

#include "geometry/so3.h"

namespace pf {
namespace {

void eliminate(RotationLink* link, int count) {
  for (int k = 0; k < count; ++k) {
    RotationLink& now = link[k];
    now.w = 1 / now.variance;
    now.chain = now.q_WC;
    now.C.setZero();
    if (k > 0) {
      now.chain = (link[k - 1].chain * now.dq).normalized();
      now.C = link[k - 1].C + now.chain.toRotationMatrix() * now.by_bias;
    }
    now.m = log_so3(now.q_WC * now.chain.conjugate());
    now.x = now.w * now.m;
    now.X = now.w * now.C;
    now.d = now.w;
    if (k + 1 < count) now.d += 1 / link[k + 1].step_variance;
    if (k == 0) continue;
    const Scalar step = 1 / now.step_variance, f = step / link[k - 1].d;
    now.d += step - f * step;
    now.x += f * link[k - 1].x;
    now.X += f * link[k - 1].X;
  }
}

/// x = H m, X = H C, and the diagonal of the inverse as the variance.
void solve_backwards(RotationLink* link, int count) {
  for (int k = count - 1; k >= 0; --k) {
    RotationLink& now = link[k];
    now.x /= now.d;
    now.X /= now.d;
    now.variance = 1 / now.d;
    if (k + 1 == count) continue;
    const Scalar f = 1 / (link[k + 1].step_variance * now.d);
    now.x += f * link[k + 1].x;
    now.X += f * link[k + 1].X;
    now.variance += f * f * link[k + 1].variance;
  }
}

}  // namespace

Vec3 smooth_rotations(RotationLink* link, int count, Scalar bias_variance) {
  eliminate(link, count);
  solve_backwards(link, count);
  Mat3 information = Mat3::Identity() / bias_variance;
  Vec3 right = Vec3::Zero();
  for (int k = 0; k < count; ++k) {
    information += link[k].w * link[k].C.transpose() * (link[k].C - link[k].X);
    right += link[k].w * link[k].C.transpose() * (link[k].m - link[k].x);
  }
  const Mat3 covariance = information.inverse();
  const Vec3 bias = covariance * right;
  for (int k = 0; k < count; ++k) {
    RotationLink& now = link[k];
    const Mat3 by_bias = now.C - now.X;
    now.q_WC = (exp_so3(now.x + by_bias * bias) * now.chain).normalized();
    now.variance += (by_bias * covariance * by_bias.transpose()).trace() / 3;
  }
  return bias;
}

}  // namespace pf
