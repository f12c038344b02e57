#pragma once

namespace pf {

/// Outcome of a call, with the numbers of pf_status_t.
enum class Status : int {
  kOk = 0,
  kStarting = 1,
  kCoasting = 2,
  kLost = 3,
  kUnusable = 4,
  kTruncated = 5,
  kNothing = 6,
  kNull = -1,
  kConfig = -2,
  kVersion = -3,
  kScalar = -4,
  kMemory = -5,
  kAlignment = -6,
  kSize = -7,
  kTime = -8,
  kNonFinite = -9,
  kState = -10,
  kRange = -11,
  kContext = -12,
  kFull = -13,
  kMap = -14,
};

}  // namespace pf
