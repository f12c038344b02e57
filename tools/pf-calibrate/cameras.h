#ifndef PLANEFOLD_CALIBRATE_CAMERAS_H
#define PLANEFOLD_CALIBRATE_CAMERAS_H

#include <string>

#include "search.h"

namespace pf::calibrate {

/// v4l2: and libcamera:, whether this build has them or not.
bool is_camera(const std::string& source);

/// Looks at what a camera shows. false: error is one line.
bool search_camera(const Options& options, Search& search, std::string& error);

}  // namespace pf::calibrate

#endif
