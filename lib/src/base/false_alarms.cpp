#include "base/false_alarms.h"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr Scalar kNegligible = Scalar(1e-6);  ///< of a sum; terms below it are left out

}  // namespace

Scalar log_false_alarms(int on, int near, Scalar share, int around) {
  if (on < 4) return 0;
  const int n = std::max(near, on) - 3, k = on - 3;
  // ln of the first term of the tail, C(n, k) share^k (1 - share)^(n - k), and the others relative to it.
  Scalar first = 0;
  for (int i = 1; i <= k; ++i) first += std::log(share * static_cast<Scalar>(n - k + i) / static_cast<Scalar>(i));
  first += static_cast<Scalar>(n - k) * std::log(1 - share);
  Scalar term = 1, sum = 1;
  for (int i = k; i < n && term > kNegligible * sum; ++i) {
    term *= static_cast<Scalar>(n - i) / static_cast<Scalar>(i + 1) * share / (1 - share);
    sum += term;
  }
  const Scalar tail = std::min(Scalar(0), first + std::log(sum));
  const Scalar m = static_cast<Scalar>(std::max(around, 3));
  return tail + std::log(m * (m - 1) * (m - 2) / 6);
}

}  // namespace pf
