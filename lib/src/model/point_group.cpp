#include "model/point_group.h"

namespace pf::model {

void Group::gauge(const State& state, const Block& block, GaugeRows* N) { rows(state, block, N); }

void Group::add_gauge(const State& state, const Block& block, int first, const GaugeSum& sum) {
  GaugeRowsOf<4> N;
  rows(state, block, &N);
  sum.add(first, 4, N);
}

void Group::share(const State& state, const Block& block, PlanarRows* rows) {
  PlanarRows plane;
  Plane::share(state, state.block[block.parent], &plane);
  rows->of_group(plane, block.group());
}

bool Group::scale_row(const State& state, int slot, ScaleRow* row) {
  GaugeRowsOf<4> N;
  rows(state, state.block[slot], &N);
  row->parts = 2;
  row->part[0] = Part::body(Body::kTheta, 3);
  row->part[1] = Part::of(slot, 3, 1);
  for (int i = 0; i < 3; ++i) row->h[i] = -N(3, 3 + i);
  row->h[3] = Scalar(1);
  return true;
}

}  // namespace pf::model
