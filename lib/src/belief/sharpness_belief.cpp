#include "belief/sharpness_belief.h"

#include <algorithm>
#include <cmath>

#include "base/archive.h"
#include "belief/tuning.h"

namespace pf {

using namespace tuning::sharpness_belief;

void SharpnessBelief::init() {
  *this = SharpnessBelief();
  variance_ = kPriorSpread * kPriorSpread;
}

void SharpnessBelief::note(Scalar log_sharpness) {
  now_ = log_sharpness;
  is_noted_ = true;
}

void SharpnessBelief::learn() {
  if (!is_noted_) return;
  const Scalar gain = std::max(kGain, 1 / static_cast<Scalar>(learned_ + 1)), off = now_ - mean_;
  mean_ += gain * off;
  if (learned_ > 0) variance_ = std::max(kLeastSpread * kLeastSpread, variance_ + kGain * (off * off - variance_));
  if (1 > kGain * static_cast<Scalar>(learned_)) ++learned_;
}

Scalar SharpnessBelief::as_sharp() const {
  const Scalar below = mean_ - now_;
  if (!is_noted_ || learned_ == 0 || below <= Scalar(0)) return 1;
  constexpr Scalar kTwoPi = Scalar(6.283185307179586);
  const Scalar usual = (1 - kLessSharp) * std::exp(-below * below / (2 * variance_)) / std::sqrt(kTwoPi * variance_);
  return usual / (usual + kLessSharp / kRange);
}

void SharpnessBelief::carry(Archive& archive) {
  archive.numbers(now_, mean_, variance_);
  archive.counts(learned_);
  archive.flags(is_noted_);
}

}  // namespace pf
