#include "model/gauge.h"

namespace pf {

Vec3 Body::gravity_W() const { return q_WG.toRotationMatrix().col(2); }

int body_gauge_rows(const Body& body, const BodyLayout& layout, const Mounting& mounting, BodyGaugeRows* out) {
  int count = 0;
  const auto add = [&](int first, int size, const GaugeRowsOf<3>& N) {
    out[count].first = first;
    out[count].size = size;
    out[count++].N = N;
  };
  GaugeRowsOf<3> N = GaugeRowsOf<3>::Zero();
  N.block<3, 3>(0, gauge::kRotation).setIdentity();
  add(Body::kTheta, 3, N);
  put_place<3>(Mat3::Identity(), body.p_W, &N);
  add(Body::kPosition, 3, N);
  if (!layout.has(BodyPart::kVelocity)) return count;
  put_place<3>(Mat3::Identity(), body.v_W, &N);
  N.leftCols<3>().setZero();
  if (layout.has(BodyPart::kGravity)) N.col(gauge::kScale) -= body.q_WC * body.w_C.cross(mounting.p_C);
  add(layout.row(BodyPart::kVelocity), 3, N);
  if (layout.has(BodyPart::kAcceleration)) {
    N.setZero();
    N.col(gauge::kScale) = body.a_C;
    add(layout.row(BodyPart::kAcceleration), 3, N);
  }
  if (!layout.has(BodyPart::kGravity)) return count;
  N.setZero();
  N.block<2, 3>(0, gauge::kRotation) = body.q_WG.toRotationMatrix().leftCols<2>().transpose();
  add(layout.row(BodyPart::kGravity), 2, N);
  return count;
}

}  // namespace pf
