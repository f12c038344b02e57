#pragma once

#include "filter/filter.h"

namespace pf {

/// Filter::scale_row for const callers, which may not write the filter's scratch: slower, since it has no list of points.
bool find_scale_row(const Filter& filter, ScaleRow* row);

}  // namespace pf
