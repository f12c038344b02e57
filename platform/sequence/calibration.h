#ifndef PLANEFOLD_PLATFORM_SEQUENCE_CALIBRATION_H
#define PLANEFOLD_PLATFORM_SEQUENCE_CALIBRATION_H

#include <planefold/planefold.h>

#include <string>
#include <vector>

namespace pf::sequence {

struct Calibration {
  pf_camera_t camera;              ///< width and height 0: neither the file nor the caller said them
  double rate_hz;                  ///< 0 where the file does not say it
  const char* form;                ///< as in the table of sequence.h
  const char* size_hint;           ///< what to do where the size of the images stays unknown
  std::string camera_name;         ///< of the one that was taken, where the form names its cameras
  std::string section;             ///< key of a map that has readout_s and such too; "": none
  std::vector<std::string> notes;  ///< what was ignored or assumed, one line each
};

/// Size of the images that a calibration belongs to, for the forms that do not say it; 0: not known.
struct ImageSize {
  int32_t width = 0, height = 0;
};

/// What is known beside the file.
struct Asked {
  ImageSize images;
  std::string camera;  ///< of a file of several: its name there, or the number that ends it; "": the first
  std::vector<std::string> folders;  ///< names of those that the images lie in, which may be that of a camera
};

/// One of the forms of pf_read_calibration, checked: every number finite and possible for a camera of that size. Throws
/// ReadError that names the file and the field.
/// file  for messages
Calibration parse_calibration(const std::string& text, const std::string& file, const Asked& asked = {});
Calibration read_calibration(const std::string& path, const Asked& asked = {});

/// Whether the text has what one of the forms is known by, whatever its values are. No throw.
bool is_calibration(const std::string& text);

/// The same model and numbers, and the same size where both have one.
bool is_same_lens(const pf_camera_t& a, const pf_camera_t& b);

/// Throws ReadError where the size of the images is still unknown.
void require_image_size(const Calibration& calibration, const std::string& file);

}  // namespace pf::sequence

#endif
