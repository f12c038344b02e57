#ifndef PLANEFOLD_CAPTURE_OPTIONS_H
#define PLANEFOLD_CAPTURE_OPTIONS_H

#include <planefold/planefold.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pf::capture {

constexpr int kExitDone = 0;
constexpr int kExitRun =
    1;  ///< the run could not begin, ended early, tracked nothing, or was lost at the end or most of the time
constexpr int kExitUsage = 2;  ///< the command line is wrong, or a file that it names beside the frames

constexpr double kDefaultFovDeg = 65.0;  ///< of films without a calibration

/// What the command line asks for. Negative numbers mean that the library's default is kept.
struct Options {
  std::string command;  ///< the whole command line
  std::string source;
  std::string calibration;
  std::string camera;    ///< of a calibration of several; "": the first, or the one that the folder is named after
  double fov_deg = 0.0;  ///< horizontal, of a source that is tracked without its calibration; 0: not given
  std::optional<pf_camera_t> guess;  ///< in place of a calibration, once the size of the images is known
  std::string start = "auto";
  std::string second_pose;             ///< file of a second known pose; "": none
  std::string walls;                   ///< file of a plan; "": none
  int32_t map_kind = PF_MAP_PORTABLE;  ///< pf_map_kind_t of save_map
  std::string map, save_map;  ///< files of the map that the run begins in, and of the one that it leaves; "": none
  int patches = -1;           ///< of walls that are followed; negative: none beside points, kPatchesAlone without
  bool points = true;         ///< false: patches of walls alone
  std::string out = "out/capture";
  std::string title;  ///< of window and film; "": the source
  int64_t withdraw_target_after = -1;
  int64_t frames = -1;
  int64_t skip = 0;
  int64_t every = 1;     ///< one frame in so many, of a folder
  int64_t relative = 0;  ///< frames of a window over which the motion is written, 0: none
  uint64_t seed = 1;
  int32_t max_features = -1;
  int32_t max_planes = -1;
  int32_t max_places = -1;
  int32_t max_anchors = -1;
  int32_t window_keyframes = -1, window_fixed = -1;
  int32_t max_state_dim = -1;
  int32_t max_observations = -1;
  int32_t features_in_view = -1;
  pf_kernels_t kernels = PF_KERNELS_AUTO;
  bool planes = true;
  /// Of pf_config_t::plane: fix_sigma, fold_sigma, max_distance, max_radius and roughness [m], min_points.
  double fix_sigma = -1.0, fold_sigma = -1.0, plane_distance = -1.0, plane_radius = -1.0, plane_roughness = -1.0;
  int32_t plane_points = -1;
  std::optional<pf_camera_estimate_t> lens;  ///< none: what Session makes of the calibration
  pf_backend_t backend = PF_BACKEND_FILTER;
  pf_motion_model_t motion = PF_MOTION_CONSTANT_VELOCITY;  ///< where no samples move the body
  // Densities of the motion's noise; negative: the library's default.
  double jerk = -1.0;                         ///< of constant acceleration
  double motion_acceleration = -1.0;          ///< of constant velocity
  double motion_angular_acceleration = -1.0;  ///< of both
  int32_t masks = PF_MASKS_NONE;
  bool keep_gauge = true;

  std::string mask = "auto";  ///< file; auto: the one beside the frames, if any; none: none
  std::string imu = "auto";
  double imu_rate_hz = 0.0;  ///< 0: as the unit has it
  double imu_offset_s = 0.0;
  std::string imu_noise;              ///< file; "": none
  std::string imu_mount;              ///< likewise
  std::vector<std::string> estimate;  ///< of the unit: mount, delay, readout, near what is given
  double vertical_deg = 0.0;          ///< to which planes of that class are told to be vertical; 0: they are not
  bool inertial = true;               ///< where samples and their noise are there
  double sim_rest_s = 0.0;            ///< of a sim: source, at its beginning
  std::vector<double> sim_swing;      ///< likewise: from and to [s], and the rate [degrees/s]; empty: it does not swing

  // Cameras, and what is played as if it came from one.
  std::string record;
  std::string format = "any";
  double readout_s = -1.0;   ///< negative: as the calibration says
  int32_t timestamps = -1;   ///< pf_timestamps_t; negative: as the calibration says
  double rate_hz = 0.0;      ///< 0: as the calibration or the camera says
  double exposure_us = 0.0;  ///< 0: automatic
  int32_t focus = -2;        ///< -1: locked where it is; -2: left alone
  int32_t processor = -1;    ///< of the tracker; negative: any
  int32_t capture_processor = -1;
  int32_t priority = 0;   ///< real-time priority of the tracker; capture gets one more. 0: none
  double delay_ms = 0.0;  ///< added to every frame's tracking, to see what a slower processor would do
  bool every_frame = false;
  bool realtime = false;
  bool as_recorded = false;
  int64_t loop = -1;  ///< images of a lap; negative: no laps
  bool there_and_back = false;
  std::vector<double> cover_s;  ///< from and to, after the first frame; empty: the lens is never covered
  bool dma_buf = false;
  bool list = false;

  double report_every_s = 60.0;
  bool has_gravity = false;
  double gravity_W[3] = {0.0, 0.0, 0.0};
  struct Tap {
    int64_t frame;
    double pixel[2];
  };
  std::vector<Tap> taps;     ///< as if the user had clicked
  std::vector<Tap> anchors;  ///< as if the user had set one there
  bool headless = false;
  bool film = true;
  bool tracks = false;
  bool quiet = false;
  std::vector<std::string> imu_exact;   ///< of the unit: mount, delay, taken as given
  bool imu_clock_first_sample = false;  ///< the unit's first sample has the time of the first frame
};

enum class Parsed { kRun, kExit };

/// Reads the command line. kExit: there is nothing to run, and code is the exit code; help or one line on what was wrong has
/// been printed.
Parsed parse_options(int argc, char** argv, Options& options, int& code);

}  // namespace pf::capture

#endif
