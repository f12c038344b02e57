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
  pf_camera_t end{};             ///< as estimated at its end; fx of 0: it tracked nothing
  double covariance[100] = {0};  ///< of end, as pf_get_camera orders it
  /// Minus twice the log likelihood of an innovation, mean over all, up to a constant: the smaller, the more likely.
  ///   (nis + dof ln sigma_gate^2) / dof
  double cost = 0.0;
  int64_t tracked = 0;
};

/// What is known of the focal length of a source without a calibration before it is tracked.
struct FocalGuess {
  pf_camera_t camera{};    ///< to begin with
  double sigma_px = 0.0;   ///< of its focal length where it was learned from frames that the run sees again, else 0
  double spread_px = 0.0;  ///< root mean square of how far the next likely trials ended from the most likely one
  double seconds = 0.0;    ///< over which it was tried
  std::vector<FocalTrial> trials;
};

/// Whether a source has to be tracked without a calibration.
bool is_uncalibrated(const Options& options);

/// A camera with the optical axis in the middle, whose focal length and distortion are hardly known.
/// pixels    width, height, and the form of its pixels: fy / fx
/// focal_px  fx
pf_camera_t guess_camera(const pf_camera_t& pixels, double focal_px);

/// Tracks the first seconds of a stored source with five focal lengths about the one of options.fov_deg. false: error is one line.
bool search_focal(const Options& options, const std::function<bool()>& interrupted, FocalGuess& guess,
                  std::string& error);

/// One line: how the search ended.
std::string describe(const FocalGuess& guess);

/// One line: the focal length as estimated now, and how well it is known. sigma_px: with the spread of the search.
std::string describe_focal(const pf_camera_t& camera, double sigma_px);

/// The camera as it is known now, for a calibration file; with standard deviations.
/// sigma_px  standard deviation of the focal length: no smaller than guess.sigma_px, with the spread of the trials; negative where the
///           library estimates none
pf_camera_t found_camera(const pf_slam_t* slam, const FocalGuess& guess, double& sigma_px);

}  // namespace pf::capture

#endif
