#ifndef PLANEFOLD_PLATFORM_SEQUENCE_CALIBRATION_H
#define PLANEFOLD_PLATFORM_SEQUENCE_CALIBRATION_H

#include <planefold/planefold.h>

#include <string>

namespace pf::sequence {

struct Calibration {
  pf_camera_t camera;   ///< width and height 0: neither the file nor the caller said them
  double rate_hz;       ///< 0 where the file does not say it
  const char* form;     ///< "kalibr", "euroc", "ros", "orb-slam3", "orb-slam", "kitti" or "plain"
  std::string warning;  ///< one line on fields that were ignored, or empty
};

/// Size of the images that a calibration belongs to, for the forms that do not say it; 0: not known.
struct ImageSize {
  int32_t width = 0, height = 0;
};

/// One of the forms of pf_read_calibration, checked: every number finite and possible for a camera of that size. Throws
/// ReadError that names the file and the field.
/// file  for messages
Calibration parse_calibration(const std::string& text, const std::string& file, ImageSize images = {});
Calibration read_calibration(const std::string& path, ImageSize images = {});

/// Throws ReadError where the size of the images is still unknown.
void require_image_size(const Calibration& calibration, const std::string& file);

}  // namespace pf::sequence

#endif
