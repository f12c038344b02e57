#include <CLI/CLI.hpp>
#include <cmath>

#include "imu.h"

namespace pf::capture {

void add_imu_options(CLI::App& app, Options& options) {
  const std::string group =
      "Inertial samples (checked, reported and recorded; no pose of this program depends on them yet)";
  app.add_option("--imu", options.imu, "auto (a file beside the frames), none, csv:FILE, iio:NAME or iio:ACCEL+GYRO")
      ->capture_default_str()
      ->group(group);
  app.add_option("--imu-rate", options.imu_rate_hz, "samples per second to ask an iio: unit for")
      ->check(CLI::Range(0.1, 100000.0))
      ->group(group);
  app.add_option("--imu-offset", options.imu_offset_s,
                 "seconds to add to the unit's times, to be on the camera's clock")
      ->capture_default_str()
      ->check(CLI::Range(-1e6, 1e6))
      ->group(group);
}

std::string check_imu_options(const Options& options) {
  const std::string& imu = options.imu;
  const bool named = (imu.rfind("csv:", 0) == 0 && imu.size() > 4) || imu.rfind("iio:", 0) == 0;
  if (!named && imu != "auto" && imu != "none") {
    return "--imu " + imu + ": write auto, none, csv:FILE, iio:NAME or iio:ACCEL+GYRO";
  }
  return std::isfinite(options.imu_offset_s) ? "" : "--imu-offset: not a finite number of seconds";
}

std::unique_ptr<Imu> open_imu(const Options& options, const std::string& beside, std::string& error) {
  const auto offset_ns = static_cast<int64_t>(std::llround(1e9 * options.imu_offset_s));
  if (options.imu.rfind("csv:", 0) == 0) {
    return open_imu_file(options.imu.substr(4), offset_ns, error);
  }
  if (options.imu.rfind("iio:", 0) == 0) {
    return open_imu_device(options.imu.substr(4), options.imu_rate_hz, offset_ns, error);
  }
  if (options.imu == "auto" && !beside.empty()) {
    std::unique_ptr<Imu> imu = open_imu_file(beside, offset_ns, error);
    if (imu == nullptr) {
      error += "; --imu none leaves it alone";
    }
    return imu;
  }
  return nullptr;
}

}  // namespace pf::capture
