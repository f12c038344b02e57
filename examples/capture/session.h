#ifndef PLANEFOLD_CAPTURE_SESSION_H
#define PLANEFOLD_CAPTURE_SESSION_H

#include <planefold/planefold.h>

#include <map>
#include <string>
#include <vector>

#include "imu_feed.h"
#include "map_file.h"
#include "mask.h"
#include "options.h"
#include "plan.h"
#include "source.h"
#include "view.h"

namespace pf::capture {

/// One planefold context in a block of memory of its own, and the way it was started.
class Session {
 public:
  Session() = default;
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// false: error is one line and code the exit code.
  bool open(const Options& options, const Source& source, const ImuFeed& imu, std::string& error, int& code);

  /// Pushes a frame and copies what it left into view. false: the library refused it, and error is one line.
  /// The time of pf_push_frame alone goes to view.ms.
  bool push(const pf_image_t& image, FrameView& view, std::string& error);

  /// Starts over, in the same way as at first.
  bool reset(std::string& error);
  void withdraw_target() { pf_withdraw_target(slam_); }

  const pf_slam_t* slam() const { return slam_; }
  pf_slam_t* slam() { return slam_; }
  const pf_config_t& config() const { return config_; }
  const pf_memory_t& memory() const { return memory_; }
  const std::string& start() const { return start_; }
  const pf_target_t* target() const { return has_target_ ? &target_ : nullptr; }
  /// Lengths of the world are metres: the start or the inertial unit says so.
  bool is_metric() const;
  const Plan& plan() const { return plan_; }
  /// A line for the user about what this frame has shown. false: there is none.
  bool take_notice(const FrameView& view, std::string& line);
  const std::vector<std::string>& log() const { return log_.lines; }

  /// Lines of the library's log: of a long run the first and the last ones.
  struct Log {
    Log();
    void add(const char* line);

    std::vector<std::string> lines;
    std::vector<std::string> unused;  ///< with room for a line each, so that the log of a long run does not grow
    int64_t frame = -1;               ///< that is being pushed, from 0; negative: none
  };

 private:
  bool begin(std::string& error);
  void count_map(const FrameView& view);

  void* block_ = nullptr;
  pf_slam_t* slam_ = nullptr;
  pf_config_t config_{};
  pf_memory_t memory_{};
  pf_target_t target_{};
  bool has_target_ = false;
  pf_pose_t pose_{};  ///< of the first frame
  bool has_pose_ = false;
  bool has_second_pose_ = false;
  pf_pose_t second_pose_{};
  FrameMask mask_;
  MapFile map_file_;
  Plan plan_;
  bool has_gravity_ = false;
  double gravity_W_[3] = {0.0, 0.0, 0.0};
  std::string start_;
  std::string start_note_;  ///< of the target's file or the mask, until it was told
  Log log_;
  int map_ = 1;                        ///< of the run
  int maps_ = 0;                       ///< in which some frame was tracked
  std::map<uint32_t, int> map_of_id_;  ///< of these, by the library's ids since the last reset
  bool was_reset_ = false;             ///< since the last frame
};

}  // namespace pf::capture

#endif
