#include "name_stamps.h"

#include <algorithm>
#include <cstddef>

#include "date_time.h"
#include "image_list.h"

namespace pf::sequence {

namespace {

constexpr size_t kStampDigits = 13, kDateDigits = 14, kNanosecondDigits = 19;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

using Runs = std::vector<std::string_view>;

/// Runs of digits before the extension.
Runs runs_of(std::string_view name) {
  name = name.substr(0, name.rfind('.'));
  Runs runs;
  for (size_t begin = 0; begin < name.size();) {
    size_t end = begin;
    while (end < name.size() && is_digit(name[end])) ++end;
    if (end > begin) {
      runs.push_back(name.substr(begin, end - begin));
    }
    begin = std::max(end, begin + 1);
  }
  return runs;
}

/// Of each name its runs; empty where names are of several kinds.
std::vector<Runs> runs_of_one_kind(const std::vector<std::string>& names) {
  std::vector<Runs> all;
  std::string numbers, kind;
  for (const std::string& name : names) {
    if (all.empty()) {
      kind = kind_of(name, numbers);
    } else if (kind_of(name, numbers) != kind) {
      return {};
    }
    all.push_back(runs_of(name));
  }
  return all;
}

/// "2024-01-31 12:00:05.250" of the runs from first on; "" where they are no date with a fraction.
std::string date_text(const Runs& runs, size_t first) {
  const auto begins_with = [&](std::initializer_list<size_t> sizes) {
    size_t at = first;
    return std::all_of(sizes.begin(), sizes.end(), [&](size_t size) {
      ++at;
      return at <= runs.size() && runs[at - 1].size() == size;
    });
  };
  const bool one = first < runs.size() && runs[first].size() >= kDateDigits && runs[first].size() < kNanosecondDigits;
  const bool two = first + 1 < runs.size() && runs[first].size() == 8 && runs[first + 1].size() >= 6;
  if (!one && !two && !begins_with({4, 2, 2, 2, 2, 2}) && !begins_with({8, 2, 2, 2})) {
    return "";
  }
  std::string digits;
  for (size_t i = first; i < runs.size(); ++i) {
    digits += runs[i];
  }
  const size_t fraction = digits.size() < kDateDigits ? 0 : digits.size() - kDateDigits;
  if (fraction != 3 && fraction != 6 && fraction != 9) {
    return "";
  }
  for (const size_t at : {4u, 7u, 10u, 13u, 16u, 19u}) {
    digits.insert(at, 1, at < 10 ? '-' : at == 10 ? ' ' : at < 19 ? ':' : '.');
  }
  return digits;
}

/// Whether times go on by one unit of their last digit, as the numbers of frames behind a date do.
bool do_count(std::vector<int64_t> times, size_t digits) {
  int64_t unit = 1;
  for (size_t i = digits; i < 9; ++i) {
    unit *= 10;
  }
  std::sort(times.begin(), times.end());
  size_t steps = 0;
  for (size_t i = 1; i < times.size(); ++i) {
    steps += times[i] - times[i - 1] == unit ? 1 : 0;
  }
  return 2 * steps >= times.size();
}

}  // namespace

bool are_stamps(const std::vector<std::string_view>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](std::string_view number) {
    const bool date = number.size() >= kStampDigits && number.size() < kNanosecondDigits &&
                      (number.substr(0, 2) == "20" || number.substr(0, 2) == "19");
    return number.size() >= kStampDigits && !date;
  });
}

std::vector<std::string_view> stamps_in(const std::vector<std::string>& names) {
  const std::vector<Runs> all = runs_of_one_kind(names);
  std::vector<std::string_view> found;
  for (size_t k = 0; !all.empty() && k < all[0].size(); ++k) {
    std::vector<std::string_view> column;
    for (const Runs& runs : all) {
      column.push_back(runs[k]);
    }
    if (are_stamps(column)) {
      if (!found.empty()) {
        return {};
      }
      found = column;
    }
  }
  return found;
}

std::vector<int64_t> dates_in(const std::vector<std::string>& names) {
  const std::vector<Runs> all = runs_of_one_kind(names);
  for (size_t first = 0; !all.empty() && first < all[0].size(); ++first) {
    std::vector<int64_t> times;
    size_t digits = 0;
    for (const Runs& runs : all) {
      const std::string text = date_text(runs, first);
      int64_t t_ns = 0;
      if (text.empty() || !parse_date_time(text, t_ns)) {
        break;
      }
      digits = text.size() - text.rfind('.') - 1;
      times.push_back(t_ns);
    }
    if (times.size() == all.size()) {
      return do_count(times, digits) ? std::vector<int64_t>() : times;
    }
  }
  return {};
}

}  // namespace pf::sequence
