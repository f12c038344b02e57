#ifndef PLANEFOLD_CAPTURE_FOCAL_SEARCH_H
#define PLANEFOLD_CAPTURE_FOCAL_SEARCH_H

#include <planefold/planefold.h>

#include <functional>
#include <string>
#include <vector>

#include "options.h"

namespace pf::capture {

/// One run over the first seconds of a source, with a focal length to begin with.
struct FocalTrial {
  double start_px = 0.0;
  double end_px = 0.0;  ///< as estimated at its end
  /// Minus twice the log likelihood of an innovation, mean over all, up to a constant: the smaller, the more likely.
  ///   (nis + dof ln sigma_gate^2) / dof
  double cost = 0.0;
  int64_t tracked = 0;
};

/// What is known of the focal length of a source without a calibration before it is tracked.
struct FocalGuess {
  pf_camera_t camera{};    ///< to begin with
  double spread_px = 0.0;  ///< root mean square of how far the next likely trials ended from the most likely one
  double seconds = 0.0;    ///< over which it was tried
  std::vector<FocalTrial> trials;
};

/// Whether a source has to be tracked without a calibration.
bool is_uncalibrated(const Options& options);

/// A camera with square pixels and the optical axis in the middle, whose focal length and distortion are hardly known.
pf_camera_t guess_camera(int32_t width, int32_t height, double focal_px);

/// Tracks the first seconds of a stored source with five focal lengths about the one of options.fov_deg. false: error is one line.
bool search_focal(const Options& options, const std::function<bool()>& interrupted, FocalGuess& guess,
                  std::string& error);

/// One line: how the search ended.
std::string describe(const FocalGuess& guess);

/// One line: the focal length as estimated now, and how well it is known. sigma_px: with the spread of the search.
std::string describe_focal(const pf_camera_t& camera, double sigma_px);

/// Standard deviation of the focal length in pixels, the search's spread included; negative where the library estimates none.
double focal_sigma_px(const pf_slam_t* slam, const FocalGuess& guess);

}  // namespace pf::capture

#endif
