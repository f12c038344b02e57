#ifndef PLANEFOLD_CALIBRATE_CHARUCO_H
#define PLANEFOLD_CALIBRATE_CHARUCO_H

#include "views.h"

namespace pf::calibrate {

/// The corners of a ChArUco board that a picture shows: each between two markers that agree on where it lies, and
/// between two dark and two light quarters. false where these are too few for a view, and found says why.
bool find_charuco(const cv::Mat& grey, const Board& board, View& view, Sighting& found);

}  // namespace pf::calibrate

#endif
