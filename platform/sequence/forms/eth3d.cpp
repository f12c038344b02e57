/// A row of numbers alone: fx, fy, cx, cy of images without distortion, as in calibration.txt of ETH3D's SLAM sequences, and k1, k2, p1, p2
/// and k3 behind them, as DROID-SLAM has it.
#include <algorithm>

#include "../file.h"
#include "../numbers.h"
#include "form.h"
#include "lens.h"

namespace pf::sequence {

namespace {

constexpr const char* kKey = "fx fy cx cy";
constexpr size_t kPinhole = 4, kMost = 9;

bool is_eth3d(const Fields& fields) { return fields.has(kKey); }

void read_eth3d(const Fields& fields, const Asked& asked, Calibration& calibration) {
  fields.check_keys(known_fields({kKey}), calibration.notes);
  const std::vector<double> p = fields.numbers_in_text(kKey);
  if (p.size() != kPinhole && p.size() != kPinhole + 4 && p.size() != kMost) {
    fields.refuse_field(kKey, "has " + std::to_string(p.size()) +
                                  " numbers; known are fx fy cx cy, and k1 k2 p1 p2 or k1 k2 p1 p2 k3 behind them");
  }
  pf_camera_t& camera = calibration.camera;
  set_pinhole({p[0], p[1], p[2], p[3]}, camera);
  set_distortion(fields, kKey, kKey, p.size() == kPinhole ? "none" : "radtan", {p.begin() + kPinhole, p.end()}, camera);
  camera.width = asked.images.width;
  camera.height = asked.images.height;
  calibration.size_hint = "write its numbers into a calib.yaml with width and height";
  if (camera.width > 0) {
    check_lens(fields, {kKey, kKey, kKey, kKey, kKey, kKey, kKey}, camera);
  }
}

}  // namespace

std::string from_eth3d(const std::string& text) {
  constexpr size_t kMaxBytes = 4096;
  const std::vector<Row> rows = text.size() <= kMaxBytes ? split_rows(text) : std::vector<Row>();
  double value = 0.0;
  if (rows.size() != 1 || rows[0].words.size() < kPinhole || rows[0].words.size() > kMost ||
      !std::all_of(rows[0].words.begin(), rows[0].words.end(),
                   [&](std::string_view word) { return parse_double(word, value); })) {
    return text;
  }
  std::string row;
  for (const std::string_view word : rows[0].words) {
    row += (row.empty() ? "" : " ") + std::string(word);
  }
  return std::string(kKey) + ": \"" + row + "\"\n";
}

const Form kEth3dForm{"eth3d", "ETH3D's calibration.txt (fx fy cx cy) and DROID-SLAM's (fx fy cx cy k1 k2 p1 p2)",
                      is_eth3d, read_eth3d};

}  // namespace pf::sequence
