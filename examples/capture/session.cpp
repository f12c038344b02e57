#include "session.h"

#include <planefold/planefold_research.h>
#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "anchors.h"
#include "steady.h"

namespace pf::capture {

namespace {

/// Of a start from a pose: what a hand does [m/s, rad/s].
constexpr double kSpeedSigma = 0.5;
constexpr double kRateSigma = 0.5;

constexpr double kExactFocal = 1e-4;  ///< relative; a calibration that states less is taken as exact

constexpr int32_t kWindowFeatures = 150;  ///< in view, with the window
constexpr int32_t kPlaces = 16;           ///< of a map that is begun in or saved

constexpr int32_t kPatchesAlone = 16;  ///< of walls, where there are no points

int64_t clock_ns(void*) { return steady_ns(); }

constexpr size_t kMaxLines = 400;

constexpr size_t kLineBytes = 280;  ///< the library's line, with the frame

void keep_line(void* user, const char* line) { static_cast<Session::Log*>(user)->add(line); }

/// A calibration is a measurement too, and estimating what it left gains more where it is poor than it costs where it is good
/// (lib/docs/theory/lens.md). A scene's is exact, and says so (pf_sim_camera).
pf_camera_estimate_t default_estimate(const pf_config_t& config) {
  const bool can = config.motion.model != PF_MOTION_INERTIAL;
  return can && config.camera.sigma_focal > kExactFocal ? PF_CAMERA_ESTIMATE : PF_CAMERA_EXACT;
}

/// What is wrong with an option that set a capacity, where the library refuses what only together is too much or too little.
std::string wrong_capacity(const std::string& field, const Options& options, const pf_config_t& config) {
  const auto number = [](int32_t value) { return std::to_string(value); };
  if (field == "window.points") {
    return "--max-features " + number(options.max_features) + ": the window holds at least 50 points";
  }
  if (options.features_in_view > 0 && (field == "capacity.max_observations" || field == "map.features_in_view")) {
    const bool has_window = config.backend == PF_BACKEND_WINDOW;
    const bool named = options.max_observations > 0;
    return "--features-in-view " + number(options.features_in_view) + ": more than the " +
           (has_window ? number(config.window.points) + " points of the map; --max-features sets them"
            : named    ? number(options.max_observations) + " of --max-observations"
                       : "200 that the filter measures in one frame");
  }
  return "";
}

}  // namespace

Session::Log::Log() : unused(kMaxLines) {
  lines.reserve(kMaxLines);
  for (std::string& line : unused) line.reserve(kLineBytes);
}

/// With the frame that is being pushed. When full, a line in the middle is left out.
void Session::Log::add(const char* line) {
  if (unused.empty()) {
    unused.push_back(std::move(lines[kMaxLines / 2]));
    lines.erase(lines.begin() + kMaxLines / 2);
    lines[kMaxLines / 2 - 1] = "(lines are left out here)";
  }
  std::string text = std::move(unused.back());
  unused.pop_back();
  text.clear();
  if (frame >= 0) text.append("frame ").append(std::to_string(frame)).append(": ");
  lines.push_back(std::move(text.append(line)));
}

Session::~Session() { std::free(block_); }

bool Session::open(const Options& options, const Source& source, const ImuFeed& imu, std::string& error, int& code) {
  code = kExitRun;
  if (pf_config_default(&config_) != PF_OK) {
    error = "the library gives no default configuration";
    return false;
  }
  has_gravity_ = options.has_gravity;
  std::copy_n(options.gravity_W, 3, gravity_W_);
  config_.camera = source.info().camera;
  if (options.readout_s >= 0.0) config_.camera.readout_s = options.readout_s;
  if (options.timestamps >= 0) config_.camera.timestamps = options.timestamps;
  config_.kernels = options.kernels;
  config_.map.masks = options.masks;
  config_.backend = options.backend;
  const bool has_window = options.backend == PF_BACKEND_WINDOW;
  if (has_window) config_.map.features_in_view = kWindowFeatures;
  pf_research_t research;
  pf_research_default(&research);
  research.keep_gauge = options.keep_gauge ? 1 : 0;
  if (!options.keep_gauge || options.masks == PF_MASKS_WHOLE) pf_config_set_research(&config_, &research);
  config_.plane.enabled = options.planes ? 1 : 0;
  const auto set = [](int32_t& field, int32_t value) { field = value > 0 ? value : field; };
  set(has_window ? config_.window.points : config_.capacity.max_features, options.max_features);
  set(config_.window.keyframes, options.window_keyframes);
  if (options.window_fixed >= 0) config_.window.fixed_keyframes = options.window_fixed;
  set(config_.capacity.max_planes, options.max_planes);
  if (!options.map.empty() || !options.save_map.empty()) config_.capacity.max_places = kPlaces;  // the filter's too
  if (options.max_places >= 0) config_.capacity.max_places = options.max_places;
  if (options.max_anchors >= 0) config_.capacity.max_anchors = options.max_anchors;
  set(config_.capacity.max_state_dim, options.max_state_dim);
  set(config_.capacity.max_observations, options.max_observations);
  set(config_.map.features_in_view, options.features_in_view);
  set(config_.plane.min_points, options.plane_points);
  const auto set_length = [](double& field, double value) { field = value >= 0.0 ? value : field; };
  set_length(config_.plane.fix_sigma, options.fix_sigma);
  set_length(config_.plane.fold_sigma, options.fold_sigma);
  set_length(config_.plane.max_distance, options.plane_distance);
  set_length(config_.plane.max_radius, options.plane_radius);
  set_length(config_.plane.roughness, options.plane_roughness);
  if (!options.points) config_.map.features_in_view = 0;
  config_.capacity.max_patches = options.patches >= 0 ? options.patches : options.points ? 0 : kPatchesAlone;
  if (!plan_.open(options.walls, options.start.rfind("pose:", 0) == 0, error)) {
    code = kExitUsage;
    return false;
  }
  if (options.max_planes < 0) {  // room for all walls, and for as many found planes as without
    config_.capacity.max_planes = std::min(64, config_.capacity.max_planes + plan_.count());
  }
  if (options.max_observations < 0 && !has_window) {
    config_.capacity.max_observations = std::max(config_.capacity.max_observations, config_.map.features_in_view);
  } else if (options.features_in_view < 0) {  // no more than there is room for
    config_.map.features_in_view =
        std::min(config_.map.features_in_view, has_window ? config_.window.points : config_.capacity.max_observations);
  }
  if (!mask_.read(options.mask, source.info(), config_, error)) {
    code = kExitUsage;
    return false;
  }
  if (!map_file_.read(options.map, error)) {
    code = kExitUsage;
    return false;
  }
  config_.motion.model = options.motion;
  set_length(config_.motion.linear_jerk_density, options.jerk);
  set_length(config_.motion.linear_acceleration_density, options.motion_acceleration);
  set_length(config_.motion.angular_acceleration_density, options.motion_angular_acceleration);
  imu.configure(config_);
  if (options.motion == PF_MOTION_CONSTANT_ACCELERATION && config_.motion.model != options.motion) {
    error = "--motion acceleration: here an inertial unit moves the camera; add --no-inertial, or leave --motion away";
    code = kExitUsage;
    return false;
  }
  config_.camera.estimate = options.lens.value_or(default_estimate(config_));
  config_.clock_ns = clock_ns;
  config_.log = keep_line;
  config_.user = &log_;
  const char* field = "";
  const pf_status_t checked = pf_config_check(&config_, &field);
  if (checked != PF_OK) {
    const std::string name = field != nullptr && field[0] != '\0' ? field : "?";
    pf_config_t by_filter = config_;
    by_filter.backend = PF_BACKEND_FILTER;
    by_filter.map.features_in_view = std::min(by_filter.map.features_in_view, by_filter.capacity.max_observations);
    const std::string wrong = wrong_capacity(name, options, config_);
    if (!wrong.empty()) {
      error = wrong;
    } else if (has_window && pf_config_check(&by_filter, nullptr) == PF_OK) {
      error = "--backend window cannot have this " + name + " yet: leave away what sets it, or take --backend filter";
    } else if (name == "kernels") {
      error = "--kernels: this build or this processor has no such kernels; take --kernels auto";
    } else {
      error = "configuration field '" + name + "' is out of its range; " +
              (name.rfind("camera", 0) == 0 ? "check the calibration" : "planefold.h says what is possible");
    }
    code = kExitUsage;
    return false;
  }
  char message[PF_SEQUENCE_MESSAGE] = "";
  start_ = options.start;
  const bool by_file = options.start == "target" && !source.info().target_path.empty();
  if (by_file || options.start.rfind("target:", 0) == 0) {
    const std::string file = by_file ? source.info().target_path : options.start.substr(7);
    has_target_ = pf_read_target(file.c_str(), &target_, message) == 0;
  } else if (options.start.rfind("rectangle:", 0) == 0) {
    has_target_ = pf_parse_rectangle(options.start.c_str() + 10, &target_, message) == 0;
  } else if (options.start.rfind("pose:", 0) == 0) {
    has_pose_ = pf_read_first_pose(options.start.c_str() + 5, &pose_, message) == 0;
  } else if (options.start == "target") {
    has_target_ = source.target(target_);
    if (!has_target_)
      std::snprintf(message, sizeof(message),
                    "--start target: a folder has its target in target.yaml, a scene shows one or not, and here there "
                    "is none; write target:FILE");
  }
  if (!has_target_ && !has_pose_ && options.start != "auto") {
    error = message;
    code = kExitUsage;
    return false;
  }
  start_note_ = has_target_ ? message : "";
  has_second_pose_ =
      !options.second_pose.empty() && pf_read_first_pose(options.second_pose.c_str(), &second_pose_, message) == 0;
  if (!options.second_pose.empty() && !has_second_pose_) {
    error = message;
    code = kExitUsage;
    return false;
  }
  pf_status_t status = pf_memory_query(&config_, &memory_);
  if (status == PF_OK && posix_memalign(&block_, memory_.alignment, memory_.bytes) != 0) {
    error = "no " + std::to_string(memory_.bytes) + " bytes of memory left for the map; lower --max-state-dim";
    return false;
  }
  if (status == PF_OK) {
    status = pf_create(&config_, block_, memory_.bytes, &slam_);
  }
  if (status != PF_OK) {
    error = std::string("the library could not be set up: ") + pf_status_text(status);
    return false;
  }
  if (!begin(error)) {
    code = plan_.empty() && mask_.empty() && map_file_.empty() ? code : kExitUsage;
    return false;
  }
  return true;
}

bool Session::take_notice(const FrameView& view, std::string& line) {
  if (!start_note_.empty()) {
    line = std::exchange(start_note_, "");
    return true;
  }
  return !plan_.empty() && plan_.take_notice(view, config_.camera, line);
}

bool Session::is_metric() const {
  pf_inertial_t known{};
  return has_target_ || has_pose_ || (pf_get_inertial(slam_, &known) == PF_OK && known.metric != 0);
}

bool Session::begin(std::string& error) {
  if (!map_file_.load(slam_, log_.lines, error)) {  // a context that goes on has been told nothing before
    return false;
  }
  if (!mask_.set(slam_, start_note_, error)) {
    return false;
  }
  if (has_gravity_ && pf_set_gravity(slam_, gravity_W_) < PF_OK) {
    error = "--gravity: the library rejected this direction";
    return false;
  }
  if (has_target_) {
    const pf_status_t status = pf_start_from_target(slam_, &target_);
    if (status < 0) {
      error = "--start " + start_ + ": the target is rejected: " + pf_status_text(status);
      return false;
    }
  }
  if (has_pose_) {
    double velocity_covariance[36] = {};
    for (size_t i = 0; i < 3; ++i) {
      velocity_covariance[7 * i] = kSpeedSigma * kSpeedSigma;
      velocity_covariance[7 * (i + 3)] = kRateSigma * kRateSigma;
    }
    const pf_status_t status = pf_start_from_pose(slam_, &pose_, velocity_covariance);
    if (status < 0) {
      error = "--start " + start_ + ": the pose is rejected: " + pf_status_text(status);
      return false;
    }
  }
  if (has_second_pose_) {
    const pf_status_t status = pf_set_second_pose(slam_, second_pose_.t_ns, &second_pose_);
    if (status < 0) {
      error = std::string("--second-pose: the pose is rejected: ") +
              (status == PF_ERROR_RANGE ? "it lies nearer to the first place than its own sigma, and so tells no scale"
                                        : pf_status_text(status));
      return false;
    }
  }
  if (!plan_.empty() && !map_file_.empty()) {
    error = "--walls: a map says where the run starts, so that a plan cannot";
    return false;
  }
  return plan_.add_to(slam_, error);
}

bool Session::reset(std::string& error) {
  const pf_status_t status = pf_reset(slam_);
  if (status < 0) {
    error = std::string("reset: ") + pf_status_text(status);
    return false;
  }
  was_reset_ = true;
  return begin(error);
}

/// Numbers the maps of the run in which something was tracked, across resets, after which the library counts from 1 again. A map that was
/// joined to an earlier one goes on under that one's number.
void Session::count_map(const FrameView& view) {
  if (was_reset_) {
    map_of_id_.clear();
  }
  was_reset_ = false;
  const auto known = map_of_id_.find(view.report.map_id);
  map_ = known != map_of_id_.end() ? known->second : maps_ + 1;
  if (view.tracked && known == map_of_id_.end()) {
    map_of_id_[view.report.map_id] = map_;
    maps_ = map_;
  }
}

bool Session::push(const pf_image_t& image, FrameView& view, std::string& error) {
  const int64_t before = steady_ns();
  log_.frame = view.index;
  view.status = pf_push_frame(slam_, &image);
  log_.frame = -1;
  view.ms = 1e-6 * static_cast<double>(steady_ns() - before);
  if (view.status < 0) {
    error = std::string("the library rejected it: ") + pf_status_text(view.status);
    if (view.status == PF_ERROR_TIME && !map_file_.empty()) {
      error += "; the map goes on after a later frame: leave out those of before with --skip N";
    }
    return false;
  }
  pf_get_report(slam_, &view.report);
  view.has_pose = pf_get_pose(slam_, &view.pose) == PF_OK;
  pf_get_camera(slam_, &view.camera, nullptr);
  view.has_inertial = pf_get_inertial(slam_, &view.inertial) == PF_OK;
  // Tracked: the library says so (in the frame of the start the target alone carries the pose), or, while the depths are not known
  // yet, a pose from at least 8 gated inliers of this very frame.
  view.tracked =
      view.has_pose && (view.status == PF_OK || (view.report.inliers >= 8 && view.report.state == PF_STATE_STARTING));
  count_map(view);
  view.map = map_;
  size_t count = 0;
  const bool has_window = config_.backend == PF_BACKEND_WINDOW;
  const int features = has_window ? config_.window.points : config_.capacity.max_features;
  view.tracks.resize(static_cast<size_t>(features + (has_window ? features : config_.capacity.max_observations)));
  if (pf_get_matches(slam_, view.tracks.data(), view.tracks.size(), &count) < 0) {
    count = 0;
  }
  view.tracks.resize(std::min(count, view.tracks.size()));
  count = 0;
  view.features.resize(static_cast<size_t>(features));
  if (pf_get_features(slam_, view.features.data(), view.features.size(), &count) < 0) {
    count = 0;
  }
  view.features.resize(std::min(count, view.features.size()));
  count = 0;
  view.patches.resize(static_cast<size_t>(config_.capacity.max_patches));
  pf_get_patches(slam_, view.patches.data(), view.patches.size(), &count);
  view.patches.resize(std::min(count, view.patches.size()));
  view.planes = read_planes(slam_);
  view.anchors = read_anchors(slam_);
  // A new map forgets the direction that the user gave.
  view.has_gravity = (has_gravity_ && view.map == 1) || (view.has_inertial && view.inertial.metric != 0);
  return true;
}

}  // namespace pf::capture
