#ifndef PLANEFOLD_CALIBRATE_CAMERAS_H
#define PLANEFOLD_CALIBRATE_CAMERAS_H

#include <string>

#include "search.h"

namespace pf::calibrate {

/// Looks at what a camera shows. false: error is one line.
bool search_camera(const Options& options, Search& search, std::string& error);

}  // namespace pf::calibrate

#endif
