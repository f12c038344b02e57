#include "imu_rows.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "numbers.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr int64_t kMended =
    50000000;                   ///< [ns] packets of phones and buses that overtake each other; more is another clock
constexpr size_t kMaxSame = 2;  ///< different samples of one time: a third is a clock that stands still

std::string name_of_column(const Table& table, size_t column) {
  return column < table.header().size() ? "'" + table.header()[column] + "'" : "column " + std::to_string(column + 1);
}

double number(const Table& table, const TableRow& row, size_t column) {
  const std::string_view word = row.fields[column];
  const std::string where = table.where(row) + "'" + std::string(word) + "' ";
  double value = 0.0;
  if (word.empty()) {
    refuse(table.where(row) + name_of_column(table, column) + " is empty");
  }
  if (!parse_double(word, value)) {
    refuse(where + "is not a number (" + name_of_column(table, column) + ")");
  }
  if (!std::isfinite(value)) {
    refuse(where + "is not finite (" + name_of_column(table, column) + "); remove the row");
  }
  return value;
}

/// The unit of times: as the header says; else seconds with a decimal point anywhere, else nanoseconds; another where no unit samples at
/// such a rate.
/// note  becomes what was taken then
TimeUnit unit_of_samples(const Table& table, const ImuColumns& columns, std::string& note) {
  constexpr size_t kMinSamples = 20;
  constexpr double kSlowest = 2.0, kFastest = 20000.0;      // [1/s]
  constexpr double kSlowestSure = 20.0, kPerUnit = 1000.0;  // from one unit to the next
  const size_t time = columns.time;
  const std::vector<TableRow>& rows = table.rows();
  const auto has_point = [&](const TableRow& row) {
    return time < row.fields.size() && row.fields[time].find('.') != std::string_view::npos;
  };
  const bool seconds = std::any_of(rows.begin(), rows.end(), has_point);
  const TimeUnit unit = columns.unit_said ? columns.unit : seconds ? TimeUnit::kSeconds : TimeUnit::kNanoseconds;
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
  if (steps.size() + 1 < kMinSamples || columns.nanoseconds != ImuColumns::kNone) {
    return unit;
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double per_unit = 1.0 / *middle;
  constexpr TimeUnit kUnits[] = {TimeUnit::kSeconds, TimeUnit::kMilliseconds, TimeUnit::kMicroseconds,
                                 TimeUnit::kNanoseconds};
  const double rate =
      per_unit *
      std::pow(kPerUnit, static_cast<double>(std::find(std::begin(kUnits), std::end(kUnits), unit) - kUnits));
  if (rate >= kSlowest && rate <= kFastest) {
    return unit;
  }
  double found = per_unit;
  for (const TimeUnit candidate : kUnits) {
    if (found >= kSlowestSure && found <= kFastest) {
      char text[160];
      std::snprintf(text, sizeof(text), "in %s its samples come at %.3g Hz; they are taken as %s (%.4g Hz)",
                    name_of(unit), rate, name_of(candidate), found);
      add_to_note(note, table.name(), text);
      return candidate;
    }
    found *= kPerUnit;
  }
  return unit;
}

int64_t read_time(const Table& table, const ImuColumns& columns, const TableRow& row, TimeUnit unit) {
  const std::string_view word = row.fields[columns.time];
  int64_t t_ns = 0, rest = 0;
  if (!parse_time(word, unit, 0.0, t_ns)) {
    refuse(table.where(row) + "'" + std::string(word) + "' is not a time in " +
           (unit == TimeUnit::kNanoseconds ? "whole nanoseconds" : name_of(unit)));
  }
  if (columns.nanoseconds == ImuColumns::kNone) {
    return t_ns;
  }
  constexpr int64_t kSecond = 1000000000, kMost = INT64_MAX - kSecond;
  const std::string_view part = row.fields[columns.nanoseconds];
  if (!parse_integer(part, rest) || rest < 0 || rest >= kSecond || t_ns > kMost) {
    refuse(table.where(row) + "'" + std::string(part) + "' are no nanoseconds below a second (" +
           name_of_column(table, columns.nanoseconds) + ")");
  }
  return t_ns + rest;
}

bool is_same(const pf_imu_sample_t& a, const pf_imu_sample_t& b) {
  return std::equal(a.gyro, a.gyro + 3, b.gyro) && std::equal(a.accel, a.accel + 3, b.accel);
}

[[noreturn]] void refuse_order(const Table& table, const ImuColumns& columns, const ImuRow& row,
                               const std::string& why) {
  refuse(table.where(*row.row) + "the time " + std::string(row.row->fields[columns.time]) + " (" +
         name_of_column(table, columns.time) + ") " + why);
}

std::string counted(size_t count, const char* one, const char* many) {
  return std::to_string(count) + (count == 1 ? one : many);
}

}  // namespace

