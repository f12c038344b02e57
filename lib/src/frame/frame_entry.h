#pragma once

#include "frame/frame.h"
#include "frame/frozen_camera.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"

/// What both back ends do with an image before its frame begins, and the status of an unusable image.

namespace pf {

enum class FrameEntry : std::uint8_t {
  kLate,      ///< not after the last frame: rejected
  kRepeated,  ///< repeats the image before, and so its pose and status, under the new time
  kFrozen,    ///< the same, for so long that the camera may be anywhere
  kNew
};

inline bool is_next_frame(const Frame& frame, std::int64_t t_ns) {
  return frame.report.frames == 0 || t_ns > frame.report.t_ns;
}

/// Classifies an image. After kRepeated the frame is finished, and the next prediction begins at the body of the repeated frame.
inline FrameEntry enter_frame(const Settings& settings, const ImageView& image, std::int64_t t_ns, FrozenCamera* frozen,
                              Frame* frame, TrackingState* tracking) {
  if (!is_next_frame(*frame, t_ns)) return FrameEntry::kLate;
  if (!frozen->is_duplicate(image, t_ns)) return FrameEntry::kNew;
  count_frame(&frame->report.duplicates);
  if (tracking->coasting_or_lost() || frozen->frozen_ns(t_ns) > settings.max_coast_ns) return FrameEntry::kFrozen;
  frame->begin(t_ns);
  tracking->repeat(t_ns);
  return FrameEntry::kRepeated;
}

/// Status of a frame that is late or repeated.
inline Status entry_status(FrameEntry entry, const TrackingState& tracking) {
  if (entry == FrameEntry::kLate) return Status::kTime;
  return tracking.state() == SlamState::kTracking ? Status::kOk : Status::kStarting;
}

/// Status of a frame whose image was unusable, from the status that the frame ended with.
inline Status unusable_status(Status ended) {
  return ended == Status::kLost || ended == Status::kStarting ? ended : Status::kUnusable;
}

}  // namespace pf
