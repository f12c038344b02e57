#include "focal_search.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "imu_feed.h"
#include "session.h"
#include "source.h"
#include "view.h"

namespace pf::capture {

namespace {

constexpr double kFactors[] = {1.0, 0.87, 1.14, 0.75, 1.3};  ///< of the focal length of --fov
constexpr double kTriedS = 8.0;
constexpr int64_t kMaxTried = 300;                         ///< frames
constexpr double kSigmaFocal = 0.1;                        ///< relative; neighbours of kFactors are 0.14 apart
constexpr double kSigmaAspect = 0.001;                     ///< pixels are square
constexpr double kSigmaCentre = 0.01;                      ///< of the width
constexpr double kSigmaBend = 0.15;                        ///< of k f^2, the share by which a ray at 45 degrees is bent
constexpr size_t kCompared = 3;                            ///< trials whose results tell the spread
constexpr double kTrackedShare = 0.8;                      ///< of the frames of the best trial; one with fewer was lost
constexpr double kWellKnown = 0.02, kRoughlyKnown = 0.05;  ///< relative standard deviations

double degrees_across(double focal_px, int32_t width) {
  return 2.0 * std::atan(0.5 * width / focal_px) * 180.0 / 3.14159265358979;
}

/// The options of a trial: the window, which adjusts the lens together with its keyframes and hardly depends on the beginning.
Options options_of_trial(const Options& options) {
  Options trial = options;
  trial.start = "auto";
  trial.second_pose.clear();
  trial.walls.clear();
  trial.record.clear();
  trial.backend = PF_BACKEND_WINDOW;
  trial.lens = PF_CAMERA_ESTIMATE;
  trial.masks = PF_MASKS_NONE;
  trial.imu = "none";
  trial.realtime = trial.there_and_back = false;
  trial.loop = -1;
  trial.max_features = trial.max_planes = trial.max_state_dim = trial.max_observations = trial.features_in_view = -1;
  trial.patches = -1;
  trial.points = true;
  return trial;
}

/// false: error is one line, and the source cannot be read.
bool track(const Options& options, int64_t frames, const std::function<bool()>& interrupted, FocalTrial& trial,
           std::string& error) {
  const std::unique_ptr<Source> source = open_source(options, error);
  Session session;
  const ImuFeed none;
  int code = 0;
  if (source == nullptr || !session.open(options, *source, none, error, code)) {
    return false;
  }
  FrameView view;
  double cost = 0.0;
  int64_t dof = 0;
  for (int64_t index = 0; index < frames && !interrupted(); ++index) {
    pf_image_t image{};
    const Read read = source->read(options.skip + index, image, error);
    if (read == Read::kEnd) {
      break;
    }
    if (read == Read::kUnusable) {
      continue;
    }
    if (read != Read::kDone || !session.push(image, view, error)) {
      return false;
    }
    trial.tracked += view.tracked ? 1 : 0;
    if (view.tracked && view.report.nis_dof > 0 && view.report.sigma_gate_px > 0.0) {
      cost += view.report.nis + 2.0 * view.report.nis_dof * std::log(view.report.sigma_gate_px);
      dof += view.report.nis_dof;
    }
  }
  if (dof > 0 && pf_get_camera(session.slam(), &trial.end, trial.covariance) == PF_OK) {
    trial.cost = cost / static_cast<double>(dof);
  }
  return true;
}

bool is_done(const FocalTrial& trial) { return trial.end.fx > 0.0; }

double end_px(const FocalTrial& trial) { return is_done(trial) ? trial.end.fx : trial.start_px; }

/// Its standard deviations from its covariance; the focal length's is given. Pixels are as square as they were said to be.
void set_sigmas(pf_camera_t& camera, const double covariance[100], double sigma_px) {
  const auto variance = [&](int row) { return covariance[11 * row]; };
  camera.sigma_focal = std::clamp(sigma_px / camera.fx, kSigmaAspect, 0.2);
  camera.sigma_centre_px = std::max(1e-3, std::sqrt(std::max(variance(2), variance(3))));
  camera.sigma_distortion[0] = std::min(1.0, std::sqrt(variance(4)));
}

/// The most likely first; then those that were lost or tracked nothing.
void order(std::vector<FocalTrial>& trials) {
  int64_t most = 0;
  for (const FocalTrial& trial : trials) {
    most = std::max(most, trial.tracked);
  }
  const auto is_lost = [most](const FocalTrial& trial) {
    return !is_done(trial) || static_cast<double>(trial.tracked) < kTrackedShare * static_cast<double>(most);
  };
  std::stable_sort(trials.begin(), trials.end(), [&](const FocalTrial& a, const FocalTrial& b) {
    return is_lost(a) != is_lost(b) ? is_lost(b) : a.cost < b.cost;
  });
}

}  // namespace

bool is_uncalibrated(const Options& options) {
  return options.fov_deg > 0.0 || (options.calibration.empty() && options.source.rfind("video:", 0) == 0);
}

pf_camera_t guess_camera(const pf_camera_t& pixels, double focal_px) {
  pf_camera_t camera{};
  camera.model = PF_CAMERA_DIVISION;  // with one number it follows lenses from narrow to wide
  camera.width = pixels.width;
  camera.height = pixels.height;
  camera.fx = focal_px;
  camera.fy = focal_px * pixels.fy / pixels.fx;
  camera.cx = 0.5 * (pixels.width - 1);
  camera.cy = 0.5 * (pixels.height - 1);
  camera.sigma_focal = kSigmaFocal;
  camera.sigma_aspect = kSigmaAspect;
  camera.sigma_centre_px = kSigmaCentre * pixels.width;
  camera.sigma_distortion[0] = kSigmaBend / (focal_px * focal_px);
  return camera;
}

bool search_focal(const Options& options, const std::function<bool()>& interrupted, FocalGuess& guess,
                  std::string& error) {
  Options trial_options = options_of_trial(options);
  const std::unique_ptr<Source> source = open_source(trial_options, error);
  if (source == nullptr) {
    return false;
  }
  const SourceInfo& info = source->info();
  const double fov_rad = (options.fov_deg > 0.0 ? options.fov_deg : kDefaultFovDeg) * 3.14159265358979 / 180.0;
  const double middle_px = 0.5 * info.camera.width / std::tan(0.5 * fov_rad);
  int64_t frames = std::min({kMaxTried, info.count - options.skip, static_cast<int64_t>(kTriedS * info.rate_hz)});
  frames = options.frames > 0 ? std::min(frames, options.frames) : frames;
  for (const double factor : kFactors) {
    FocalTrial trial;
    trial.start_px = factor * middle_px;
    trial_options.guess = guess_camera(info.camera, trial.start_px);
    if (!track(trial_options, frames, interrupted, trial, error)) {
      return false;
    }
    guess.trials.push_back(trial);
  }
  order(guess.trials);
  const FocalTrial& best = guess.trials.front();
  guess.seconds = static_cast<double>(frames) / info.rate_hz;
  guess.camera = guess_camera(info.camera, middle_px);
  guess.spread_px = kSigmaFocal * middle_px;
  if (!is_done(best)) {
    return true;
  }
  double squares = 0.0;
  for (size_t i = 1; i < kCompared; ++i) {
    const double away_px = end_px(guess.trials[i]) - best.end.fx;
    squares += away_px * away_px;
  }
  guess.spread_px = std::sqrt(squares / static_cast<double>(kCompared - 1));
  guess.camera = guess_camera(info.camera, best.end.fx);
  if (options.backend != PF_BACKEND_FILTER) {
    return true;
  }
  // The filter linearises once, so it begins where the window ends that begins there: with the whole lens, as well known as it is.
  FocalTrial again;
  trial_options.guess = guess.camera;
  if (!track(trial_options, frames, interrupted, again, error)) {
    return false;
  }
  if (is_done(again)) {
    guess.camera = again.end;
    guess.sigma_px = std::sqrt(again.covariance[0]);
    set_sigmas(guess.camera, again.covariance, std::hypot(guess.sigma_px, guess.spread_px));
  }
  return true;
}

std::string describe(const FocalGuess& guess) {
  char text[240];
  const double focal_px = guess.camera.fx;
  const auto [low, high] =
      std::minmax_element(guess.trials.begin(), guess.trials.end(),
                          [](const FocalTrial& a, const FocalTrial& b) { return end_px(a) < end_px(b); });
  std::snprintf(
      text, sizeof(text),
      "no calibration: of %zu focal lengths, tried over the first %.1f s, the most likely one ends at %.1f px "
      "(%.1f degrees across), all of them at %.1f to %.1f px",
      guess.trials.size(), guess.seconds, focal_px, degrees_across(focal_px, guess.camera.width), end_px(*low),
      end_px(*high));
  return text;
}

pf_camera_t found_camera(const pf_slam_t* slam, const FocalGuess& guess, double& sigma_px) {
  pf_camera_t camera{};
  double covariance[100];
  if (pf_get_camera(slam, &camera, covariance) != PF_OK || camera.estimate != PF_CAMERA_ESTIMATE) {
    sigma_px = -1.0;
    return camera;
  }
  sigma_px = std::hypot(std::max(std::sqrt(covariance[0]), guess.sigma_px), guess.spread_px);
  set_sigmas(camera, covariance, sigma_px);
  return camera;
}

std::string describe_focal(const pf_camera_t& camera, double sigma_px) {
  char text[320];
  const double relative = sigma_px / camera.fx;
  const char* const known = relative < kWellKnown      ? "well known"
                            : relative < kRoughlyKnown ? "roughly known"
                                                       : "hardly known: film with more sideways motion past things at "
                                                         "several depths, or calibrate (pf-calibrate)";
  std::snprintf(text, sizeof(text),
                "focal length %.1f px, standard deviation %.1f px (%.1f %%), %.1f degrees across: %s", camera.fx,
                sigma_px, 100.0 * relative, degrees_across(camera.fx, camera.width), known);
  return text;
}

}  // namespace pf::capture
