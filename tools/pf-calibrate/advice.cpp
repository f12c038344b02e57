#include "advice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pf::calibrate {

namespace {

constexpr double kMinCovered = 0.6;       ///< of the picture
constexpr double kMinCoveredPart = 0.25;  ///< of each of nine parts of it
constexpr double kMaxSigmaFocal = 0.002;  ///< relative; tracking estimates what is left of 1 %
constexpr double kMaxError = 0.001;       ///< reprojection error, of the picture's width
constexpr size_t kMinViews = 12;
constexpr double kMinSlant = 0.15;      ///< of describe(): a board whose far side is 8 % smaller than its near one
constexpr size_t kMinSlantedViews = 4;  ///< each way

std::string text_of(const char* form, double a) {
  char text[160];
  std::snprintf(text, sizeof(text), form, a);
  return text;
}

/// Parts of the picture in which hardly a corner lies: "top left, right".
std::string empty_parts(const std::vector<View>& views, cv::Size image) {
  static const char* const kNames[3][3] = {
      {"top left", "top", "top right"}, {"left", "middle", "right"}, {"bottom left", "bottom", "bottom right"}};
  const auto counts = count_corners(views, image);
  int cells[3][3] = {}, covered[3][3] = {};
  for (int y = 0; y < kCellsDown; ++y) {
    for (int x = 0; x < kCellsAcross; ++x) {
      const int row = 3 * y / kCellsDown, column = 3 * x / kCellsAcross;
      ++cells[row][column];
      covered[row][column] += counts[static_cast<size_t>(y * kCellsAcross + x)] > 0 ? 1 : 0;
    }
  }
  std::string names;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (covered[row][column] < kMinCoveredPart * cells[row][column]) {
        names += std::string(names.empty() ? "" : ", ") + kNames[row][column];
      }
    }
  }
  return names;
}

/// Views in which the board is slanted about one of its sides: which is a number of describe().
size_t slanted(const std::vector<View>& views, const Board& board, cv::Size image, size_t which) {
  return static_cast<size_t>(std::count_if(views.begin(), views.end(), [&](const View& view) {
    return std::fabs(describe(view, board, image)[which]) > kMinSlant;
  }));
}

}  // namespace

Verdict judge_fit(const Fit& fit, const Board& board) {
  constexpr size_t kAcross = 3, kDown = 4;  // foreshortening, of describe()
  const cv::Size image(fit.camera.width, fit.camera.height);
  Verdict verdict;
  std::vector<View> views;
  for (const FittedView& fitted : fit.views) {
    views.push_back(fitted.view);
  }
  const double covered = covered_share(views, image);
  const std::string empty = empty_parts(views, image);
  if (covered < kMinCovered || !empty.empty()) {
    verdict.lacks.push_back(
        text_of("corners cover only %.0f %% of the picture, and what lies outside is extrapolated: film the "
                "board ",
                100.0 * covered) +
        (empty.empty() ? "in more places" : "where hardly a corner was, " + empty));
  }
  const double sigma = fit.sigma_px[0] / fit.camera.fx;
  if (sigma > kMaxSigmaFocal) {
    verdict.lacks.push_back(
        text_of("the focal length is known to %.1f %% only: film the board slanted by 30 to 50 degrees, each "
                "way, and as near as it stays whole",
                100.0 * sigma));
  } else if (slanted(views, board, image, kAcross) < kMinSlantedViews ||
             slanted(views, board, image, kDown) < kMinSlantedViews) {
    verdict.lacks.push_back(
        "hardly a view is slanted " +
        std::string(slanted(views, board, image, kAcross) < kMinSlantedViews ? "sideways" : "up or down") +
        ", and only such views measure the focal length: tilt the board by 30 to 50 degrees that way");
  }
  if (fit.views.size() < kMinViews) {
    verdict.lacks.push_back("only " + std::to_string(fit.views.size()) + " views differ enough to be used: film " +
                            std::to_string(kMinViews) + " or more, near and far, slanted, and held still");
  }
  if (fit.rms_px > kMaxError * image.width) {
    verdict.lacks.push_back(
        text_of("the reprojection error of %.2f px is large: is the board flat, are the pictures sharp, and does "
                "--model suit the lens?",
                fit.rms_px));
  }
  verdict.good = verdict.lacks.empty();
  return verdict;
}

std::string verdict_line(const Verdict& verdict) {
  return verdict.good ? "good enough to track with"
                      : "not good enough to track with yet; what to film next stands above";
}

}  // namespace pf::calibrate
