#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMU_ROWS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMU_ROWS_H

#include <planefold/planefold.h>

#include <string>
#include <vector>

#include "imu_columns.h"

namespace pf::sequence {

struct ImuRow {
  pf_imu_sample_t sample;
  const TableRow* row;
};

/// The rows of a table, in the order of the file. note  gets what was taken for granted. Throws ReadError.
std::vector<ImuRow> read_imu_rows(const Table& table, const ImuColumns& columns, std::string& note);

/// Puts rows in order of time that are at most 50 ms out of it, and passes over repeated times, with a note that counts them.
/// Throws ReadError where times run back further, or stand still.
void put_in_order(const Table& table, const ImuColumns& columns, std::vector<ImuRow>& rows, std::string& note);

/// Adds a part to a note of the file.
void add_to_note(std::string& note, const std::string& file, const std::string& part);

}  // namespace pf::sequence

#endif
