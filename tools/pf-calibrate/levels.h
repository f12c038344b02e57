#ifndef PLANEFOLD_CALIBRATE_LEVELS_H
#define PLANEFOLD_CALIBRATE_LEVELS_H

#include "views.h"

namespace pf::calibrate {

/// Grey level between pixels, bilinear; the border's outside the picture.
double level_at(const cv::Mat& grey, const cv::Point2f& p);

/// Over how many pixels an edge between two squares rises: the step over the steepest slope, the median over all edges
/// between neighbours of a row.
double edge_spread(const cv::Mat& grey, const Board& board, const View& view);

}  // namespace pf::calibrate

#endif
