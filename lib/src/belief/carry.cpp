#include "base/archive.h"
#include "belief/pose_belief.h"

namespace pf {

void AlikeShare::carry(Archive& archive) { archive.numbers(views_, alike_); }

void FindShare::carry(Archive& archive) { archive.numbers(mean_, as_sharp_); }

void LensBelief::carry(Archive& archive) { archive.numbers(before_, log_odds_, log_ratio_); }

void PoseBelief::carry(Archive& archive) {
  share_.carry(archive);
  alike_.carry(archive);
  lens_.carry(archive);
  sharpness_.carry(archive);
  archive.numbers(log_odds_, predicted_, least_);
  archive.flags(is_noted_);
}

}  // namespace pf
