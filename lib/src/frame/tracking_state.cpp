#include "frame/tracking_state.h"

#include <algorithm>

#include "base/elapsed.h"

namespace pf {

namespace {

const char* text_of_loss(FrameReason reason) {
  switch (reason) {
    case FrameReason::kNothingInView:
      return "lost: nothing of the map was in view for too long";
    case FrameReason::kFewFound:
      return "lost: too few features were found for too long";
    case FrameReason::kDisagree:
      return "lost: too few features agreed with one pose for too long";
    case FrameReason::kImprobable:
      return "lost: no pose was believed for too long";
    case FrameReason::kUncertain:
      return "lost: the pose was too uncertain for too long";
    case FrameReason::kLens:
      return "lost: pictures have not been those of the calibrated lens for too long";
    case FrameReason::kNone:
      break;
  }
  return "lost";
}

/// Of a frame that is not tracked: the first condition that it does not meet, in the order in which they are tested.
FrameReason reason_of(const FrameReport& report, int min_inliers, bool unusable, bool lens_kept) {
  if (unusable) return FrameReason::kUncertain;
  if (!lens_kept) return FrameReason::kLens;
  if (report.attempts == 0) return FrameReason::kNothingInView;
  if (report.matches < min_inliers) return FrameReason::kFewFound;
  return std::max(report.consensus, report.inliers) < min_inliers ? FrameReason::kDisagree : FrameReason::kImprobable;
}

const char* text_of_change(Scalar log_ratio) {
  return log_ratio > 0 ? "the picture is larger than the calibration says: the lens has changed (zoom, focus, another "
                         "sensor); it has to be calibrated, or held as it was"
                       : "the picture is smaller than the calibration says: the lens has changed (zoom, focus, another "
                         "sensor); it has to be calibrated, or held as it was";
}

}  // namespace

Status TrackingState::conclude(const StartProgress& start, std::int64_t max_coast_ns, const Hooks& hooks,
                               FrameReport* report) {
  Data& d = data_;
  if (!d.has_pose) return Status::kStarting;
  const bool tracked = is_tracked(*report);
  if (tracked) {
    if (d.lost) hooks.say("found the map again");
    d.lost = false;
    d.usable_ns = 0;
    d.last_tracked_ns = report->t_ns;
    // A map that begins after a loss is tracked once a further frame agrees with the one that gave it its depths.
    const bool starting = start.pending() || (d.may_skip_target && !d.depths_known);
    d.depths_known = !start.pending();
    d.state = starting ? SlamState::kStarting : SlamState::kTracking;
    return starting ? Status::kStarting : Status::kOk;
  }
  if (start.recording && d.last_tracked_ns == report->t_ns) {  // the start has just begun, perhaps anew
    d.lost = false;
    d.usable_ns = 0;
    d.state = SlamState::kStarting;
    return Status::kStarting;
  }
  report->reason = reason_of(*report, settings_.min_inliers, d.unusable, d.belief.lens().is_kept());
  if (d.belief.lens().has_changed() && !d.lens_said) {
    d.lens_said = true;
    hooks.say(text_of_change(d.belief.lens().log_ratio()));
  }
  if (!d.lost && elapsed_ns(d.last_tracked_ns, report->t_ns) > max_coast_ns) {
    d.lost = true;
    hooks.say(text_of_loss(report->reason));
  }
  d.state = d.lost ? SlamState::kLost : SlamState::kCoasting;
  return d.lost ? Status::kLost : Status::kCoasting;
}

}  // namespace pf
