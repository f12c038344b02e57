#pragma once

namespace pf {

/// Parts that an update estimates; it considers all others (Schmidt). The body's constants and the lens are estimated where both are.
struct EstimatedRows {
  bool motion = true;  ///< the moving parts of the body
  bool map = true;
};

}  // namespace pf
