#include "options.h"

#include <planefold/planefold_research.h>
#include <planefold_platform/cameras.h>
#include <planefold_platform/version.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include "checked_options.h"
#include "focal_search.h"
#include "imu.h"
#include "map_file.h"
#include "realtime.h"

namespace pf::capture {

namespace {

constexpr const char* kFooter =
    "In the window: space pauses, r resets, s saves the picture, q quits; a click or tap shows which plane it hits,\n"
    "a sets an anchor where the pointer or the last tap is.\n"
    "Writes into --out: report.json, trajectory.txt (TUM), covariance.csv, trajectory_all.txt, frames.csv, map.ply,\n"
    "calib.yaml, overlay.mp4, overlay_mid.png, overlay_last.png, lens.csv where the lens is estimated,\n"
    "calib_found.yaml where there was no calibration,\n"
    "inertial.csv where a unit's samples are used, anchors.csv where an anchor was set, corrections.csv where the\n"
    "map has moved, and truth.tum and truth_planes.json where the source knows them.\n"
    "Poses in a second map, which has a world of its own, go into trajectory_2.txt and so on.\n"
    "Exit code: 0 done, 1 the run failed, ended early, tracked nothing, or was lost at the end or most of the time,\n"
    "2 the command line is wrong, or a file or folder that it names beside the frames: calibration, start, walls, "
    "noise, mount,\n"
    "map, --out, --record.";

/// A whole number of at least this; CLI11's own checks spell out the largest double.
CLI::Validator at_least(int64_t least) {
  return CLI::Validator(
      [least](std::string& text) {
        int64_t value = 0;
        const bool fits = CLI::detail::lexical_cast(text, value) && value >= least;
        return fits ? std::string() : "'" + text + "' is not a whole number of at least " + std::to_string(least);
      },
      "");
}

void add_camera_options(CLI::App& app, Options& options) {
  const std::string group = "Cameras";
  app.add_option("--record", options.record, "every frame to a new folder in EuRoC layout, for euroc:DIR")
      ->check(not_empty())
      ->group(group);
  app.add_flag("--as-recorded", options.as_recorded, "of a recording, only the frames that were tracked then")
      ->group(group);
  app.add_flag("--every-frame", options.every_frame, "track every frame, however late, instead of the newest")
      ->group(group);
  app.add_flag("--realtime", options.realtime, "play a folder or scene at its own pace, as a camera would")
      ->group(group);
  app.add_option(
         "--format", options.format,
         "any, GREY, NV12, YUYV, UYVY, YU12, NV21, Y10, Y12, Y16, MJPEG or others (a wrong one names them all); of\n"
         "libcamera also YUV420, RGB888 or BGR888")
      ->capture_default_str()
      ->group(group);
  app.add_option("--rate", options.rate_hz, "frames per second to ask the camera for")
      ->check(number_in(0.1, 10000.0))
      ->group(group);
  app.add_option("--exposure", options.exposure_us, "fixed time of exposure, microseconds")
      ->check(number_in(1.0, 1e6))
      ->group(group);
  app.add_option("--focus", options.focus, "autofocus off; the lens goes to this step, or stays (-1)")
      ->check(at_least(-1))
      ->group(group);
  app.add_flag("--dma-buf", options.dma_buf, "export the camera's buffers and synchronise every access")->group(group);
  app.add_option("--cpu", options.processor, "processor of the tracker")->check(at_least(0))->group(group);
  app.add_option("--capture-cpu", options.capture_processor, "processor of the capture thread")
      ->check(at_least(0))
      ->group(group);
  app.add_option("--priority", options.priority, "real-time priority, 1 to 98 (needs the right to it)")
      ->check(whole_number_in(1, 98))
      ->group(group);
  app.add_option("--delay", options.delay_ms, "milliseconds added to every frame, as if the processor were slower")
      ->check(number_in(0.0, 10000.0))
      ->group(group);
}

/// Thresholds of planes, in the ranges that the library has them in (pf_config_t::plane).
void add_plane_options(CLI::App& app, Options& options) {
  const std::string group = "Planes (in metres; in the unit of the map where it has no metres)";
  const auto add = [&](const char* name, double& value, double low, double high, const char* help) {
    app.add_option(name, value, help)->check(number_in(low, high))->group(group);
  };
  add("--fix-sigma", options.fix_sigma, 0.0, 10.0,
      "a folded point whose standard deviation in its plane is below this is estimated no more; 0: never");
  add("--fold-sigma", options.fold_sigma, 1e-5, 10.0,
      "a point can be folded into a plane when its standard deviation is below this");
  add("--plane-distance", options.plane_distance, 1e-5, 10.0, "largest distance of a point from a new plane");
  add("--plane-radius", options.plane_radius, 0.01, 1e4, "largest distance of a point from a new plane's origin");
  add("--plane-roughness", options.plane_roughness, 1e-6, 1.0,
      "standard deviation of the points of a real surface from their plane");
  app.add_option("--plane-points", options.plane_points, "a new plane has more points than this")
      ->check(whole_number_in(4, 60))
      ->group(group);
}

/// The first option of planes that was given; "" when none was.
std::string given_plane_option(const Options& options) {
  const std::pair<const char*, double> all[] = {{"--fix-sigma", options.fix_sigma},
                                                {"--fold-sigma", options.fold_sigma},
                                                {"--plane-distance", options.plane_distance},
                                                {"--plane-radius", options.plane_radius},
                                                {"--plane-roughness", options.plane_roughness},
                                                {"--plane-points", options.plane_points}};
  for (const auto& [name, value] : all)
    if (value >= 0.0) return name;
  return "";
}

int refuse(const std::string& line) {
  std::fprintf(stderr, "pf-capture: %s\n", line.c_str());
  return kExitUsage;
}

std::string check_format(const std::string& format, const std::string& kind) {
  const std::vector<std::string> by_v4l2 = {"any",  "GREY", "NV12", "NV21", "YU12", "YV12", "NV16",
                                            "NV61", "422P", "YUYV", "UYVY", "YVYU", "VYUY", "Y10P",
                                            "Y10",  "Y12",  "Y14",  "Y16",  "MJPEG"};
  const std::vector<std::string> by_libcamera = {"any", "GREY", "YUV420", "NV12", "YUYV", "RGB888", "BGR888"};
  const std::vector<std::string>& known = kind == "libcamera" ? by_libcamera : by_v4l2;
  if (std::find(known.begin(), known.end(), format) != known.end()) {
    return "";
  }
  std::string names = known[0];
  for (size_t i = 1; i < known.size(); ++i) {
    names += (i + 1 < known.size() ? ", " : " or ") + known[i];
  }
  return "--format " + format + ": write " + names;
}

std::string read_gravity(const std::vector<double>& numbers, Options& options) {
  if (numbers.empty()) {
    return "";
  }
  double length = 0.0;
  for (size_t i = 0; i < 3; ++i) {
    options.gravity_W[i] = numbers[i];
    length += numbers[i] * numbers[i];
  }
  options.has_gravity = length > 0.0 && std::isfinite(length);
  return options.has_gravity ? "" : "--gravity needs a direction: three finite numbers that are not all 0, as in 0,1,0";
}

std::string read_taps(const std::string& option, const std::vector<std::string>& texts,
                      std::vector<Options::Tap>& taps) {
  for (const std::string& text : texts) {
    long long frame = -1;
    Options::Tap tap{};
    char rest = '\0';
    if (std::sscanf(text.c_str(), "%lld,%lf,%lf%c", &frame, &tap.pixel[0], &tap.pixel[1], &rest) != 3 || frame < 0 ||
        !std::isfinite(tap.pixel[0]) || !std::isfinite(tap.pixel[1])) {
      return option + " " + text + ": write FRAME,U,V, as in 120,160.5,90";
    }
    tap.frame = frame;
    taps.push_back(tap);
  }
  return "";
}

/// What CLI11 cannot check by itself; "" when all is well.
std::string check(const Options& options, const std::string& backend) {
  const std::string kind = options.source.substr(0, options.source.find(':'));
  const bool is_camera = platform::is_camera(options.source);
  if (options.source.find(':') == std::string::npos ||
      (kind != "images" && kind != "euroc" && kind != "tum" && kind != "video" && kind != "sim" && !is_camera)) {
    return "source '" + options.source +
           "': write v4l2:DEVICE, libcamera:NUMBER, video:FILE, images:DIR, euroc:DIR, tum:DIR or sim:NAME";
  }
  std::string wrong = check_format(options.format, kind);
  if (!wrong.empty()) {
    return wrong;
  }
  if (options.fov_deg > 0.0 && (is_camera || kind == "sim")) {
    return "--fov is for films and folders: a camera needs its calibration, and a scene has its own";
  }
  if (options.fov_deg > 0.0 && !options.calibration.empty()) {
    return "--fov and --calib: a calibration says the focal length; leave one of them away";
  }
  if (options.every_frame && !is_camera && !options.realtime) {
    return "--every-frame is for cameras and --realtime; without these every frame is tracked anyway";
  }
  if (!options.camera.empty() && kind == "sim" && options.calibration.empty()) {
    return "--camera chooses from a calibration file: add --calib FILE";
  }
  if (options.skip > 0 && is_camera) {
    return "--skip is for folders and scenes; a camera has no frames to leave out";
  }
  if (options.every > 1 && kind != "images" && kind != "euroc" && kind != "tum") {
    return "--every is for folders: images:DIR, euroc:DIR or tum:DIR";
  }
  if (options.rate_hz > 0.0 && !is_camera) {
    return "--rate is for cameras; of images without times it is rate_hz in their calibration";
  }
  if (!is_camera && (options.exposure_us > 0.0 || options.focus >= -1 || options.format != "any" || options.dma_buf)) {
    return "--format, --exposure, --focus and --dma-buf are for cameras";
  }
  if (options.capture_processor >= 0 && !is_camera && !options.realtime) {
    return "--capture-cpu is for cameras and --realtime; without these the tracker reads the frames itself";
  }
  for (const auto& [option, processor] :
       {std::pair("--cpu", options.processor), std::pair("--capture-cpu", options.capture_processor)}) {
    const std::string there = processors_there();
    if (processor >= 0 && !names_processor(there, processor)) {
      return std::string(option) + " " + std::to_string(processor) + ": there is no such processor here; there are " +
             there;
    }
  }
  if (options.sim_rest_s > 0.0 && kind != "sim") {
    return "--rest is for sim: sources";
  }
  const std::vector<double>& swing = options.sim_swing;
  if (!swing.empty() && kind != "sim") {
    return "--swing is for sim: sources";
  }
  if (!swing.empty() && !(swing.size() == 3 && swing[0] >= 0.0 && swing[1] >= swing[0] + 1.0 && swing[1] <= 1e6 &&
                          swing[2] > 0.0 && swing[2] <= 1000.0)) {
    return "--swing needs two times in seconds, at least 1 apart, and a rate of up to 1000 degrees a second, as in "
           "8,11,200";
  }
  if (options.imu == "sim" && (kind != "sim" || options.realtime)) {
    return "--imu sim is for sim: sources, without --realtime";
  }
  if (options.loop > 0 && (is_camera || options.realtime || options.there_and_back || options.as_recorded)) {
    return "--loop is for folders and scenes, without --realtime, --there-and-back and --as-recorded";
  }
  if (options.loop > 0 && options.imu != "auto" && options.imu != "none") {
    return "--loop: inertial samples have no second lap; leave --imu away";
  }
  if (options.there_and_back && (is_camera || options.realtime)) {
    return "--there-and-back is for folders and scenes, without --realtime: a camera cannot go back";
  }
  if (options.there_and_back && options.imu != "auto" && options.imu != "none") {
    return "--there-and-back: inertial samples have no way back; leave --imu away";
  }
  const std::vector<double>& cover = options.cover_s;
  if (!cover.empty() && is_camera) {
    return "--cover is for folders and scenes: cover the camera's lens with a hand";
  }
  if (!cover.empty() && !(cover.size() == 2 && cover[0] >= 0.0 && cover[1] > cover[0] && cover[1] < 1e6)) {
    return "--cover needs two times in seconds, as in 7,8: from 7 s to 8 s after the first frame";
  }
  if (options.as_recorded && kind != "euroc") {
    return "--as-recorded is for a recording: --source euroc:DIR";
  }
  if (options.start != "auto" && options.start != "target" && options.start.rfind("target:", 0) != 0 &&
      options.start.rfind("rectangle:", 0) != 0 && options.start.rfind("pose:", 0) != 0) {
    return "--start " + options.start + ": write auto, pose:FILE, target:FILE or rectangle:WxH (metres)";
  }
  if (options.start == "target:" || options.start == "pose:") {
    return "--start " + options.start + " names no file; write " + options.start + "FILE";
  }
  if (options.withdraw_target_after >= 0 && (options.start == "auto" || options.start.rfind("pose:", 0) == 0)) {
    return "--withdraw-target-after needs a target: add --start target:FILE or --start rectangle:WxH";
  }
  const std::string wrong_imu = check_imu_options(options);
  if (!wrong_imu.empty()) {
    return wrong_imu;
  }
  if (backend != "filter" && backend != "window") {
    return "--backend " + backend + ": write filter or window";
  }
  if (backend != "window" && (options.window_keyframes >= 0 || options.window_fixed >= 0)) {
    return std::string(options.window_keyframes >= 0 ? "--window-keyframes" : "--window-fixed") +
           " needs --backend window";
  }
  if (backend == "window" && (options.max_state_dim >= 0 || options.max_observations >= 0)) {
    return std::string(options.max_state_dim >= 0 ? "--max-state-dim" : "--max-observations") +
           " is for --backend filter; the room of the window is --max-features and --window-keyframes";
  }
  if (!options.second_pose.empty() && backend != "window") {
    return "--second-pose needs --backend window";
  }
  if (!options.second_pose.empty() && options.start != "auto" && options.start.rfind("pose:", 0) != 0) {
    return "--second-pose: a target gives the scale already; write --start auto or pose:FILE";
  }
  return "";
}

}  // namespace

Parsed parse_options(int argc, char** argv, Options& options, int& code) {
  for (int i = 0; i < argc; ++i) {
    options.command += std::string(i == 0 ? "" : " ") + argv[i];
  }
  CLI::App app{"Tracks the camera through a sequence of images and builds a map of points."};
  app.footer(kFooter);
  std::string backend = "filter";
  std::string kernels = "auto";
  std::string lens = "auto";
  std::string masks = "none";
  std::string motion = "velocity";
  std::string timestamps, map_kind;
  std::vector<double> gravity;
  std::vector<std::string> taps, anchors;
  bool no_film = false;
  bool no_gauge = false;
  bool no_planes = false;
  bool no_points = false;
  const std::map<std::string, pf_camera_estimate_t> lens_names = {
      {"exact", PF_CAMERA_EXACT}, {"consider", PF_CAMERA_CONSIDER}, {"estimate", PF_CAMERA_ESTIMATE}};
  const std::map<std::string, int32_t> mask_names = {
      {"none", PF_MASKS_NONE}, {"partial", PF_MASKS_PARTIAL}, {"whole", PF_MASKS_WHOLE}};
  const std::map<std::string, pf_kernels_t> kernel_names = {
      {"auto", PF_KERNELS_AUTO}, {"reference", PF_KERNELS_REFERENCE}, {"portable", PF_KERNELS_PORTABLE},
      {"avx2", PF_KERNELS_AVX2}, {"avx512", PF_KERNELS_AVX512},       {"neon", PF_KERNELS_NEON}};
  app.set_version_flag("--version", "pf-capture " PF_VERSION_TEXT);
  app.add_option("--source", options.source,
                 "v4l2:/dev/videoN, v4l2:NAME, libcamera:NUMBER, libcamera:NAME, video:FILE, images:DIR (or\n"
                 "images:DIR/left_*.png), euroc:DIR, tum:DIR or sim:NAME");
  app.add_flag("--list", options.list, "name the cameras and IMUs of this machine, and do nothing else");
  app.add_option(
         "--calib", options.calibration,
         "calibration file: Kalibr and OpenVINS (camchain), EuRoC, ROS camera_info (a file, or as printed), OpenCV,\n"
         "VINS-Fusion, OpenVSLAM and stella_vslam, ORB-SLAM, KITTI, COLMAP (cameras.txt) or calib.yaml; without it\n"
         "the one file of these that lies beside the images")
      ->check(not_empty());
  app.add_option("--camera", options.camera,
                 "of a calibration file of several cameras: the name there or its number, as cam1 or 1; of a camchain "
                 "that\n"
                 "--imu-mount names too (the first, or the one that the folder of the images is named after)")
      ->check(not_empty());
  app.add_option("--fov", options.fov_deg,
                 "of a film or folder without a calibration: degrees across, to begin with (of a film 65); focal "
                 "length and\n"
                 "distortion are then estimated, with --backend window where it is not given")
      ->check(number_in(10.0, 150.0));
  app.add_option("--readout", options.readout_s, "rolling shutter: seconds from the first row to the last; 0: global")
      ->check(number_in(0.0, 0.2));
  app.add_option("--start", options.start,
                 "auto, pose:FILE, target:FILE, rectangle:WxH in metres, or target: what a sim: scene shows, or "
                 "target.yaml in\n"
                 "the folder")
      ->capture_default_str();
  app.add_option("--second-pose", options.second_pose,
                 "of the window: file (TUM) with the pose of a later frame at its time; its distance from the first is "
                 "the scale")
      ->check(not_empty());
  app.add_option("--map", options.map,
                 "file of a saved map, in which the run begins lost, or with which it goes on as if it had not ended")
      ->check(not_empty());
  app.add_option("--save-map", options.save_map, "file for the map at the end, for --map")->check(not_empty());
  app.add_option("--map-kind", map_kind,
                 "of --save-map: portable, or continue, with which a run of the same options goes on at the next frame")
      ->check(CLI::IsMember({"portable", "continue"}));
  app.add_option("--walls", options.walls, "file of walls known beforehand, in the frame of the start (JSON)")
      ->check(not_empty());
  app.add_option("--patches", options.patches, "patches of walls that are followed, beside points")
      ->check(whole_number_in(0, 32));
  app.add_flag("--no-points", no_points, "patches of walls alone");
  app.add_option("--withdraw-target-after", options.withdraw_target_after, "measure the target no more after N frames")
      ->check(at_least(0));
  app.add_option("--frames", options.frames, "at most N frames")->check(at_least(1));
  app.add_option("--skip", options.skip, "leave out the first N frames")->check(at_least(0));
  app.add_option("--every", options.every, "of a folder, one frame in N, as from a slower camera")->check(at_least(1));
  app.add_option("--loop", options.loop,
                 "the first N images there and back, again and again, from memory: for runs of a day")
      ->check(at_least(2));
  app.add_option("--cover", options.cover_s, "FROM,TO: frames are black from FROM to TO seconds after the first")
      ->delimiter(',')
      ->expected(1, -1);
  app.add_flag("--there-and-back", options.there_and_back,
               "all frames forwards, then backwards; pf-eval --there-and-back compares the two poses of each image");
  app.add_option("--relative", options.relative,
                 "write the motion over every N frames with its covariance (relative.csv); with truth, its NEES")
      ->check(at_least(1));
  app.add_option("--out", options.out, "folder for what is written; made when it is missing")->capture_default_str();
  app.add_option("--report-every", options.report_every_s, "seconds between refreshed report.json and map.ply")
      ->check(number_in(0.01, 1e9))
      ->capture_default_str();
  app.add_option("--gravity", gravity, "X,Y,Z in W, of any length: planes are called horizontal or vertical")
      ->delimiter(',')
      ->expected(3);
  app.add_option("--tap", taps,
                 "FRAME,U,V: as a click on that pixel of frame FRAME of the run; may come again and again")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--anchor", anchors, "FRAME,U,V: sets an anchor there, as key a; may come again and again")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_flag("--headless", options.headless, "no window");
  app.add_option("--title", options.title,
                 "what window, film and pictures say at the lower edge, in place of the source")
      ->check(not_empty());
  app.add_flag("--no-film", no_film, "no overlay.mp4; the two pictures are still written");
  app.add_flag("--tracks", options.tracks,
               "write tracks.csv, planes.csv and patches.csv: every feature, plane and patch in every frame");
  app.add_flag("--quiet", options.quiet, "no progress line");
  const CLI::Option* given_backend =
      app.add_option("--backend", backend,
                     "filter: a filter over pose and map; window: keyframes and bundle adjustment")
          ->capture_default_str();
  app.add_option(
         "--motion", motion,
         "velocity or acceleration: what stays the same between frames, where no inertial unit moves the camera; the\n"
         "window has velocity")
      ->capture_default_str();
  app.add_option("--jerk", options.jerk, "with --motion acceleration: density of its change, m/s^3/sqrt(Hz)")
      ->check(number_in(1e-9, 1e5));
  app.add_option(
         "--motion-acceleration", options.motion_acceleration,
         "with --motion velocity: density of the acceleration by which the camera may leave it, m/s^2/sqrt(Hz)\n"
         "(1); larger for a shaky hand or robot: wider search ellipses")
      ->check(number_in(1e-9, 1e4));
  app.add_option("--motion-angular-acceleration", options.motion_angular_acceleration,
                 "the same of rotation, rad/s^2/sqrt(Hz) (2)")
      ->check(number_in(1e-9, 1e4));
  const CLI::Option* seed =
      app.add_option("--seed", options.seed, "of a sim: source")->check(at_least(0))->capture_default_str();
  app.add_option("--rest", options.sim_rest_s, "of a sim: source: seconds for which the camera stands still at first")
      ->check(number_in(0.0, 1000.0));
  app.add_option("--swing", options.sim_swing,
                 "FROM,TO,RATE, of a sim: source: from FROM to TO seconds the camera also swings left and right, at up "
                 "to RATE\n"
                 "degrees a second; frames are then blurred over their exposure")
      ->delimiter(',')
      ->expected(1, -1);
  app.add_option("--max-features", options.max_features, "capacity of the map; of the window at least 50")
      ->check(whole_number_in(8, 1000));
  app.add_option("--max-planes", options.max_planes, "planes in the map, walls among them")
      ->check(whole_number_in(1, 64));
  app.add_option("--max-places", options.max_places,
                 "places that are kept, and saved, 0 to 200; the filter keeps some with --map and --save-map alone,\n"
                 "or with this")
      ->check(whole_number_in(0, 200));
  app.add_option("--max-anchors", options.max_anchors, "anchors that are kept, and saved with the map, 0 to 64")
      ->check(whole_number_in(0, 64));
  app.add_option("--max-state-dim", options.max_state_dim, "rows of the covariance")->check(whole_number_in(32, 2000));
  app.add_option("--max-observations", options.max_observations, "features measured in one frame")
      ->check(whole_number_in(8, 200));
  app.add_option("--features-in-view", options.features_in_view, "features to keep in view; with the filter up to 200")
      ->check(whole_number_in(8, 1000));
  app.add_option(
         "--window-keyframes", options.window_keyframes,
         "of the window: keyframes that are adjusted together during its start, 2 to 8; its points are --max-features")
      ->check(whole_number_in(2, 8));
  app.add_option("--window-fixed", options.window_fixed, "of the window: older keyframes held fixed then, 0 to 16")
      ->check(whole_number_in(0, 16));
  app.add_option("--timestamps", timestamps,
                 "times of frames: real (measured) or nominal (counted); as the calibration says")
      ->type_name("KIND");
  app.add_option("--kernels", kernels, "auto, reference, portable, avx2, avx512 or neon")->capture_default_str();
  app.add_option(
         "--lens", lens,
         "exact, consider or estimate: what to make of errors of the calibration, by its sigma fields; auto: "
         "estimate,\n"
         "but for what a sim: scene knows, and with an inertial unit that moves the pose; the window does not consider")
      ->capture_default_str();
  app.add_option("--masks", masks,
                 "none, partial or whole: templates that learn which of their pixels belong to one plane")
      ->capture_default_str();
  app.add_option("--mask", options.mask,
                 "PNG of the images' size, 0 where they do not show the scene (the carrier's body, a date), else 255; "
                 "auto:\n"
                 "mask.png beside the frames, where there is one; or none")
      ->check(not_empty())
      ->capture_default_str();
  app.add_flag("--no-planes", no_planes, "points only");
  app.add_flag("--plain-ekf", no_gauge, "the textbook filter, which is overconfident; for comparison");
  add_plane_options(app, options);
  add_camera_options(app, options);
  add_imu_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      code = app.exit(error);
    } else {
      code = refuse(what_is_wrong(app, error) + "; see pf-capture --help");
    }
    return Parsed::kExit;
  }
  if (options.list) {
    return Parsed::kRun;
  }
  if (options.source.empty()) {
    code = refuse("--source is required; see pf-capture --help");
    return Parsed::kExit;
  }
  if (!timestamps.empty()) {
    options.timestamps = timestamps == "nominal" ? PF_TIMESTAMPS_NOMINAL : PF_TIMESTAMPS_REAL;
  }
  if (options.walls.empty() && (no_points || options.patches > 0)) {
    code = refuse(std::string(no_points ? "--no-points" : "--patches") + " needs walls: add --walls FILE");
    return Parsed::kExit;
  }
  if (no_points && (options.patches == 0 || options.features_in_view > 0)) {
    code = refuse("--no-points follows patches and no features: leave --patches 0 and --features-in-view away");
    return Parsed::kExit;
  }
  if (no_planes && !given_plane_option(options).empty()) {
    code = refuse(given_plane_option(options) + " is for planes: leave --no-planes away");
    return Parsed::kExit;
  }
  if (given_backend->count() == 0 && is_uncalibrated(options)) backend = "window";
  const auto set = kernel_names.find(kernels);
  std::string wrong = check(options, backend);
  if (wrong.empty() && seed->count() > 0 && options.source.rfind("sim:", 0) != 0) {
    wrong = "--seed is for sim: sources; images of a folder or camera are as they are";
  }
  if (wrong.empty() && options.max_places == 0 && !(options.map.empty() && options.save_map.empty())) {
    wrong = std::string(options.map.empty() ? "--save-map" : "--map") +
            " needs room for places, and --max-places 0 leaves none";
  }
  if (wrong.empty() && !map_kind.empty() && options.save_map.empty()) {
    wrong = "--map-kind is that of the map to save: add --save-map FILE";
  }
  if (wrong.empty() && no_gauge && backend == "window") {
    wrong = "--plain-ekf is for --backend filter: the window is no EKF";
  }
  if (wrong.empty() && !options.save_map.empty()) {
    wrong = why_no_map_can_be_saved(options.save_map);
  }
  if (wrong.empty() && !options.map.empty() && options.start != "auto") {
    wrong = "--map and --start: a run in a saved map begins lost and finds itself; leave one of them away";
  }
  if (wrong.empty() && !timestamps.empty() && timestamps != "real" && timestamps != "nominal") {
    wrong = "--timestamps " + timestamps + ": write real or nominal";
  }
  if (wrong.empty() && set == kernel_names.end()) {
    wrong = "--kernels " + kernels + ": write auto, reference, portable, avx2, avx512 or neon";
  }
  const auto estimate = lens_names.find(lens);
  if (wrong.empty() && lens != "auto" && estimate == lens_names.end()) {
    wrong = "--lens " + lens + ": write auto, exact, consider or estimate";
  }
  if (wrong.empty() && motion != "velocity" && motion != "acceleration") {
    wrong = "--motion " + motion + ": write velocity or acceleration";
  }
  if (wrong.empty() && options.jerk > 0.0 && motion != "acceleration") {
    wrong = "--jerk is for --motion acceleration";
  }
  if (wrong.empty() && options.motion_acceleration > 0.0 && motion != "velocity") {
    wrong = "--motion-acceleration is for --motion velocity; with --motion acceleration write --jerk";
  }
  const auto mask = mask_names.find(masks);
  if (wrong.empty() && mask == mask_names.end()) {
    wrong = "--masks " + masks + ": write none, partial or whole";
  }
  if (!wrong.empty()) {
    code = refuse(wrong);
    return Parsed::kExit;
  }
  wrong = read_gravity(gravity, options);
  wrong = wrong.empty() ? read_taps("--tap", taps, options.taps) : wrong;
  wrong = wrong.empty() ? read_taps("--anchor", anchors, options.anchors) : wrong;
  if (wrong.empty() && !options.anchors.empty() && options.max_anchors == 0) {
    wrong = "--anchor needs room for one: leave out --max-anchors 0, or give it more";
  }
  if (!wrong.empty()) {
    code = refuse(wrong);
    return Parsed::kExit;
  }
  if (map_kind == "continue") options.map_kind = PF_MAP_CONTINUE;
  options.kernels = set->second;
  if (estimate != lens_names.end()) options.lens = estimate->second;
  options.masks = mask->second;
  if (motion == "acceleration") options.motion = PF_MOTION_CONSTANT_ACCELERATION;
  options.backend = backend == "window" ? PF_BACKEND_WINDOW : PF_BACKEND_FILTER;
  options.film = !no_film;
  options.keep_gauge = !no_gauge;
  options.planes = !no_planes;
  options.points = !no_points;
  return Parsed::kRun;
}

}  // namespace pf::capture
