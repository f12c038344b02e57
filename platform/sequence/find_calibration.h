#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FIND_CALIBRATION_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FIND_CALIBRATION_H

#include <string>
#include <vector>

#include "calibration.h"
#include "file.h"

namespace pf::sequence {

/// The first of these files that is there. Throws ReadError where none is.
fs::path named_calibration(const fs::path& where, const std::vector<std::string>& names);

/// The calibration of a folder: the file of the first two of names that is there, or the one file of a known form, in where or else
/// beside the images. Throws ReadError where there is none, or several with different numbers.
/// names  in the order of their precedence; the first two are what the folder's layout calls it
/// notes  gets a line where another calibration lies beside that has other numbers
fs::path find_calibration(const fs::path& where, const fs::path& images, const std::vector<std::string>& names,
                          const Asked& asked, std::vector<std::string>& notes);

}  // namespace pf::sequence

#endif
