#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FOLDER_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FOLDER_H

#include <cstdint>
#include <string>
#include <vector>

#include "calibration.h"
#include "file.h"

namespace pf::sequence {

struct Frame {
  int64_t t_ns;
  fs::path path;
};

struct Folder {
  fs::path root;
  fs::path calibration_path;
  fs::path truth_path;  ///< empty where there is none
  fs::path imu_path;    ///< likewise
  Calibration calibration;
  std::vector<Frame> frames;
  std::string warning;
  bool is_film = false;       ///< root is a file, and so is the path of every frame
  double film_rate_hz = 0.0;  ///< 0: not known
};

/// Lists what "kind:DIR" or "video:FILE" names; decodes no image. Throws ReadError.
/// calibration  file to use, or "" for the one inside
Folder open_folder(const std::string& source, const std::string& calibration);

}  // namespace pf::sequence

#endif
