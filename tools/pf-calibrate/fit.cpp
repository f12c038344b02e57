#include "fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>

namespace pf::calibrate {

namespace {

constexpr double kMostOfSide = 0.2;  // reprojection error, of a square's side

struct Solution {
  cv::Mat K, distortion, sigma;
  std::vector<cv::Mat> rotations, translations;
};

int distortion_count(pf_camera_model_t model) { return model == PF_CAMERA_PINHOLE ? 0 : 4; }

std::vector<cv::Point3f> points_of(const View& view, const Board& board) {
  std::vector<cv::Point3f> points;
  for (int number : view.numbers) {
    points.push_back(board.point(number));
  }
  return points;
}

void solve(const std::vector<View>& views, const Board& board, cv::Size image, pf_camera_model_t model, Solution& s) {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<std::vector<cv::Point3f>> points;
  for (const View& view : views) {
    corners.push_back(view.corners);
    points.push_back(points_of(view, board));
  }
  const cv::TermCriteria until(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 200, 1e-10);
  s = {};
  if (model == PF_CAMERA_EQUIDISTANT) {
    const int flags = cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW;
    cv::fisheye::calibrate(points, corners, image, s.K, s.distortion, s.rotations, s.translations, flags, until);
    return;
  }
  int flags = cv::CALIB_FIX_K3;
  if (model == PF_CAMERA_PINHOLE) {
    flags |= cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2 | cv::CALIB_ZERO_TANGENT_DIST;
  }
  cv::Mat poses, per_view;
  cv::calibrateCamera(points, corners, image, s.K, s.distortion, s.rotations, s.translations, s.sigma, poses, per_view,
                      flags, until);
}

pf_camera_t camera_of(const Solution& s, cv::Size image, pf_camera_model_t model) {
  pf_camera_t camera{};
  camera.model = model;
  camera.width = image.width;
  camera.height = image.height;
  camera.fx = s.K.at<double>(0, 0);
  camera.fy = s.K.at<double>(1, 1);
  camera.cx = s.K.at<double>(0, 2);
  camera.cy = s.K.at<double>(1, 2);
  for (int i = 0; i < distortion_count(model); ++i) {
    camera.distortion[i] = s.distortion.at<double>(i);
  }
  return camera;
}

FittedView judge(const View& view, const Board& board, const Solution& s, size_t index, pf_camera_model_t model) {
  std::vector<cv::Point2f> projected;
  const std::vector<cv::Point3f> points = points_of(view, board);
  if (model == PF_CAMERA_EQUIDISTANT) {
    cv::fisheye::projectPoints(points, projected, s.rotations[index], s.translations[index], s.K, s.distortion);
  } else {
    cv::projectPoints(points, s.rotations[index], s.translations[index], s.K, s.distortion, projected);
  }
  FittedView fitted{view, {}, 0.0};
  double squares = 0.0;
  for (size_t i = 0; i < projected.size(); ++i) {
    fitted.residuals.push_back(view.corners[i] - projected[i]);
    squares += fitted.residuals.back().ddot(fitted.residuals.back());
  }
  fitted.rms_px = std::sqrt(squares / static_cast<double>(projected.size()));
  return fitted;
}

/// Side of a square in the pictures, the median.
double side_px(const std::vector<FittedView>& views, const Board& board) {
  const int across = board.corners().width;
  std::vector<double> sides;
  for (const FittedView& fitted : views) {
    const View& view = fitted.view;
    for (size_t i = 1; i < view.numbers.size(); ++i) {
      if (view.numbers[i] == view.numbers[i - 1] + 1 && view.numbers[i] % across != 0) {
        sides.push_back(cv::norm(view.corners[i] - view.corners[i - 1]));
      }
    }
  }
  if (sides.empty()) return 0.0;
  const auto middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
  std::nth_element(sides.begin(), middle, sides.end());
  return *middle;
}

double median_rms(const std::vector<FittedView>& views) {
  std::vector<double> values;
  for (const FittedView& view : views) {
    values.push_back(view.rms_px);
  }
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Takes out the views whose error is far above that of the others; how many.
size_t drop_worst(std::vector<View>& views, Fit& fit) {
  const double most = 2.5 * median_rms(fit.views) + 0.02;
  std::vector<View> kept;
  for (const FittedView& fitted : fit.views) {
    if (fitted.rms_px <= most) {
      kept.push_back(fitted.view);
    } else {
      fit.rejected.push_back(fitted.view.frame);
    }
  }
  const size_t dropped = views.size() - kept.size();
  views = kept;
  return dropped;
}

void summarise(Fit& fit, pf_camera_model_t model) {
  double squares = 0.0, count = 0.0;
  for (const FittedView& view : fit.views) {
    const auto corners = static_cast<double>(view.residuals.size());
    squares += view.rms_px * view.rms_px * corners;
    count += corners;
  }
  const double unknowns = 4.0 + distortion_count(model) + 6.0 * static_cast<double>(fit.views.size());
  fit.rms_px = std::sqrt(squares / count);
  fit.sigma_corner_px = std::sqrt(squares / (2.0 * count - unknowns));
}

}  // namespace

bool fit_camera(const std::vector<View>& all, const Board& board, cv::Size image, pf_camera_model_t model, Fit& fit,
                std::string& error) {
  fit = {};
  std::vector<View> views = all;
  for (int round = 0; round < 5; ++round) {
    if (static_cast<int>(views.size()) < kFewestViews) {
      error = "only " + std::to_string(views.size()) + " usable views; at least " + std::to_string(kFewestViews) +
              " that differ are needed: show the board near and far, in the corners of the picture, and slanted";
      return false;
    }
    Solution s;
    try {
      solve(views, board, image, model, s);
    } catch (const cv::Exception& exception) {
      error = "the views do not determine this camera model (" + exception.err +
              "); add slanted views, or try another --model";
      return false;
    }
    fit.camera = camera_of(s, image, model);
    for (int i = 0; i < 4 && !s.sigma.empty(); ++i) {
      fit.sigma_px[static_cast<size_t>(i)] = s.sigma.at<double>(i);
    }
    fit.views.clear();
    for (size_t i = 0; i < views.size(); ++i) {
      fit.views.push_back(judge(views[i], board, s, i, model));
    }
    if (drop_worst(views, fit) == 0) {
      break;
    }
  }
  summarise(fit, model);
  if (fit.rms_px > kMostOfSide * side_px(fit.views, board)) {
    char text[200];
    std::snprintf(text, sizeof(text),
                  "what was found is no board of %d x %d squares: no lens explains its corners, the reprojection error "
                  "is %.1f px",
                  board.columns, board.rows, fit.rms_px);
    error = text;
    return false;
  }
  return true;
}

}  // namespace pf::calibrate
