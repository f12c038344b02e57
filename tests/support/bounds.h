#pragma once

// One-sided comparisons of real numbers that name both when they fail.

#include <cstdio>

#include "unity.h"

namespace pf {

inline bool is_below_or_tell(double limit, double actual, bool wanted) {
  if ((actual < limit) == wanted) return true;
  std::printf("limit %.9g, actual %.9g\n", limit, actual);
  return false;
}

}  // namespace pf

#define EXPECT_BELOW(limit, actual) \
  TEST_ASSERT_TRUE(pf::is_below_or_tell(static_cast<double>(limit), static_cast<double>(actual), true))
#define EXPECT_NOT_BELOW(limit, actual) \
  TEST_ASSERT_TRUE(pf::is_below_or_tell(static_cast<double>(limit), static_cast<double>(actual), false))
