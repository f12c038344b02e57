#ifndef PLANEFOLD_CAPTURE_SOURCE_H
#define PLANEFOLD_CAPTURE_SOURCE_H

#include <planefold/planefold.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "options.h"

namespace pf::capture {

class Imu;
class Recorder;

enum class Read { kDone, kNothing, kUnusable, kEnd, kFailed };

struct SourceInfo {
  pf_camera_t camera{};
  int64_t count = 0;  ///< at most; a simulated camera that drops frames gives fewer, and a camera has no end
  bool endless = false;
  double rate_hz = 30.0;
  std::string truth_path;    ///< a trajectory that lies beside the source; "" where there is none
  std::string imu_path;      ///< inertial samples that lie beside the source; likewise
  std::string mask_path;     ///< a mask of its images; likewise
  std::string target_path;   ///< target.yaml in its folder; likewise
  std::string warning;       ///< lines that the user should know; "" where there are none
  std::string camera_name;   ///< in a calibration of several cameras; "" where it is not known
  std::string device;        ///< of a camera
  bool knows_truth = false;  ///< by truth() for every frame that was read
};

/// Frames by number: a folder, a simulated scene, or a camera, which decides itself which frame comes next.
class Source {
 public:
  virtual ~Source() = default;
  virtual const SourceInfo& info() const = 0;
  /// Frames are read in the order of their numbers. kFailed: error is one line. kUnusable: this frame alone cannot be
  /// read, and error is one line. kNothing: a camera has none yet; ask again.
  /// The pixels are valid until the next call.
  virtual Read read(int64_t index, pf_image_t& image, std::string& error) = 0;
  /// File or name of a frame, for messages.
  virtual std::string name(int64_t index) const = 0;
  /// The true pose of the frame that was read last.
  virtual bool truth(pf_pose_t&) { return false; }
  /// The target that the source itself knows, for --start target.
  virtual bool target(pf_target_t&) const { return false; }

  /// Depth along z [m] and number of the surface (0 and -1: nothing) at each pixel of the frame that was read last, where the source knows
  /// them.
  virtual bool depth(std::vector<float>& /*z*/, std::vector<int32_t>& /*surface*/) const { return false; }
  /// The true planes, n . p = d as (n, d), where the source knows them.
  virtual std::vector<std::array<double, 4>> planes() const { return {}; }

  /// The inertial unit that belongs to a simulated camera; null where there is none. Its times get the offset added.
  virtual std::unique_ptr<Imu> imu(int64_t /*offset_ns*/) const;

  /// Frames may be read in any order, and more than once.
  virtual bool reads_in_any_order() const { return false; }
  /// Where frames come there and back again: the time at which they turn, and how many images there are.
  virtual bool turn(int64_t& /*t_ns*/, int64_t& /*images*/) const { return false; }

  /// What only cameras do.
  virtual bool is_live() const { return false; }
  /// Every frame that comes goes to the recorder too; false: this source leaves that to its reader.
  virtual bool record_to(Recorder&) { return false; }
  /// The frame that was read last has been tracked: its latency ends here.
  virtual void pushed() {}
  /// One line that the user should know, if there is one (unplugged, back again).
  virtual bool take_notice(std::string&) { return false; }
  /// JSON for the report.json of a run that goes on, without what the capture thread knows alone; "" where there is nothing to say.
  virtual std::string report() { return ""; }
  /// Ends capture. JSON for report.json, "" where there is nothing to say.
  virtual std::string finish() { return ""; }
};

/// null: error is one line.
std::unique_ptr<Source> open_source(const Options& options, std::string& error);
/// Whether the command line is why a source cannot be opened: there is no such scene, or a calibration is wrong, the one that is given or
/// the calib.yaml in its folder.
bool is_command_line_wrong(const Options& options);

std::unique_ptr<Source> open_camera_source(const Options& options, std::string& error);

/// The frames of source, black for the time of --cover.
std::unique_ptr<Source> open_cover(const Options& options, std::unique_ptr<Source> source);

/// One frame in options.every of source.
std::unique_ptr<Source> open_every(const Options& options, std::unique_ptr<Source> source);

/// The first options.loop images of the source there and back, again and again. null: error is one line.
std::unique_ptr<Source> open_loop(const Options& options, std::unique_ptr<Source> source, std::string& error);

/// The frames of source forwards, then backwards. null: error is one line.
std::unique_ptr<Source> open_there_and_back(const Options& options, std::unique_ptr<Source> source, std::string& error);

std::unique_ptr<Source> open_sim_source(const Options& options, std::string& error);

}  // namespace pf::capture

#endif
