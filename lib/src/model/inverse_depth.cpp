#include "model/inverse_depth.h"

#include "geometry/so3.h"
#include "model/tuning.h"

namespace pf::model {

void InverseDepthPoint::retract(Block* block, const Scalar* e) {
  InverseDepth d = block->inverse_depth();
  const Mat3 R = d.q_b.toRotationMatrix();
  d.q_b = exp_so3(R.col(1) * e[0] - R.col(0) * e[1]) * d.q_b;
  d.q_b.normalize();
  d.rho += e[2];
  block->set_inverse_depth(d);
}

void InverseDepthPoint::place(const State& state, int slot, Place* out) {
  const Block& block = state.block[slot];
  const InverseDepth d = block.inverse_depth();
  const Mat3 R_b = d.q_b.toRotationMatrix();
  out->o = state.block[block.parent].xyz();
  out->w = d.rho;
  out->b = R_b.col(2);
  out->append<3>(block.parent, Mat3::Identity());
  out->append<3>(slot, Mat3::Zero());
  out->J_b.leftCols<6>().setZero();
  out->J_b.block<3, 2>(0, 3) = R_b.leftCols<2>();
  out->w_column = 5;
}

Vec3 InverseDepthPoint::point(const State& state, const Block& block) {
  const InverseDepth d = block.inverse_depth();
  const Scalar rho = d.rho > tuning::inverse_depth::kMinShownRho ? d.rho : tuning::inverse_depth::kMinShownRho;
  return state.block[block.parent].xyz() + d.q_b.toRotationMatrix().col(2) / rho;
}

void InverseDepthPoint::gauge(const State&, const Block& block, GaugeRows* N) { rows(block, N); }

void InverseDepthPoint::add_gauge(const State&, const Block& block, int first, const GaugeSum& sum) {
  GaugeRowsOf<3> N = GaugeRowsOf<3>::Zero();
  rows(block, &N);
  sum.add(first, 3, N);
}

bool InverseDepthPoint::scale_row(const State& state, int slot, ScaleRow* row) {
  const Scalar rho = state.block[slot].inverse_depth().rho;
  if (!(rho > tuning::inverse_depth::kMinRho)) return false;
  row->parts = 1;
  row->part[0] = Part::of(slot, 0, 3);
  row->h[0] = row->h[1] = Scalar(0);
  row->h[2] = Scalar(-1) / rho;
  return true;
}

}  // namespace pf::model
