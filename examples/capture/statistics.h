#ifndef PLANEFOLD_CAPTURE_STATISTICS_H
#define PLANEFOLD_CAPTURE_STATISTICS_H

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "histogram.h"
#include "relative_motion.h"
#include "session.h"
#include "view.h"

namespace pf::capture {

/// Counts over a run, in memory that does not grow with its length; becomes report.json.
class Statistics {
 public:
  void add(const FrameView& view);
  void add_reset() { ++resets_; }
  /// An image that could not be read; why names it.
  void add_unreadable(const std::string& why);
  /// Frames came there and back again: the time at which they turned, and how many images there are.
  void set_turn(int64_t t_ns, int64_t images) {
    turn_ns_ = t_ns;
    turn_images_ = images;
  }

  int64_t frames() const { return frames_; }
  int64_t tracked() const { return tracked_; }
  /// Frames that the library could not use, or that are one flat grey.
  int64_t unusable() const { return std::max(unusable_, flat_); }
  /// Images that could not be read; the first of them with what is wrong with each, and "" where there are none.
  int64_t unreadable() const { return unreadable_; }
  std::string unreadable_line() const;
  int64_t start_frame() const { return start_frame_; }
  /// "" or a line that says that the camera was lost at the end, or most of the time.
  std::string lost_line() const;
  /// Frames whose pixels all equal those of the frame before.
  int64_t duplicates() const { return duplicates_; }

  /// live   JSON of the source's own report, or ""
  /// imu    JSON of what came from the inertial unit, or ""
  /// ended  "" or the line that says why the run ended early
  std::string to_json(const Session& session, const Options& options, const SourceInfo& source,
                      const RelativeMotion& relative, const std::string& live, const std::string& imu,
                      const std::string& ended) const;
  /// One line for people.
  std::string summary(const Session& session) const;

 private:
  void add_folding(const FrameView& view);
  void add_patches(const FrameView& view);
  int64_t frames_ = 0;
  int64_t tracked_ = 0;
  int64_t starting_ = 0;
  int64_t coasting_ = 0;
  int64_t lost_ = 0;
  int64_t losses_ = 0;
  int64_t unusable_ = 0;
  int64_t unreadable_ = 0;
  std::vector<std::string> unreadable_lines_;  ///< of the first of them
  int64_t duplicates_ = 0;
  int64_t repairs_ = 0;  ///< frames in which the covariance had to be repaired
  int64_t flat_ = 0;
  int64_t resets_ = 0;
  int64_t turn_ns_ = 0;
  int64_t turn_images_ = 0;  ///< 0: they did not turn
  int64_t start_frame_ = -1;
  int64_t last_tracked_ = -1;  ///< frame
  struct MapCount {
    int map;
    int64_t start_frame, tracked;
  };
  struct FoldingCount {
    int64_t first_plane = -1;   ///< first tracked frame with a plane
    int64_t frames = 0;         ///< tracked, from kFoldingFrom on
    int64_t frames_plane = 0;   ///< of these, with a plane
    double share_folded = 0.0;  ///< sum over them: folded and fixed among the features of the map
    double share_trial = 0.0;   ///< likewise, those that are on trial on a plane
    double share_saved = 0.0;   ///< sum over them: rows that folding saves among those of points only
  };
  FoldingCount folding_;
  std::vector<MapCount> maps_;  ///< in which something was tracked; at most one per restart_s or reset
  int64_t evicted_ = 0;
  int64_t new_features_ = 0;
  int64_t measured_ = 0;         ///< sum of inliers over all frames
  int64_t learning_frames_ = 0;  ///< in which templates learnt
  double template_area_ = 0.0;   ///< sum over them
  double nis_ = 0.0;
  int64_t nis_dof_ = 0;
  int32_t last_state_ = PF_STATE_STARTING;
  pf_report_t last_report_{};
  std::vector<PlaneView> last_planes_;
  std::vector<Hit> last_hits_;
  Histogram ms_;
  std::map<uint32_t, int32_t> last_patches_;  ///< status of each by its id
  int64_t lost_patches_ = 0, refound_patches_ = 0;
  CountHistogram patches_, cameras_;
  int reasons_[PF_FRAME_REASON_LENS + 1] = {};  ///< frames by pf_frame_reason_t
  CountHistogram inliers_, attempts_, state_dim_, planes_, folded_;
  Histogram stage_ms_[PF_STAGE_COUNT];
};

}  // namespace pf::capture

#endif
