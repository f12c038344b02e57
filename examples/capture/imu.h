#ifndef PLANEFOLD_CAPTURE_IMU_H
#define PLANEFOLD_CAPTURE_IMU_H

#include <planefold/planefold.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "options.h"

namespace CLI {
class App;
}
struct pf_sim;

namespace pf::capture {

/// Inertial samples, in order of time, on the clock of the frames once the offset of --imu-offset is added.
class Imu {
 public:
  virtual ~Imu() = default;
  /// From here on samples are collected. false: error is one line.
  virtual bool start(std::string& error) = 0;
  /// Moves the samples up to a time to the end of the list. A unit that measures now is waited for, but not for long.
  virtual void take(int64_t until_ns, std::vector<pf_imu_sample_t>& samples) = 0;
  /// One line that the user should know, if there is one (unplugged, back again).
  virtual bool take_notice(std::string&) { return false; }
  virtual std::string name() const = 0;
  /// What can be measured [rad/s], [m/s^2]; 0: not known.
  virtual double gyro_range() const { return 0.0; }
  virtual double accel_range() const { return 0.0; }
  /// Noise and mounting, where the unit itself knows them; null: it does not.
  virtual const pf_imu_model_t* model() const { return nullptr; }
  /// JSON for report.json, "" where there is nothing to say.
  virtual std::string report() const { return ""; }
  /// The time of the first frame, before samples are taken: for units whose clock begins with it.
  virtual void begin_at(int64_t /*t_ns*/) {}
};

/// A table in EuRoC layout. first_at_frame: its first sample has the time of the first frame that is asked for. null: error is one line.
std::unique_ptr<Imu> open_imu_file(const std::string& path, int64_t offset_ns, bool first_at_frame, std::string& error);

/// A unit of this machine through the kernel's IIO. rate_hz 0: as it is.
std::unique_ptr<Imu> open_imu_device(const std::string& name, double rate_hz, int64_t offset_ns, std::string& error);

/// A unit in a simulated scene.
std::unique_ptr<Imu> open_imu_sim(const pf_sim* scene, uint64_t seed, int64_t offset_ns);

class Source;
/// What --imu asks for; with "auto", beside is the file that lies beside the frames ("": none). null with an empty error: no IMU.
std::unique_ptr<Imu> open_imu(const Options& options, const Source& source, const std::string& beside,
                              std::string& error);

void add_imu_options(CLI::App& app, Options& options);
/// "" when all is well.
std::string check_imu_options(const Options& options);

/// Prints the IMUs of this machine, after the cameras; returns the exit code that it was given.
int list_imus(int code);

}  // namespace pf::capture

#endif
