#include "model/reference_camera.h"

#include "geometry/so3.h"

namespace pf::model {

void ReferenceCamera::retract(Block* block, const Scalar* e) {
  Quat q = exp_so3(Vec3(e[0], e[1], e[2])) * q_WC(*block);
  q.normalize();
  set(block, q, p_WC(*block) + Vec3(e[3], e[4], e[5]));
}

void ReferenceCamera::gauge(const State&, const Block& block, GaugeRows* N) { rows(block, N); }

void ReferenceCamera::add_gauge(const State&, const Block& block, int first, const GaugeSum& sum) {
  GaugeRowsOf<6> N = GaugeRowsOf<6>::Zero();
  rows(block, &N);
  sum.add(first, 6, N);
}

}  // namespace pf::model