void add_to_note(std::string& note, const std::string& file, const std::string& part) {
  note += (note.empty() ? file + ": " : "; ") + part;
}

std::vector<ImuRow> read_imu_rows(const Table& table, const ImuColumns& columns, std::string& note) {
  const TimeUnit unit = unit_of_samples(table, columns, note);
  std::vector<ImuRow> rows;
  rows.reserve(table.rows().size());
  for (const TableRow& row : table.rows()) {
    if (row.fields.size() != columns.columns) {
      refuse(table.where(row) + "expected " +
             (table.header().empty() ? columns.gyro.found && columns.accel.found
                                           ? "a time, three rates and three accelerations"
                                           : "a time and three numbers"
                                     : std::to_string(columns.columns) + " columns, as its header has") +
             ", found " + std::to_string(row.fields.size()) + " columns" +
             (table.header().empty() && row.fields.size() > columns.columns
                  ? "; name them in a first row (time, gyro_x, .., accel_z)"
                  : ""));
    }
    ImuRow read{{}, &row};
    read.sample.t_ns = read_time(table, columns, row, unit);
    for (size_t i = 0; i < 3; ++i) {
      if (columns.gyro.found) {
        read.sample.gyro[i] = columns.gyro.factor * number(table, row, columns.gyro.column[i]);
      }
      if (columns.accel.found) {
        read.sample.accel[i] = columns.accel.factor * number(table, row, columns.accel.column[i]);
      }
      if (columns.gravity.found) {
        read.sample.accel[i] += columns.gravity.factor * number(table, row, columns.gravity.column[i]);
      }
      if (!std::isfinite(read.sample.gyro[i]) || !std::isfinite(read.sample.accel[i])) {
        refuse(table.where(row) + "a number is too large for its unit");
      }
    }
    rows.push_back(read);
  }
  if (rows.empty()) {
    refuse(table.name() + ": holds no sample");
  }
  return rows;
}

void put_in_order(const Table& table, const ImuColumns& columns, std::vector<ImuRow>& rows, std::string& note) {
  size_t late = 0;
  int64_t newest = rows.front().sample.t_ns;
  double most = 0.0;  // [ns]
  for (const ImuRow& row : rows) {
    const double behind = static_cast<double>(newest) - static_cast<double>(row.sample.t_ns);
    if (behind > static_cast<double>(kMended)) {
      char text[96];
      std::snprintf(text, sizeof(text), "runs back by %.4g s; up to 0.05 s are put in order", 1e-9 * behind);
      refuse_order(table, columns, row, text);
    }
    late += behind > 0.0 ? 1 : 0;
    most = std::max(most, behind);
    newest = std::max(newest, row.sample.t_ns);
  }
  const auto earlier = [](const ImuRow& a, const ImuRow& b) { return a.sample.t_ns < b.sample.t_ns; };
  if (late > 0) {
    std::stable_sort(rows.begin(), rows.end(), earlier);
    char text[96];
    std::snprintf(text, sizeof(text), " up to %.3g ms late and put in order", 1e-6 * most);
    add_to_note(note, table.name(), counted(late, " sample was", " samples were") + text);
  }
  size_t kept = 0, repeated = 0, different = 1;
  for (size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].sample.t_ns != rows[kept].sample.t_ns) {
      rows[++kept] = rows[i];
      different = 1;
      continue;
    }
    ++repeated;
    different += is_same(rows[i].sample, rows[i - 1].sample) ? 0 : 1;
    if (different > kMaxSame) {
      refuse_order(table, columns, rows[i],
                   "repeats from sample to sample while the numbers change; its clock stands still");
    }
  }
  rows.resize(kept + 1);
  if (repeated > 0) {
    add_to_note(note, table.name(),
                counted(repeated, " sample repeats", " samples repeat") + " the time of another and is passed over");
  }
}

}  // namespace pf::sequence
