#ifndef PLANEFOLD_PLATFORM_SEQUENCE_CALIBRATION_H
#define PLANEFOLD_PLATFORM_SEQUENCE_CALIBRATION_H

#include <planefold/planefold.h>

#include <string>

namespace pf::sequence {

struct Calibration {
  pf_camera_t camera;
  double rate_hz;       ///< 0 where the file does not say it
  const char* form;     ///< "kalibr", "euroc", "ros" or "plain"
  std::string warning;  ///< one line on fields that were ignored, or empty
};

/// One of the forms of pf_read_calibration, checked: every number finite and possible for a camera of that size. Throws
/// ReadError that names the file and the field.
/// file  for messages
Calibration parse_calibration(const std::string& text, const std::string& file);
Calibration read_calibration(const std::string& path);

}  // namespace pf::sequence

#endif
