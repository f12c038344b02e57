#include "imu.h"

#include "imu_rows.h"

namespace pf::sequence {

std::vector<pf_imu_sample_t> parse_imu(std::string_view text, const std::string& name, std::string& note) {
  const Table table{std::string(text), name};
  const ImuColumns columns = columns_of(table, ImuContent::kBoth);
  note = columns.note;
  std::vector<ImuRow> rows = read_imu_rows(table, columns, note);
  put_in_order(table, columns, rows, note);
  std::vector<pf_imu_sample_t> samples;
  samples.reserve(rows.size());
  for (const ImuRow& row : rows) {
    samples.push_back(row.sample);
  }
  return samples;
}

}  // namespace pf::sequence
