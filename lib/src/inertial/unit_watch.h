#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "filter/imu_log.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "inertial/body_motion.h"
#include "inertial/rate_check.h"
#include "inertial/unit_evidence.h"
#include "inertial/unit_mode.h"

/// Decides whether the samples of the inertial unit move the body (UnitMode), by the frames' evidence (lib/docs/theory/inertial.md).

namespace pf {

class Archive;

class UnitWatch {
 public:
  UnitWatch(const Settings& settings, Filter& filter, const Frame& frame, const ImuLog& imu, BodyMotion& motion)
      : settings_(settings), filter_(filter), frame_(frame), imu_(imu), motion_(motion) {}

  void layout(Arena& arena);
  void init();
  UnitMode mode() const { return parts_ != nullptr ? parts_->data.mode : UnitMode::kAbsent; }
  /// Begins a frame: decides whether samples move the body from one frame to the next, and prepares it.
  void begin_frame(std::int64_t before_ns, std::int64_t t_ns);
  /// Keeps the body from which this frame's prediction begins.
  void keep_prior(std::int64_t before_ns);
  /// Before the frame is measured. follows: the frame before was tracked, and so was the pose that this one's prediction begins at. Returns
  /// the bound on the NIS of its pose above which it contradicts that prediction; 0: none.
  Scalar begin_measuring(bool follows);
  /// After it was measured. is_contradicted: its pose is beyond that bound. True where none of it was used, because it contradicts the
  /// prediction too strongly or hardly anything was found: then it is to be measured again from another prediction.
  bool is_refused(bool is_contradicted);
  /// Predicts the body as if no samples had come.
  void leave_prediction();
  /// After the frame was measured again. is_tracked: it is tracked now. If not, the frame is no evidence against the samples.
  void settle(bool is_tracked);
  /// Notes a frame, dt_ns after the one before. True when images have just contradicted the unit.
  bool note(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns);
  /// An event that concerns the unit. At the beginning and the end of a rest the comparison of rates starts anew.
  void take(UnitEvent event);
  /// UnitEvidence
  Scalar sum() const { return parts_->evidence.sum(); }
  bool is_map_on_trial() const { return parts_->evidence.is_map_on_trial(); }

  /// True where the clock or the axes are open and not found yet.
  bool is_open() const { return parts_ != nullptr && parts_->rates.is_open(); }
  /// True once, when this frame's prediction begins with another delay or other axes.
  bool take_alignment();
  /// RateCheck
  UnitReason reason(Scalar* value, Mat3* R_CB) const {
    return parts_ != nullptr ? parts_->rates.reason(value, R_CB) : UnitReason::kNone;
  }
  /// Total time for which the unit has been rejected.
  std::int64_t rejected_ns() const { return parts_ != nullptr ? parts_->data.rejected_ns : 0; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    UnitMode mode = UnitMode::kAbsent;
    std::int64_t rejected_ns = 0;
    Body prior;  ///< before this frame's prediction
    std::int64_t prior_ns = 0;
    bool follows = false;          ///< that prediction is by samples alone, from a tracked pose
    bool is_contradicted = false;  ///< in this frame, by what was found of it
    bool is_taken_back = false;    ///< in this frame
    Body tracked;                  ///< at the last tracked frame
    std::int64_t tracked_ns = 0;
    bool is_aligned = false;          ///< set by take_alignment()
    bool is_worse_than_none = false;  ///< in this frame: taken back, and samples had predicted worse than none
    Body by_samples, by_none;         ///< of a frame that was taken back: its two predictions
    Mat6 P_by_none = Mat6::Zero();    ///< covariance of the latter's (theta, p)
  };

  struct Parts {
    UnitEvidence evidence;
    RateCheck rates;
    Data data;
  };

  bool is_silent(std::int64_t t_ns) const;
  void predict_again(bool by_samples);
  bool is_worse_than_none() const;
  void note_rate();
  void leave_samples(std::int64_t before_ns);
  void return_to_samples(ImuReading reading);
  void use_alignment(const RateFit& fit);
  void set_mode(UnitMode mode);

  const Settings& settings_;
  Filter& filter_;
  const Frame& frame_;
  const ImuLog& imu_;
  BodyMotion& motion_;
  PartPointer<Parts, kHasInertial> parts_;  ///< null without the inertial motion model, which needs no room then
};

}  // namespace pf
