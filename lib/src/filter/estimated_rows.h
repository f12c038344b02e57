#pragma once

namespace pf {

/// What an update estimates; all else it considers (Schmidt). The body's constants and the lens are estimated where both are.
struct EstimatedRows {
  bool motion = true;  ///< what moves of the body
  bool map = true;
};

}  // namespace pf
