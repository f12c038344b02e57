#include <cmath>

#include "filter/filter.h"

/// Whether the numbers can still be a state. Written so that NaN fails every comparison.

namespace pf {
namespace {

constexpr Scalar kMaxValue = Scalar(1e9);                           ///< of any entry of the state
constexpr Scalar kMaxVariance = Scalar(1e18);                       ///< and of any variance
constexpr Scalar kMaxReadout = Scalar(0.5);                         ///< [s]
constexpr Scalar kMaxDelay = Scalar(1);                             ///< [s] beside that of the config
constexpr Scalar kMaxScale = Scalar(0.3);                           ///< of the unit's intrinsics
constexpr Scalar kMinNorm2 = Scalar(0.9), kMaxNorm2 = Scalar(1.1);  ///< of a quaternion

bool is_value(Scalar v) { return std::abs(v) < kMaxValue; }

bool are_variances(const Triangle& P, int first, int count) {
  for (int i = first; i < first + count; ++i)
    if (!(P(i, i) >= Scalar(0) && P(i, i) < kMaxVariance)) return false;
  return true;
}

}  // namespace

bool Filter::body_is_sound() const {
  const Body& b = state_.body;
  for (int i = 0; i < 3; ++i)
    if (!is_value(b.p_W[i]) || !is_value(b.v_W[i]) || !is_value(b.w_C[i]) || !is_value(b.a_C[i]) ||
        !is_value(b.gyro_bias[i]) || !is_value(b.accel_bias[i]))
      return false;
  const Mounting& m = state_.mounting;
  const Mat3 identity = Mat3::Identity();
  if (!((m.intrinsics.D_w - identity).cwiseAbs().maxCoeff() < kMaxScale) ||
      !((m.intrinsics.D_a - identity).cwiseAbs().maxCoeff() < kMaxScale))
    return false;
  if (!is_value(m.p_C.squaredNorm()) || !(std::abs(m.delay) < kMaxDelay)) return false;
  const Scalar norm2 = b.q_WC.squaredNorm();
  return norm2 > kMinNorm2 && norm2 < kMaxNorm2 && are_variances(covariance(), 0, state_.layout.rows()) &&
         (state_.lens_rows.count == 0 ||
          (check_camera(state_.lens) == nullptr && std::abs(state_.lens.readout) <= kMaxReadout));
}

bool Filter::block_is_sound(int slot) const {
  const Block& block = state_.block[slot];
  for (int i = 0; i < info(block.kind).values; ++i)
    if (!is_value(block.value[i])) return false;
  if (block.size > 0 && !are_variances(covariance(), first_row(slot), block.size)) return false;
  return (block.parent < 0 || block_is_sound(block.parent)) &&
         (block.second_parent < 0 || block_is_sound(block.second_parent));
}

bool Filter::is_step(const Scalar* dx) const {
  for (int i = 0; i < blocks_.dim(); ++i)
    if (!is_value(dx[i])) return false;
  return true;
}

}  // namespace pf
