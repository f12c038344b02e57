#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "checked_options.h"
#include "imu.h"
#include "source.h"

namespace pf::capture {

void add_imu_options(CLI::App& app, Options& options) {
  const std::string group = "Inertial samples (poses depend on them where --imu-noise says how good they are)";
  app.add_option(
         "--imu", options.imu,
         "auto (a file beside the frames), none, csv:FILE, csv:GYRO+ACCEL or csv:DIR (a file for each sensor),\n"
         "iio:NAME, iio:ACCEL+GYRO or sim (of a sim: source)")
      ->capture_default_str()
      ->group(group);
  app.add_option("--imu-rate", options.imu_rate_hz, "samples per second to ask an iio: unit for")
      ->check(number_in(0.1, 100000.0))
      ->group(group);
  app.add_option("--imu-offset", options.imu_offset_s,
                 "seconds to add to the unit's times, to be on the camera's clock")
      ->capture_default_str()
      ->check(number_in(-1e6, 1e6))
      ->group(group);
  app.add_option("--imu-noise", options.imu_noise,
                 "noise densities: Kalibr's imu.yaml, EuRoC's imu0/sensor.yaml, of imu_utils, ORB-SLAM3, or calib.yaml")
      ->check(not_empty())
      ->group(group);
  app.add_option(
         "--imu-mount", options.imu_mount,
         "where the unit is: T_BS (EuRoC's cam0/sensor.yaml), T_cam_imu (Kalibr's camchain), T_imu_cam (OpenVINS),\n"
         "or that of VINS-Fusion, VINS-Mono or ORB-SLAM")
      ->check(not_empty())
      ->group(group);
  app.add_option(
         "--estimate", options.estimate,
         "mount, delay, readout, scale: estimated from 2 degrees and 2 cm, 10 ms, 10 ms, 1 % about what is given, the\n"
         "others exact; without it mounting and delay are estimated from 3 degrees, 3 cm and any delay within 0.2 s,\n"
         "and scales and axes of the sensors from 1 %")
      ->delimiter(',')
      ->group(group);
  app.add_option("--imu-exact", options.imu_exact, "mount, delay, scale: taken as they are given, and not estimated")
      ->delimiter(',')
      ->group(group);
  app.add_option_function<std::string>(
         "--imu-clock",
         [&options](const std::string& clock) { options.imu_clock_first_sample = clock == "first-sample"; },
         "camera (the clock of the frames) or first-sample: the unit's first sample is as old as the first frame")
      ->check(CLI::IsMember({"camera", "first-sample"}))
      ->group(group);
  app.add_option("--vertical", options.vertical_deg,
                 "degrees within which planes that are found to be vertical are constrained to be so, for walls that "
                 "are built so")
      ->check(number_in(0.01, 28.0))
      ->group(group);
  app.add_flag_callback(
         "--no-inertial", [&options] { options.inertial = false; },
         "count and record the samples; poses do not depend on them")
      ->group(group);
}

std::string check_imu_options(const Options& options) {
  const std::string& imu = options.imu;
  std::error_code ignored;
  const bool named = (imu.rfind("csv:", 0) == 0 && imu.size() > 4) || imu.rfind("iio:", 0) == 0;
  if (!named && std::filesystem::exists(imu, ignored)) {
    return "--imu " + imu + ": of a file or folder write csv:" + imu;
  }
  if (!named && imu != "auto" && imu != "none" && imu != "sim") {
    return "--imu " + imu + ": write auto, none, csv:FILE, csv:GYRO+ACCEL, iio:NAME, iio:ACCEL+GYRO or sim";
  }
  if (imu == "sim" && (!options.imu_noise.empty() || !options.imu_mount.empty())) {
    return "--imu sim: noise and mounting of the simulated unit are known; leave --imu-noise and --imu-mount away";
  }
  if (imu == "none" && (!options.imu_noise.empty() || !options.imu_mount.empty())) {
    return "--imu none: there are no samples; leave --imu-noise and --imu-mount away";
  }
  if (options.imu_noise.empty() && !options.imu_mount.empty() && options.inertial) {
    return "--imu-mount: poses depend on the samples only where their noise is known; add --imu-noise FILE";
  }
  for (const std::string& what : options.estimate) {
    if (what != "mount" && what != "delay" && what != "readout" && what != "scale") {
      return "--estimate " + what + ": write mount, delay, readout, scale or some of them, as mount,delay";
    }
  }
  for (const std::string& what : options.imu_exact) {
    if (what != "mount" && what != "delay" && what != "scale") {
      return "--imu-exact " + what + ": write mount, delay, scale or some of them, as mount,delay";
    }
    if (std::find(options.estimate.begin(), options.estimate.end(), what) != options.estimate.end()) {
      return "--imu-exact " + what + " and --estimate " + what + " exclude each other; leave one of them away";
    }
    if (what == "mount" && options.imu_mount.empty() && imu != "sim") {
      return "--imu-exact mount: no mounting is given; add --imu-mount FILE";
    }
  }
  if (!options.imu_exact.empty() && options.inertial && imu != "sim" && options.imu_noise.empty()) {
    return "--imu-exact: poses depend on the samples only where their noise is known; add --imu-noise FILE";
  }
  if (options.imu_clock_first_sample && (imu == "none" || imu == "sim" || imu.rfind("iio:", 0) == 0)) {
    return "--imu-clock first-sample is for files of samples; leave it away";
  }
  if (!options.estimate.empty() && !options.inertial) {
    return "--estimate: poses depend on no samples with --no-inertial; leave one of them away";
  }
  if (!options.estimate.empty() && imu != "sim" && options.imu_noise.empty()) {
    return "--estimate: poses depend on the samples only where their noise is known; add --imu-noise FILE";
  }
  if (options.vertical_deg > 0.0 && !options.inertial) {
    return "--vertical: gravity is not estimated with --no-inertial; leave one of them away";
  }
  if (options.vertical_deg > 0.0 && imu != "sim" && options.imu_noise.empty()) {
    return "--vertical: gravity is estimated only where the samples' noise is known; add --imu-noise FILE";
  }
  if (options.imu_rate_hz > 0.0 && imu.rfind("iio:", 0) != 0) {
    return "--imu-rate is for iio: units; samples of a file or scene are as they are";
  }
  if (imu == "none" && options.imu_offset_s != 0.0) {
    return "--imu none: there are no samples; leave --imu-offset away";
  }
  return std::isfinite(options.imu_offset_s) ? "" : "--imu-offset: not a finite number of seconds";
}

std::unique_ptr<Imu> open_imu(const Options& options, const Source& source, const std::string& beside,
                              std::string& error) {
  const auto offset_ns = static_cast<int64_t>(std::llround(1e9 * options.imu_offset_s));
  if (options.imu == "sim") {
    std::unique_ptr<Imu> imu = source.imu(offset_ns);
    error = imu != nullptr ? error : "--imu sim: this source has no simulated unit";
    return imu;
  }
  if (options.imu.rfind("csv:", 0) == 0) {
    return open_imu_file(options.imu.substr(4), offset_ns, options.imu_clock_first_sample, error);
  }
  if (options.imu.rfind("iio:", 0) == 0) {
    return open_imu_device(options.imu.substr(4), options.imu_rate_hz, offset_ns, error);
  }
  if (options.imu == "auto" && !beside.empty()) {
    std::unique_ptr<Imu> imu = open_imu_file(beside, offset_ns, options.imu_clock_first_sample, error);
    if (imu == nullptr) {
      error += "; --imu none leaves it alone";
    }
    return imu;
  }
  return nullptr;
}

}  // namespace pf::capture
