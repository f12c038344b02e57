#include "frame/tracking_state.h"

#include "base/elapsed.h"

namespace pf {

Status TrackingState::conclude(const FrameReport& report, const StartProgress& start, std::int64_t max_coast_ns,
                               const Hooks& hooks) {
  Data& d = data_;
  if (!d.has_pose) return Status::kStarting;
  const bool tracked = is_tracked(report);
  if (tracked) {
    if (d.lost) hooks.say("found the map again");
    d.lost = false;
    d.usable_ns = 0;
    d.last_tracked_ns = report.t_ns;
    // A map that begins after a loss is believed when a frame agrees with the one that gave it its depths.
    const bool starting = start.pending() || (d.may_skip_target && !d.depths_known);
    d.depths_known = !start.pending();
    d.state = starting ? SlamState::kStarting : SlamState::kTracking;
    return starting ? Status::kStarting : Status::kOk;
  }
  if (start.recording && d.last_tracked_ns == report.t_ns) {  // the start has just begun, perhaps anew
    d.lost = false;
    d.usable_ns = 0;
    d.state = SlamState::kStarting;
    return Status::kStarting;
  }
  if (!d.lost && elapsed_ns(d.last_tracked_ns, report.t_ns) > max_coast_ns) {
    d.lost = true;
    hooks.say("lost: too few features were found for too long");
  }
  d.state = d.lost ? SlamState::kLost : SlamState::kCoasting;
  return d.lost ? Status::kLost : Status::kCoasting;
}

}  // namespace pf
