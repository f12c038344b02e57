#include "inertial/unit_mode.h"

namespace pf {
namespace {

UnitMode used_mode(const UnitUse& use) {
  if (use.is_on_trial) return UnitMode::kProbation;
  return use.is_metric ? UnitMode::kMetric : UnitMode::kGyroOnly;
}

bool is_used_mode(UnitMode mode) {
  return mode == UnitMode::kGyroOnly || mode == UnitMode::kMetric || mode == UnitMode::kProbation;
}

/// Of a unit whose samples a prediction leaves, or a new map.
UnitMode left_mode(UnitMode mode) {
  if (is_rejected(mode)) return UnitMode::kRejected;
  return is_used_mode(mode) || mode == UnitMode::kSilent ? UnitMode::kSilent : UnitMode::kUnaligned;
}

}  // namespace

bool uses_samples(UnitMode mode) {
  return is_used_mode(mode) || mode == UnitMode::kAtRest || mode == UnitMode::kMoves || mode == UnitMode::kContradicted;
}

UnitMode next_mode(UnitMode mode, UnitEvent event, const UnitUse& use) {
  if (mode == UnitMode::kAbsent) return mode;
  switch (event) {
    case UnitEvent::kLeft:
    case UnitEvent::kNewMap:
      return left_mode(mode);
    case UnitEvent::kUsed:
      return used_mode(use);
    case UnitEvent::kFrame:
      return is_used_mode(mode) ? used_mode(use) : mode;
    case UnitEvent::kRest:
      return mode == UnitMode::kUnaligned ? UnitMode::kAtRest : mode;
    case UnitEvent::kMotion:
      return mode == UnitMode::kAtRest ? UnitMode::kUnaligned : mode;
    case UnitEvent::kGoesOn:
      return mode == UnitMode::kUnaligned ? UnitMode::kMoves : mode;
    case UnitEvent::kContradiction:
      return uses_samples(mode) ? UnitMode::kContradicted : mode;
    case UnitEvent::kMisfit:
      return mode == UnitMode::kUnaligned ? UnitMode::kRejected : mode;
  }
  return mode;
}

}  // namespace pf
