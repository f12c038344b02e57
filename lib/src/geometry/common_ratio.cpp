#include "geometry/common_ratio.h"

#include <algorithm>

namespace pf {

CommonRatio find_common_ratio(Scalar* ratios, int count, Scalar width) {
  CommonRatio common;
  std::sort(ratios, ratios + count);
  const auto votes = [&](int from, int end) {
    int to = from;
    while (to < end && ratios[to] < width * ratios[from]) ++to;
    return to - from;
  };
  int begin = 0;
  for (int i = 0; i < count; ++i)
    if (votes(i, count) > common.votes) {
      common.votes = votes(i, count);
      begin = i;
    }
  if (common.votes == 0) return common;
  common.ratio = ratios[begin + common.votes / 2];
  for (int i = 0; i < begin; ++i) common.others = std::max(common.others, votes(i, begin));
  for (int i = begin + common.votes; i < count; ++i) common.others = std::max(common.others, votes(i, count));
  return common;
}

}  // namespace pf
