#include "geometry/rotation_smoother.h"

#include "geometry/so3.h"

namespace pf {

void smooth_rotations(RotationLink* link, int count) {
  for (int k = 0; k < count; ++k) {
    RotationLink& now = link[k];
    const Scalar information = 1 / now.variance;
    now.chain = k == 0 ? now.q_WC : (link[k - 1].chain * now.dq).normalized();
    now.x = information * log_so3(now.q_WC * now.chain.conjugate());
    now.d = information;
    if (k + 1 < count) now.d += 1 / link[k + 1].step_variance;
    if (k == 0) continue;
    const Scalar step = 1 / now.step_variance, f = step / link[k - 1].d;
    now.d += step - f * step;
    now.x += f * link[k - 1].x;
  }
  for (int k = count - 1; k >= 0; --k) {
    RotationLink& now = link[k];
    const Scalar f = k + 1 < count ? 1 / (link[k + 1].step_variance * now.d) : Scalar(0);
    now.x /= now.d;
    now.variance = 1 / now.d;
    if (k + 1 < count) {
      now.x += f * link[k + 1].x;
      now.variance += f * f * link[k + 1].variance;
    }
    now.q_WC = (exp_so3(now.x) * now.chain).normalized();
  }
}

}  // namespace pf
