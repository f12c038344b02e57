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
  Asked asked;  ///< with which it was read
  std::vector<Frame> frames;
  std::vector<std::string> notes;  ///< what had to be assumed, one line each, without those of the calibration
  bool is_film = false;            ///< root is a file, and so is the path of every frame
  double film_rate_hz = 0.0;       ///< 0: not known
  ImageSize film_size;             ///< as stored; a rotation may exchange them
  double pixel_aspect = 1.0;       ///< of a film as stored: width of a pixel by its height
};

/// Lists what "kind:DIR" or "video:FILE" names, or "images:DIR/PATTERN" with a *; decodes no image. Throws ReadError.
/// calibration  file to use, or "" for the one inside
/// camera       of a calibration of several; "": the one that the folder is named after, or the first
Folder open_folder(const std::string& source, const std::string& calibration, const std::string& camera);

/// Reads folder.calibration anew, with what folder.asked says by now. Throws CalibrationError.
void read_calibration_of(Folder& folder);

}  // namespace pf::sequence

#endif
