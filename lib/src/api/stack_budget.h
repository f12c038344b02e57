#pragma once

#include <cstddef>

namespace pf {

/// The most stack that any call uses [bytes]; a test measures it.
constexpr std::size_t kStackBudget = 64 * 1024;

}  // namespace pf
