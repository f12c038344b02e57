#include "filter/state_rows.h"

#include <algorithm>

#include "model/kinds.h"

namespace pf {

namespace {

/// The rate is what samples read, where they move the body.
void move_intrinsics(State& state, const Scalar* dx) {
  Intrinsics& intrinsics = state.mounting.intrinsics;
  Intrinsics::Error e;
  for (int i = 0; i < Intrinsics::kRows; ++i) e(i) = dx[i];
  const Vec3 reading = state.mounting.reading_of(state.body.w_C);
  intrinsics.move(e);
  if (state.uses_samples) state.body.w_C = state.mounting.rate_C(reading);
}

}  // namespace

void apply_error(State& state, const BlockFilter& blocks, const Scalar* dx) {
  const auto three = [&](int row) { return Vec3(dx[row], dx[row + 1], dx[row + 2]); };
  Body& body = state.body;
  body.q_WC = exp_so3(three(Body::kTheta)) * body.q_WC;
  body.q_WC.normalize();
  body.p_W += three(Body::kPosition);
  const BodyLayout& layout = state.layout;
  if (layout.has(BodyPart::kVelocity)) body.v_W += three(layout.row(BodyPart::kVelocity));
  if (layout.has(BodyPart::kAngularVelocity)) body.w_C += three(layout.row(BodyPart::kAngularVelocity));
  if (layout.has(BodyPart::kAcceleration)) body.a_C += three(layout.row(BodyPart::kAcceleration));
  if (layout.has(BodyPart::kGyroBias)) {
    const Vec3 e_g = three(layout.row(BodyPart::kGyroBias));
    const int gravity = layout.row(BodyPart::kGravity);
    body.gyro_bias += e_g;
    body.w_C -= state.mounting.rate_C(e_g);  // the samples less the bias
    body.accel_bias += three(layout.row(BodyPart::kAccelBias));
    body.q_WG = body.q_WG * exp_so3(Vec3(dx[gravity], dx[gravity + 1], Scalar(0)));
    body.q_WG.normalize();
    Mounting& mounting = state.mounting;
    if (layout.has(BodyPart::kMountRotation)) {
      const Quat turn = exp_so3(three(layout.row(BodyPart::kMountRotation)));
      mounting.R_CB = (turn * Quat(mounting.R_CB)).normalized().toRotationMatrix();
      body.w_C = turn * body.w_C;  // the samples' axes, not the samples
    }
    if (layout.has(BodyPart::kMountPlace)) mounting.p_C += three(layout.row(BodyPart::kMountPlace));
    if (layout.has(BodyPart::kDelay)) mounting.delay += dx[layout.row(BodyPart::kDelay)];
    if (layout.has(BodyPart::kIntrinsics)) move_intrinsics(state, dx + layout.row(BodyPart::kIntrinsics));
  }
  if (layout.has(BodyPart::kLens) && layout.considered_rows() == 0)
    move_lens(state.lens_rows, dx + layout.row(BodyPart::kLens), &state.lens);
  for (int s = 0; s < state.slots; ++s) {
    Block& block = state.block[s];
    visit(block.kind, [&](auto kind) { decltype(kind)::retract(&block, dx + blocks.first(s)); });
  }
}

namespace {

/// Gauge rows of the children of a plane or point group, made of their parent's rows.
void add_children(const State& state, const BlockFilter& blocks, int parent, const model::PlanarRows& rows,
                  const GaugeSum& sum) {
  for (int t = state.block[parent].first_child; t >= 0; t = state.next_child(parent, t)) {
    const Block& child = state.block[t];
    if (child.size == 0 || !is_planar(child.kind)) continue;
    const Vec2 c = child.uv();
    for (int i = 0; i < 2; ++i) {
      const int at = blocks.first(t) + i;
      for (int axis = 0; axis < 3; ++axis) {
        if (sum.N_T != nullptr) sum.N_T[axis * sum.ld + at] += sum.sign * rows(i, axis, c);
        sum.N_R[axis * sum.ld + at] += sum.sign * rows(i, 3 + axis, c);
      }
      sum.N_s[at] += sum.sign * rows(i, 6, c);
    }
  }
}

}  // namespace

void add_gauge_rows(const State& state, const BlockFilter& blocks, Scalar sign, Scalar* N_T, Scalar* N_R, Scalar* N_s,
                    int ld) {
  const GaugeSum sum = {sign, N_T, N_R, N_s, ld};
  for_each_body_gauge(state.body, state.layout, state.mounting,
                      [&](int first, int rows, const GaugeRowsOf<3>& N) { sum.add(first, rows, N); });
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    visit(block.kind, [&](auto kind) {
      using K = decltype(kind);
      if constexpr (!K::kInfo.planar) K::add_gauge(state, block, blocks.first(s), sum);
      if constexpr (K::kSharesGauge) {
        if (block.children == 0) return;
        model::PlanarRows rows;
        K::share(state, block, &rows);
        add_children(state, blocks, s, rows, sum);
      }
    });
  }
  for (int d = 0; d < gauge::kDirections; ++d) {
    if (gauge::contains(state.unobservable, d) || (d < gauge::kRotation && N_T == nullptr)) continue;
    Scalar* row = d < gauge::kRotation ? N_T + d * ld : d < gauge::kScale ? N_R + (d - gauge::kRotation) * ld : N_s;
    std::fill(row, row + blocks.dim(), Scalar(0));
  }
}

}  // namespace pf
