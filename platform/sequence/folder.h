#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FOLDER_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FOLDER_H

#include <string>
#include <vector>

#include "calibration.h"
#include "file.h"
#include "frame_table.h"

namespace pf::sequence {

struct Folder {
  fs::path root;
  fs::path calibration_path;
  fs::path truth_path;  ///< empty where there is none
  fs::path imu_path;    ///< likewise
  Calibration calibration;
  std::vector<Frame> frames;
  std::vector<std::string> notes;  ///< one line each on what had to be assumed
};

/// Lists what "kind:DIR" names, or "images:DIR/PATTERN" with a *; opens no image. Throws ReadError.
/// calibration  file to use, or "" for the one inside
Folder open_folder(const std::string& source, const std::string& calibration);

}  // namespace pf::sequence

#endif
