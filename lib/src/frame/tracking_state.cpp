#include "frame/tracking_state.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"

namespace pf {

namespace {

/// Of a frame that is not tracked: the first condition that it does not meet, in the order in which they are tested.
FrameReason reason_of(const FrameReport& report, int min_inliers, bool unusable, bool lens_kept) {
  if (unusable) return FrameReason::kUncertain;
  if (!lens_kept) return FrameReason::kLens;
  if (report.attempts == 0) return FrameReason::kNothingInView;
  if (report.matches < min_inliers) return FrameReason::kFewFound;
  return std::max(report.consensus, report.inliers) < min_inliers ? FrameReason::kDisagree : FrameReason::kImprobable;
}

/// With the numbers that the reason depends on. since_s: the last tracked frame.
void log_loss(const Hooks& hooks, const FrameReport& report, const PoseBelief& belief, int min_inliers,
              std::uint32_t map_id, double since_s) {
  const auto log = [&](const auto&... parts) {
    hooks.say("map ", map_id, " lost, ", fixed(since_s, 2), " s after its last tracked frame: ", parts...);
  };
  if (report.reason == FrameReason::kNothingInView)
    log("nothing of the map is in view");
  else if (report.reason == FrameReason::kFewFound)
    log(report.matches, " of ", report.attempts, " features are found, ", min_inliers, " are needed");
  else if (report.reason == FrameReason::kDisagree)
    log(std::max(report.consensus, report.inliers), " features agree with one pose, ", min_inliers, " are needed");
  else if (report.reason == FrameReason::kUncertain)
    log("the pose is too uncertain, by ", report.inliers, " features");
  else if (report.reason == FrameReason::kLens)
    log("the image is not that of the calibrated lens, log-odds ", fixed(belief.lens().log_odds(), 1));
  else
    log("the pose is improbable, log-odds ", fixed(belief.log_odds(), 1));
}

}  // namespace

Status TrackingState::conclude(const StartProgress& start, std::int64_t max_coast_ns, const Hooks& hooks,
                               FrameReport* report) {
  Data& d = data_;
  if (!d.has_pose) return Status::kStarting;
  const bool tracked = is_tracked(*report);
  if (tracked) {
    if (d.lost)
      hooks.say("map ", d.map_id, " found again: ", report->inliers, " of ", report->matches,
                " found features agree with the pose, log-odds ", fixed(d.belief.log_odds(), 1));
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
    hooks.say("the lens has changed (zoom, focus, another sensor), log-odds ", fixed(d.belief.lens().log_odds(), 1),
              ": the image is that of ", fixed(std::exp(d.belief.lens().log_ratio()), 3),
              " times the calibrated focal length; calibrate it, or keep it fixed");
  }
  if (!d.lost && elapsed_ns(d.last_tracked_ns, report->t_ns) > max_coast_ns) {
    d.lost = true;
    log_loss(hooks, *report, d.belief, settings_.min_inliers, d.map_id,
             seconds(elapsed_ns(d.last_tracked_ns, report->t_ns)));
  }
  d.state = d.lost ? SlamState::kLost : SlamState::kCoasting;
  return d.lost ? Status::kLost : Status::kCoasting;
}

}  // namespace pf
