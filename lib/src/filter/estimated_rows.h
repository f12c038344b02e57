#pragma once

namespace pf {

/// Blocks that some measurements of an update estimate, and the others consider (Schmidt). With K_D the gain of the first ones by
/// themselves,
///
///   x_b += K_D r_D,   x += K r for all else,   P the covariance of these estimates
///
/// so what the others measure reaches the correlation of such a block with the rest of the state, and neither its mean nor its covariance.
struct PartlyConsidered {
  const int* block = nullptr;  ///< slots; no two the same
  int count = 0;
  const unsigned char* estimates = nullptr;  ///< whether each measurement does
};

/// Parts that an update estimates; it considers all others (Schmidt). The body's constants and the lens are estimated where both are.
struct EstimatedRows {
  bool motion = true;  ///< the moving parts of the body
  bool map = true;
  PartlyConsidered partly = PartlyConsidered();  ///< of the map
};

}  // namespace pf
