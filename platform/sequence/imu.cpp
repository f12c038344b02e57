#include "imu.h"

#include <algorithm>
#include <cmath>

#include "file.h"
#include "numbers.h"
#include "refuse.h"

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

}  // namespace

std::vector<pf_imu_sample_t> parse_imu(std::string_view text, const std::string& name) {
  const std::vector<Row> rows = split_rows(text);
  // A whole number alone could be either; a decimal point anywhere says that the file is in seconds.
  const bool in_seconds = std::any_of(rows.begin(), rows.end(),
                                      [](const Row& row) { return row.words[0].find('.') != std::string_view::npos; });
  std::vector<pf_imu_sample_t> samples;
  samples.reserve(rows.size());
  for (const Row& row : rows) {
    const std::string where = name + " line " + std::to_string(row.number) + ": ";
    if (row.words.size() != kColumns) {
      refuse(where + "expected a time, three rates and three accelerations, found " + std::to_string(row.words.size()) +
             " columns");
    }
    pf_imu_sample_t sample{};
    if (!(in_seconds ? parse_seconds(row.words[0], sample.t_ns) : parse_integer(row.words[0], sample.t_ns))) {
      refuse(where + "'" + std::string(row.words[0]) + "' is not a time in " +
             (in_seconds ? "seconds" : "whole nanoseconds"));
    }
    if (!samples.empty() && sample.t_ns <= samples.back().t_ns) {
      refuse(where + "the time " + std::string(row.words[0]) +
             (sample.t_ns == samples.back().t_ns ? " repeats" : " runs back") +
             "; times must grow from sample to sample");
    }
    for (size_t i = 0; i < 3; ++i) {
      sample.gyro[i] = number(row.words[1 + i], where);
      sample.accel[i] = number(row.words[4 + i], where);
    }
    samples.push_back(sample);
  }
  if (samples.empty()) {
    refuse(name + ": holds no sample");
  }
  return samples;
}

}  // namespace pf::sequence
