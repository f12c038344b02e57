#pragma once

#include "filter/block_filter.h"
#include "model/state.h"

/// The state's values and its gauge by the rows of the covariance.

namespace pf {

/// x <- x [+] dx: every block moves by its rows of dx.
void apply_error(State& state, const BlockFilter& blocks, const Scalar* dx);

/// Adds sign times the gauge rows at x over the whole state to one row per direction, leading dimension ld. Rows of directions that
/// are observable become zero. N_T may be null: translations are the same at every x but for planes.
void add_gauge_rows(const State& state, const BlockFilter& blocks, Scalar sign, Scalar* N_T, Scalar* N_R, Scalar* N_s,
                    int ld);

}  // namespace pf
