#pragma once

#include <cstdint>
#include <string>

#include "phone.h"
#include "run.h"
#include "sim/imu.h"

namespace pfsim {

/// What may be wrong with the unit, from a time on.
enum class VioFault {
  kNone,
  kGap,         ///< no samples for a second
  kStop,        ///< none for the rest of the run
  kLate,        ///< samples of the last 20 ms come after their frame
  kRepeated,    ///< every sample comes twice
  kDisorder,    ///< every tenth sample comes after the next one
  kSaturated,   ///< readings end at half of what the hand does
  kJitter,      ///< time stamps are off by 1 ms
  kScale,       ///< both sensors read 1 % too much
  kClockJump,   ///< the unit's clock jumps by 50 ms
  kFramesStop,  ///< no frames for a second, while samples go on
  kReversed,    ///< readings have the wrong sign for two seconds
  kMount,       ///< the unit is mounted the other way round, by 180 degrees
  kCount
};
/// As on the command line.
const char* name_of(VioFault fault);

/// A hand-held walk through a room with an inertial unit: nothing is known beforehand but the unit's noise.
struct VioOptions {
  double seconds = 60, rate_hz = 30;
  double rest_s = 2;         ///< at the beginning
  bool moving = false;       ///< instead of that it moves from the first frame on, each run in another way
  double blackout_at_s = 0;  ///< no frame shows anything from here on ..
  double blackout_s = 0;     ///< .. for this long
  double sigma_px = 0.5;
  double sigma_gyro_bias = 0.02;  ///< from which a run's biases are drawn [rad/s]
  double sigma_accel_bias = 0.1;  ///< [m/s^2]
  /// From which the errors of the unit's mounting and delay are drawn [rad], [m], [s]; 0: none.
  double sigma_mount_rad = 0, sigma_mount_m = 0, sigma_delay_s = 0;
  /// With which they are estimated; 0: taken as exact.
  double told_mount_rad = 0, told_mount_m = 0, told_delay_s = 0, told_scale = 0;
  int axes =
      -1;  ///< of the unit, that nothing is told of: one of the 24 rotations of a cube on top of its mounting; negative: as they are
  bool phone = false;          ///< the unit is one of a phone (phone.h)
  PhoneParts phone_parts;      ///< of that, what is wrong
  double readout_s = 0;        ///< of the frames' rows
  double sigma_readout_s = 0;  ///< known as that much less, and estimated; 0: known exactly
  double told_readout_s = -1;  ///< known as that, and estimated; negative: as above
  bool as_global = false;      ///< the readout is not known at all
  int points = 300;
  double turn_rad_s = 0;  ///< of a camera on a turntable that rests otherwise
  bool hand = false;      ///< moves before the lens
  bool use_imu = true;
  bool window = false;            ///< the back end; pictures without samples alone
  bool rendered = false;          ///< pictures of the room of 4 m, in place of points
  std::string scene = "room";     ///< of the pictures
  double shake = 1;               ///< times what the hand of that scene shakes
  double noise_grey = 2;          ///< of the pictures
  double sigma_vertical_rad = 0;  ///< planes of that class are told to be vertical; 0: they are not
  VioFault fault = VioFault::kNone;
  double fault_at_s = 10;
  pf::sim::ImuOptions imu;  ///< noise, rate and mounting
};

/// Classes of planes against the surfaces that they are, in pictures.
struct VioPlanes {
  std::int32_t right = 0, wrong = 0, unknown = 0;  ///< at the end
  std::int32_t ever_wrong = 0, early = 0;          ///< over all frames: wrong ones, and any before gravity is known
  std::int32_t told = 0, refused = 0;              ///< to be vertical
};

/// What one run gave besides its frames. Plain data, so that it may lie in memory shared between processes.
struct VioSummary {
  std::int32_t done = 0, frames_tracked = 0, lost = 0, refused = 0;
  std::int32_t metric_frame = -1;  ///< from which on the samples told the scale
  double path_m = 0, end_error_m = 0;
  double scale_error_5s =
      -1;  ///< relative, of distances to points, 5 s after the camera began to move; negative: unknown
  double scale_error_end = -1;
  double nees_gravity = 0, nees_gyro_bias = 0, nees_accel_bias = 0;  ///< sums over frames
  std::int32_t unit_frames = 0;
  double gauge_growth = 0;                    ///< of the information about the six directions
  double worst_sigmas = 0;                    ///< largest position error in its own sigma
  double imu_seconds = 0, frame_seconds = 0;  ///< in all frames
  double nees_after = 0,
         worst_sigmas_after = 0;  ///< of the pose, from 5 s after a fault began on: sum, and largest position error
  std::int32_t frames_after = 0;
  double wander_m = 0, wander_rad = 0;  ///< of a camera that rests to the end: farthest from its first pose in metres
  std::int32_t resting_frames = 0;      ///< in which the pose was held
  double worst_bias_sigmas = 0;         ///< largest error of a bias in its own sigma
  std::int32_t tracked_after = 0, judged_after = 0, refused_samples = 0;
  double mount_error_rad = -1, mount_error_m = -1, delay_error_s = -1;  ///< at the end, where they are estimated
  double readout_error_s = -1,
         readout_sigmas = -1;  ///< of the rows, 10 s after the scale is known or at the end: likewise
  double mount_sigmas = -1;    ///< the largest of their errors along an axis, in its own sigma
  double doubted_at_s = -1;    ///< when the unit first came into doubt, negative: never
  double doubted_s = 0;        ///< for how long it was
  std::int32_t maps = 1;       ///< begun
  double tilt_rad = -1,
         tilt_rms_rad = -1;  ///< of gravity's direction: at the end, and over all frames in which it is known
  VioPlanes planes;
  // Of a start from a moving camera: whether the motion tells anything, when it was believed, and how wrong that is then.
  std::int32_t poor = 0;
  double start_s = -1, start_scale_error = -1, start_scale_sigma = 0, start_tilt_rad = -1;
  std::int32_t dark_end_frame = -1, tracked_again_frame = -1;
};

/// One run. rows has as many entries as the run has frames.
VioSummary run_vio(const VioOptions& options, std::uint64_t seed, FrameRow* rows);
int vio_frames(const VioOptions& options);
/// Whether the motion of a run tells neither scale nor gravity: every tenth, by turns a camera that only rotates and one that moves evenly.
bool is_poor(const VioOptions& options, std::uint64_t seed);

}  // namespace pfsim
