#pragma once

#include "filter/filter.h"

namespace pf {

/// N^T P^-1 N for the directions of State::unobservable (translation, rotation, log scale; zero for the others), by elimination
/// in double. scratch: n (n + 8). Rows that others determine are left out. False when P is not positive semidefinite, within rounding.
bool gauge_information(const Filter& filter, double* scratch, double information[49]);

}  // namespace pf
