#pragma once

#include <cstdint>

/// What the inertial unit is to the filter, and how that changes. See lib/docs/theory/inertial.md, "Modes".

namespace pf {

enum class UnitMode : std::uint8_t {
  kAbsent,        ///< the motion model has no unit
  kUnaligned,     ///< its clock or its axes are not known yet: left out
  kAtRest,        ///< the same, but the camera rests, where neither matters: used for as long as it does
  kMoves,         ///< it rests no more: left out from the next frame on
  kSilent,        ///< no samples come
  kGyroOnly,      ///< samples move the body; lengths are not metres
  kMetric,        ///< the same, and lengths are metres
  kProbation,     ///< the same, with metres or without, for a while after it was rejected
  kContradicted,  ///< pictures contradict it: left out from the next frame on
  kRejected       ///< the same: not used
};

enum class UnitEvent : std::uint8_t {
  kLeft,           ///< a frame's prediction begins without samples
  kUsed,           ///< a frame's prediction begins with them
  kFrame,          ///< a frame has been measured with them
  kRest,           ///< the camera rests, which gives the scale
  kMotion,         ///< it rests no more
  kGoesOn,         ///< the map that began in that rest goes on
  kContradiction,  ///< pictures contradict the unit
  kMisfit,         ///< no clock and no axes make its rates those of the camera
  kNewMap          ///< a new map begins without samples
};

/// What distinguishes the modes of a unit that is used.
struct UnitUse {
  bool is_metric = false;    ///< lengths are metres
  bool is_on_trial = false;  ///< it was rejected, and has not been used for long since
};

/// An event that a mode does not know leaves it as it is.
UnitMode next_mode(UnitMode mode, UnitEvent event, const UnitUse& use);
/// In this mode samples move the body.
bool uses_samples(UnitMode mode);
/// Pictures contradict the unit.
constexpr bool is_rejected(UnitMode mode) { return mode == UnitMode::kContradicted || mode == UnitMode::kRejected; }
/// Samples are left out from the next frame on at the latest.
constexpr bool leaves_out(UnitMode mode) {
  return is_rejected(mode) || mode == UnitMode::kUnaligned || mode == UnitMode::kMoves;
}

}  // namespace pf
