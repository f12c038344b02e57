#include "belief/alike_share.h"

#include <cmath>

#include "belief/tuning.h"

namespace pf {

void AlikeShare::note(bool is_alike) {
  views_ += 1;
  if (is_alike) alike_ += 1;
}

Scalar AlikeShare::log_share() const {
  const Scalar least = std::exp(-tuning::pose_belief::kMaxFrame);
  return std::log(least + (1 - least) * alike_ / (tuning::alike_share::kWeight + views_));
}

}  // namespace pf
