#ifndef PLANEFOLD_CAPTURE_IMU_FEED_H
#define PLANEFOLD_CAPTURE_IMU_FEED_H

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "imu.h"
#include "imu_recorder.h"
#include "notices.h"
#include "rejections.h"
#include "time_offset.h"

namespace pf::capture {

/// Brings the samples up to a frame's time to the library before the frame, and to the recording.
class ImuFeed {
 public:
  /// false: error is one line and code the exit code. beside is the file that lies beside the frames, or "".
  bool open(const Options& options, const Source& source, const std::string& beside, std::string& error, int& code);
  /// For the library's config.
  void configure(pf_config_t& config) const;
  bool start(std::string& error) { return imu_ == nullptr || imu_->start(error); }
  /// The same folder as the frames'. false: error is one line.
  bool record_to(const std::string& folder, std::string& error);

  /// Before the frame of this time is pushed.
  void push_until(int64_t t_ns, pf_slam_t* slam);
  /// After it was pushed, as frame number `index` of the run.
  void add_frame(int64_t index, const pf_slam_t* slam, const pf_pose_t& pose, bool tracked);
  bool take_notice(std::string& notice);
  /// true: samples could not be recorded, and error is one line.
  bool failed(std::string& error) const {
    error = failure_.empty() ? error : failure_;
    return !failure_.empty();
  }
  /// Closes the recording. false: error is one line.
  bool finish(std::string& error) { return recorder_.close(error); }
  /// Poses depend on the samples.
  bool is_inertial() const { return inertial_; }
  /// JSON for report.json. advice: one line on the unit's clock, or "".
  std::string report(const pf_slam_t* slam, std::string& advice) const;
  /// What of the unit the pictures contradict.
  void add_rejections(const pf_slam_t* slam, std::vector<Rejection>& rejections) const;

 private:
  void choose_sigmas(const Options& options);
  void note_axes(const pf_slam_t* slam);
  void tell_vertical(pf_slam_t* slam);

  std::unique_ptr<Imu> imu_;
  ImuRecorder recorder_;
  TimeOffsetEstimator offset_;
  std::vector<pf_imu_sample_t> samples_;
  Notices notices_;
  std::string failure_;  ///< of the recording
  pf_imu_model_t model_{};
  bool open_axes_ = false;  ///< no mounting was given
  double sigma_delay_s_ = 0.0;
  bool inertial_ = false;
  double vertical_rad_ = 0.0;                 ///< to which planes are told to be vertical; 0: they are not
  std::set<uint32_t> looked_at_;              ///< planes that were told, or that contradict it
  int64_t vertical_ = 0;                      ///< planes that were told
  int64_t metric_frame_ = -1;                 ///< the first one whose lengths the samples tell
  bool moving_ = false;                       ///< .. from a camera that moved
  double metric_at_s_ = 0.0, first_s_ = 0.0;  ///< [s] of the frames' clock
  double offset_s_ = 0.0;
  bool live_ = false, tries_readout_ = false, readout_given_ = false;
  int64_t frames_ = 0, between_ = 0, refused_ = 0;  ///< between_: samples after the first frame
};

}  // namespace pf::capture

#endif
