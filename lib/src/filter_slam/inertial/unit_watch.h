#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter/imu_log.h"
#include "filter/imu_path.h"
#include "filter_slam/inertial/rate_alignment.h"
#include "filter_slam/pose/body_motion.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/frame.h"
#include "frame/settings.h"

/// Decides whether the samples of the inertial unit move the body, and finds out why they may not. See lib/docs/inertial.md.
///
/// While they do, each frame's innovation of the pose is chi-square with six degrees of freedom. The unit's noise is learned from it
/// (UnitNoise). What noise of ten times the stated does not explain either adds up in Page's sum, which finds a change soon and knows no
/// fault by name:   s+ = max(0, s + nis - slack),   doubted where s > bound
///
/// While they do not, since the unit is doubted or since its delay or its axes are open, the camera's own rates are compared with the
/// gyroscope's (RateAlignment): where they fit, samples are used; where they do not, the fit says why.

namespace pf {

/// Why the samples are not used, or not all of them; as pf_imu_reason_t says.
enum class UnitReason : std::uint8_t {
  kNone,
  kWaitsForRotation,
  kWaitsForMotion,
  kContradicts,
  kGyroInDegrees,
  kGyroScale,
  kAxes,
  kLeftHanded,
  kClock,
  kRatesDoNotFit,
  kColumnsSwapped,
  kAccelInG,
  kAccelWithoutGravity,
  kAccelUnit,
  kAccelSign
};

class UnitWatch {
 public:
  UnitWatch(const Settings& settings, Filter& filter, const Frame& frame, const ImuLog& imu, BodyMotion& motion,
            PixelUpdate& update)
      : settings_(settings), filter_(filter), frame_(frame), imu_(imu), motion_(motion), update_(update) {}

  void layout(Arena& arena);
  void init();
  /// Before the body goes from one frame to the next: whether samples move it, which it is prepared for.
  void begin_frame(std::int64_t before_ns, std::int64_t t_ns);
  /// The body as it is now is what this frame's prediction begins from.
  void keep_prior(std::int64_t before_ns);
  /// Before the frame is measured. follows: the frame before was tracked, and so was the pose that this one's prediction begins at.
  void begin_measuring(bool follows);
  /// After it was measured. True where nothing was used of it, since it says so much against the prediction or since hardly anything was
  /// found: then it is to be measured again from another prediction.
  bool is_refused();
  /// Predicts the body as if no samples had come.
  void leave_prediction();
  /// After it was measured again: whether it is tracked now. Where nothing was found this time either, samples are as good as before.
  void settle(bool is_tracked);
  /// After a frame, dt_ns after the one before. True when the unit has just come into doubt.
  bool note(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns);
  /// The map is given up, so there is nothing to prepare: the next one begins without samples.
  void begin_without();
  /// The map had been in metres for so short a time, when samples may have begun to be wrong, that it hangs on the doubted unit.
  bool is_map_on_trial() const;

  /// The delay or the axes are open, and have not been found yet.
  bool is_open() const { return data_ != nullptr && data_->open; }
  /// They are used all the same for as long as the camera rests, where neither matters; or no more.
  void use_at_rest(bool use);
  bool is_used_at_rest() const { return data_ != nullptr && data_->at_rest; }
  /// Once, where this frame's prediction begins with another delay or other axes.
  bool take_alignment();
  /// Why the samples do not move the body. *value: its number; *R_CB: the axes that fit, both as far as the reason has them.
  UnitReason reason(Scalar* value, Mat3* R_CB) const;

  bool doubted() const { return data_ != nullptr && data_->doubted; }
  /// In all.
  std::int64_t doubted_ns() const { return data_ != nullptr ? data_->doubted_ns : 0; }

 private:
  /// The frame that the next interval of rates begins at.
  struct RateBegin {
    std::int64_t t_ns = 0;  ///< 0: there is none
    Quat q_WC = Quat::Identity();
    std::uint32_t generation = 0;  ///< of the filter: once it begins again from a record, its poses are others
  };
  struct Data {
    Scalar sum = 0;
    bool doubted = false, fresh = false;  ///< fresh: it has just come into doubt
    bool passed = false;                  ///< the test; samples are used from the next frame on
    int doubts = 0;
    std::int64_t doubted_ns = 0;
    std::int64_t used_ns = 0;    ///< since it was doubted last
    std::int64_t metric_ns = 0;  ///< for how long the map has been tracked in metres
    std::int64_t sound_ns = 0;   ///< the same when the sum was zero last: since then the samples may have been wrong
    Body prior;                  ///< before this frame's prediction
    std::int64_t prior_ns = 0;
    bool follows = false;       ///< that prediction is by samples alone, from a tracked pose
    bool contradicted = false;  ///< in this frame, by what was found of it
    bool taken_back = false;    ///< in this frame
    Body tracked;               ///< at the last tracked frame
    std::int64_t tracked_ns = 0;
    bool open = false;     ///< the delay or the axes
    bool at_rest = false;  ///< the samples of such a unit are used, since the camera rests
    bool aligned = false;  ///< take_alignment() says so
    RateAlignment rates;
    RateBegin rate_begin;
    int until_fit = 0;  ///< frames
    RateFit fit;        ///< that passed
    UnitReason reason = UnitReason::kNone;
    Scalar reason_value = 0;
    Mat3 reason_R_CB = Mat3::Identity();
  };

  bool is_silent(std::int64_t t_ns) const;
  bool leaves_out() const { return data_->doubted || (data_->open && !data_->at_rest); }
  Scalar contradiction(bool before_was_tracked, bool is_tracked) const;
  void learn_noise(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns);
  bool add_evidence(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns);
  void predict_again(bool by_samples);
  void note_rate();
  void leave_samples(std::int64_t before_ns);
  void return_to_samples(ImuReading reading);
  void use_alignment();
  void compare_rates(bool follows);
  double wanted_span() const;
  bool is_believed(const RateFit& fit) const;
  void find_reason(double at_s);
  Scalar mean_rate() const;

  const Settings& settings_;
  Filter& filter_;
  const Frame& frame_;
  const ImuLog& imu_;
  BodyMotion& motion_;
  PixelUpdate& update_;
  PartPointer<Data, kHasInertial> data_;  ///< null without the inertial motion model, which needs no room then
};

}  // namespace pf
