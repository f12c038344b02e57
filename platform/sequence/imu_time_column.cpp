#include "imu_time_column.h"

#include "refuse.h"

namespace pf::sequence {

namespace {

/// Whether the first row has a number or a date there.
bool can_be_time(const Table& table, size_t column) {
  int64_t t_ns = 0;
  return table.rows().empty() || (column < table.rows().front().fields.size() &&
                                  parse_time(table.rows().front().fields[column], TimeUnit::kNanoseconds, 0.0, t_ns));
}

/// The time of the sensor itself ("gyroTimestamp" beside "gyroRotationX") before that of a message, that before one of its receipt.
size_t find_time(const ImuHeader& header, const std::string& family) {
  size_t found = ImuColumns::kNone;
  int best = 0;
  for (size_t i = 0; i < header.columns.size(); ++i) {
    const ImuColumn& column = header.columns[i];
    if ((column.role != ImuRole::kTime && column.role != ImuRole::kElapsed) || !can_be_time(header.table, i)) {
      continue;
    }
    constexpr size_t kSame = 4;  // letters of a sensor's name
    const bool own = family.size() > kSame && column.family.compare(0, kSame, family, 0, kSame) == 0;
    const bool stamp = column.family.find("stamp") != std::string::npos;
    const int rank = column.role == ImuRole::kElapsed ? 1 : own ? 4 : stamp ? 3 : 2;
    if (rank > best) {
      best = rank;
      found = i;
    }
  }
  return found;
}

/// "header.stamp.nsecs" beside "header.stamp.secs".
void find_nanoseconds(const ImuHeader& header, ImuColumns& columns) {
  const std::string& family = header.columns[columns.time].family;
  for (const char* seconds : {"secs", "sec"}) {
    const std::string tail(seconds);
    if (family.size() <= tail.size() || family.compare(family.size() - tail.size(), tail.size(), tail) != 0) {
      continue;
    }
    const std::string stem = family.substr(0, family.size() - tail.size());
    for (size_t i = 0; i < header.columns.size(); ++i) {
      for (const char* name : {"nsecs", "nsec", "nanosec", "nanosecs", "nanoseconds"}) {
        if (header.columns[i].family == stem + name) {
          columns.nanoseconds = i;
          columns.unit_said = true;
          columns.unit = TimeUnit::kSeconds;
          return;
        }
      }
    }
  }
}

}  // namespace

void set_time(const ImuHeader& header, const std::string& family, ImuColumns& columns) {
  columns.time = find_time(header, family);
  if (columns.time == ImuColumns::kNone) {
    refuse(header.table.name() + ": its header names no column of times; write time [s], timestamp [ns] or the like");
  }
  columns.unit_said = parse_unit(header.columns[columns.time].unit, columns.unit) && columns.unit != TimeUnit::kFrames;
  find_nanoseconds(header, columns);
}

}  // namespace pf::sequence
