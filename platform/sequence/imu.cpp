#include "imu.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "numbers.h"
#include "refuse.h"
#include "table.h"
#include "time_unit.h"

namespace pf::sequence {

namespace {

constexpr size_t kColumns = 7;

double number(std::string_view word, const std::string& where) {
  double value = 0.0;
  if (!parse_double(word, value)) {
    refuse(where + "'" + std::string(word) + "' is not a number");
  }
  if (!std::isfinite(value)) {
    refuse(where + "'" + std::string(word) + "' is not finite; remove the row");
  }
  return value;
}

/// What a column of the header holds: 't' time, 'g' or 'a' and its axis as in "gx"; empty: not known.
std::string role_of(const std::string& column) {
  std::string unit;
  const std::string name = split_unit(column, unit);
  if (name.find("time") != std::string::npos || name.find("stamp") != std::string::npos || name == "t") {
    return "t";
  }
  if (name.size() < 2) {
    return "";
  }
  const auto has = [&](std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(),
                       [&](const char* word) { return name.find(word) != std::string::npos; });
  };
  const bool rate = has({"gyr", "omega", "ang", "rot"}) || name[0] == 'w' || name[0] == 'g' || name.rfind("rv", 0) == 0;
  const bool force = has({"acc", "lin"}) || name[0] == 'a';
  const char axis = name.back();
  if ((axis < 'x' || axis > 'z') || (!rate && !force)) {
    return "";
  }
  return std::string(rate ? "g" : "a") + axis;
}

/// Where time, three rates and three accelerations are: as the header says, where it names all of them; else in this order.
std::array<size_t, kColumns> columns_of(const Table& table) {
  const char* const roles[kColumns] = {"t", "gx", "gy", "gz", "ax", "ay", "az"};
  std::array<size_t, kColumns> in_order{}, found{};
  size_t known = 0;
  for (size_t i = 0; i < kColumns; ++i) {
    in_order[i] = i;
    for (size_t k = 0; k < table.header().size(); ++k) {
      if (role_of(table.header()[k]) == roles[i]) {
        found[i] = k;
        ++known;
      }
    }
  }
  return table.header().size() == kColumns && known == kColumns ? found : in_order;
}

/// The unit of times: seconds with a decimal point anywhere, else nanoseconds; another where no unit samples at such a rate.
/// note  becomes what was taken then
TimeUnit unit_of_samples(const Table& table, size_t time, std::string& note) {
  constexpr size_t kMinSamples = 20;
  constexpr double kSlowest = 2.0, kFastest = 20000.0;      // [1/s]
  constexpr double kSlowestSure = 20.0, kPerUnit = 1000.0;  // from one unit to the next
  const std::vector<TableRow>& rows = table.rows();
  const auto has_point = [&](const TableRow& row) {
    return time < row.fields.size() && row.fields[time].find('.') != std::string_view::npos;
  };
  TimeUnit unit = std::any_of(rows.begin(), rows.end(), has_point) ? TimeUnit::kSeconds : TimeUnit::kNanoseconds;
  std::vector<double> steps;  // their median, since a clock may jump
  double before = 0.0;
  for (const TableRow& row : rows) {
    double now = 0.0;
    if (row.fields.size() <= time || !parse_double(row.fields[time], now)) {
      return unit;
    }
    if (&row != &rows.front() && now > before) {
      steps.push_back(now - before);
    }
    before = now;
  }
  if (steps.size() + 1 < kMinSamples) {
    return unit;
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double per_unit = 1.0 / *middle;
  const double rate = per_unit * (unit == TimeUnit::kSeconds ? 1.0 : 1e9);
  if (rate >= kSlowest && rate <= kFastest) {
    return unit;
  }
  double found = per_unit;
  for (const TimeUnit candidate :
       {TimeUnit::kSeconds, TimeUnit::kMilliseconds, TimeUnit::kMicroseconds, TimeUnit::kNanoseconds}) {
    if (found >= kSlowestSure && found <= kFastest) {
      char text[160];
      std::snprintf(text, sizeof(text), ": in %s its samples come at %.3g Hz; they are taken as %s (%.4g Hz)",
                    name_of(unit), rate, name_of(candidate), found);
      note = table.name() + text;
      return candidate;
    }
    found *= kPerUnit;
  }
  return unit;
}

}  // namespace

std::vector<pf_imu_sample_t> parse_imu(std::string_view text, const std::string& name, std::string& note) {
  const Table table{std::string(text), name};
  const std::vector<TableRow>& rows = table.rows();
  const std::array<size_t, kColumns> column = columns_of(table);
  const TimeUnit unit = unit_of_samples(table, column[0], note);
  std::vector<pf_imu_sample_t> samples;
  samples.reserve(rows.size());
  for (const TableRow& row : rows) {
    const std::string where = table.where(row);
    if (row.fields.size() != kColumns) {
      refuse(where + "expected a time, three rates and three accelerations, found " +
             std::to_string(row.fields.size()) + " columns");
    }
    pf_imu_sample_t sample{};
    const std::string_view time = row.fields[column[0]];
    if (!parse_time(time, unit, 0.0, sample.t_ns)) {
      refuse(where + "'" + std::string(time) + "' is not a time in " +
             (unit == TimeUnit::kNanoseconds ? "whole nanoseconds" : name_of(unit)));
    }
    if (!samples.empty() && sample.t_ns <= samples.back().t_ns) {
      refuse(where + "the time " + std::string(time) +
             (sample.t_ns == samples.back().t_ns ? " repeats" : " runs back") +
             "; times must grow from sample to sample");
    }
    for (size_t i = 0; i < 3; ++i) {
      sample.gyro[i] = number(row.fields[column[1 + i]], where);
      sample.accel[i] = number(row.fields[column[4 + i]], where);
    }
    samples.push_back(sample);
  }
  if (samples.empty()) {
    refuse(name + ": holds no sample");
  }
  return samples;
}

}  // namespace pf::sequence
