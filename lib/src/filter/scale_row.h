#pragma once

#include "filter/filter.h"

namespace pf {

/// As Filter::scale_row, for who only asks and may not write the filter's scratch: without its list of points, so that it takes longer.
bool find_scale_row(const Filter& filter, ScaleRow* row);

}  // namespace pf
