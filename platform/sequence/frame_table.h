#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FRAME_TABLE_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FRAME_TABLE_H

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "file.h"
#include "table.h"
#include "time_unit.h"

namespace pf::sequence {

struct Frame {
  int64_t t_ns;
  fs::path path;
};

/// What a table of frames belongs to.
struct FrameTablePlace {
  fs::path images;       ///< the folder that its names are looked for in
  std::string pattern;   ///< of the images in it, "" for all
  fs::path root;         ///< the sequence's folder, where names with a folder begin
  TimeUnit unit;         ///< of times where the table says none
  double rate_hz = 0.0;  ///< of the calibration; 0: not said
};

/// Rows of a times.txt, rgb.txt or data.csv to frames, in order of time. Throws ReadError that names file, row and column.
///
/// Columns are known by their header (time, name, index, exposure), or else by what they hold:
///   time | time name | name time | index time | index time name | name time exposure | index time exposure
/// where an index or name without extension is that of an image in the folder. Any other column is refused.
/// notes  get what had to be assumed
std::vector<Frame> read_frame_table(const Table& table, const FrameTablePlace& place, std::vector<std::string>& notes);

}  // namespace pf::sequence

#endif
