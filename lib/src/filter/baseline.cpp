#include "filter/baseline.h"

#include "filter/filter.h"

namespace pf {

void predict_baseline(const State& state, int anchor, const Mat3& covariance, BaselineMeasurement* out) {
  constexpr int kColumns = 6;
  out->predicted = state.body.p_W - state.block[anchor].xyz();
  out->measured.setZero();
  put<3, 3>(out->H.h, kColumns, 0, Mat3::Identity());
  put<3, 3>(out->H.h, kColumns, 3, -Mat3::Identity());
  out->H.parts = 0;
  out->H.part[out->H.parts++] = Part::body(Body::kPosition, 3);
  out->H.part[out->H.parts++] = Part::of(anchor, 0, 3);
  out->set_noise(covariance);
}

bool take_baseline(Filter& filter, int anchor, const Mat3& covariance) {
  BaselineMeasurement z;
  predict_baseline(filter.state(), anchor, covariance, &z);
  const Measurement view = z.view();
  filter.begin_update(&view, 1);
  return filter.finish_update(&view, 1, nullptr, nullptr);
}

}  // namespace pf
