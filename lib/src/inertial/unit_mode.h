#pragma once

#include <cstdint>

/// Modes of the inertial unit in the filter, and their transitions (lib/docs/theory/inertial.md, "Modes").

namespace pf {

enum class UnitMode : std::uint8_t {
  kAbsent,        ///< the motion model has no unit
  kUnaligned,     ///< its clock or its axes are not known yet: not used
  kAtRest,        ///< the same, but the camera rests, where neither matters: used for as long as it does
  kMoves,         ///< the rest has ended: not used from the next frame on
  kSilent,        ///< samples are missing
  kGyroOnly,      ///< samples move the body; lengths are not metres
  kMetric,        ///< the same, and lengths are metres
  kProbation,     ///< the same, with metres or without, for a while after it was rejected
  kContradicted,  ///< images contradict it: not used from the next frame on
  kRejected       ///< the same: not used
};

enum class UnitEvent : std::uint8_t {
  kLeft,           ///< a frame's prediction begins without samples
  kUsed,           ///< a frame's prediction begins with them
  kFrame,          ///< a frame has been measured with them
  kRest,           ///< the camera rests, which gives the scale
  kMotion,         ///< the rest has ended
  kGoesOn,         ///< the map that began in that rest goes on
  kContradiction,  ///< images contradict the unit
  kMisfit,         ///< no clock and no axes make its rates those of the camera
  kNewMap          ///< a new map begins without samples
};

/// What distinguishes the modes of a unit that is used.
struct UnitUse {
  bool is_metric = false;    ///< lengths are metres
  bool is_on_trial = false;  ///< it was rejected, and has not been used for long since
};

/// Mode after an event; events without a transition change nothing.
UnitMode next_mode(UnitMode mode, UnitEvent event, const UnitUse& use);
/// True where samples move the body in this mode.
bool uses_samples(UnitMode mode);
/// True where images contradict the unit.
constexpr bool is_rejected(UnitMode mode) { return mode == UnitMode::kContradicted || mode == UnitMode::kRejected; }
/// True where samples are not used from the next frame on.
constexpr bool leaves_out(UnitMode mode) {
  return is_rejected(mode) || mode == UnitMode::kUnaligned || mode == UnitMode::kMoves;
}

}  // namespace pf
