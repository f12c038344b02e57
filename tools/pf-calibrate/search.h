#ifndef PLANEFOLD_CALIBRATE_SEARCH_H
#define PLANEFOLD_CALIBRATE_SEARCH_H

#include <string>
#include <vector>

#include "options.h"
#include "views.h"

namespace pf::calibrate {

struct Search {
  cv::Size image;
  int64_t frames = 0, looked_at = 0;
  std::vector<View> found;
};

/// Looks for the board: in frames that lie evenly over a recording, or in what a camera shows until the time is over
/// or the program is interrupted. false: error is one line.
bool search_source(const Options& options, Search& search, std::string& error);

}  // namespace pf::calibrate

#endif
