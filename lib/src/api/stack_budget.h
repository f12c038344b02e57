#pragma once

#include <cstddef>

namespace pf {

/// Maximum stack of any call [bytes]; a test measures it.
constexpr std::size_t kStackBudget = 48 * 1024;

}  // namespace pf
