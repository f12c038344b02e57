#include "frame_gaps.h"

#include <algorithm>
#include <cstdio>

#include "frame_names.h"
#include "numbers.h"

namespace pf::sequence {

namespace {

constexpr size_t kMinSteps = 3;
constexpr double kMaxRatio =
    100.0;  ///< of the longest interval to the median one: more is a pause, or a clock that was set

int64_t median(std::vector<int64_t> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::string missing_numbers(const std::vector<std::string>& names) {
  std::vector<int64_t> steps;
  int64_t before = 0, number = 0;
  for (const std::string& name : names) {
    const std::string_view digits = number_of(name);
    if (!parse_integer(digits, number) || (&name != &names.front() && number <= before)) {
      return "";
    }
    if (&name != &names.front()) {
      steps.push_back(number - before);
    }
    before = number;
  }
  if (steps.size() < kMinSteps) {
    return "";
  }
  const int64_t step = median(steps);
  const auto regular = static_cast<size_t>(std::count(steps.begin(), steps.end(), step));
  int64_t missing = 0;
  size_t first = steps.size();
  for (size_t i = 0; i < steps.size(); ++i) {
    missing += steps[i] / step - (steps[i] > 0 ? 1 : 0);
    first = steps[i] > step ? std::min(first, i) : first;
  }
  if (first == steps.size() || 2 * regular < steps.size()) {
    return "";
  }
  return std::to_string(missing) + (missing == 1 ? " number is" : " numbers are") + " missing in them (first behind " +
         names[first] +
         "), which their times do not show: a times.txt that begins with '# time [frames], name' can do so";
}

std::string longest_gap(const std::vector<Frame>& frames) {
  std::vector<int64_t> steps;
  for (size_t i = 1; i < frames.size(); ++i) {
    steps.push_back(frames[i].t_ns - frames[i - 1].t_ns);
  }
  if (steps.size() < kMinSteps) {
    return "";
  }
  const double typical = static_cast<double>(median(steps));
  const auto longest = std::max_element(steps.begin(), steps.end());
  if (!(static_cast<double>(*longest) > kMaxRatio * typical)) {
    return "";
  }
  char text[240];
  const auto frame = static_cast<size_t>(longest - steps.begin()) + 1;
  std::snprintf(
      text, sizeof(text),
      "frame %zu comes %.6g s after the one before, where others come after %.3g s; was the recording paused, or "
      "the clock set? Separate parts begin with --skip %zu and end with --frames %zu",
      frame, 1e-9 * static_cast<double>(*longest), 1e-9 * typical, frame, frame);
  return text;
}

}  // namespace pf::sequence
