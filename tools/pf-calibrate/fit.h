#ifndef PLANEFOLD_CALIBRATE_FIT_H
#define PLANEFOLD_CALIBRATE_FIT_H

#include <planefold/planefold.h>

#include <array>
#include <string>
#include <vector>

#include "views.h"

namespace pf::calibrate {

constexpr int kFewestViews = 6;

struct FittedView {
  View view;
  std::vector<cv::Point2f> residuals;  ///< measured minus projected [px]
  double rms_px = 0.0;
};

struct Fit {
  pf_camera_t camera{};
  std::array<double, 4> sigma_px{};  ///< of fx, fy, cx, cy; zero where the model's solver does not say
  double rms_px = 0.0;               ///< of the distance between measured and projected corners
  double sigma_corner_px = 0.0;      ///< of one coordinate of a corner, with what the fit took out given back
  std::vector<FittedView> views;
  std::vector<int64_t> rejected;  ///< frames whose views did not agree with the others
};

/// Least squares over the camera and the board's poses; views that stand out are taken out and the rest fitted anew.
/// model  PF_CAMERA_PINHOLE, PF_CAMERA_RADTAN (k1 k2 p1 p2) or PF_CAMERA_EQUIDISTANT (k1 .. k4)
/// false: error is one line
bool fit_camera(const std::vector<View>& views, const Board& board, cv::Size image, pf_camera_model_t model, Fit& fit,
                std::string& error);

}  // namespace pf::calibrate

#endif
