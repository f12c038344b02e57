#pragma once

#include <cstddef>
#include <cstdint>

namespace pf {

/// min_eigenvalue without the check: all pixels within kCornerBorder of *centre are readable.
float min_eigenvalue_at(const std::uint8_t* centre, std::ptrdiff_t stride);

}  // namespace pf
