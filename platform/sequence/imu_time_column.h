#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMU_TIME_COLUMN_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMU_TIME_COLUMN_H

#include <string>
#include <vector>

#include "imu_columns.h"
#include "imu_header.h"

namespace pf::sequence {

/// A table's header, and what each of its columns holds.
struct ImuHeader {
  const Table& table;
  std::vector<ImuColumn> columns;
};

/// Sets time, nanoseconds and unit. Throws ReadError where no column is one of times.
/// family  of the rates, whose own time comes before others
void set_time(const ImuHeader& header, const std::string& family, ImuColumns& columns);

}  // namespace pf::sequence

#endif
