#include "base/archive.h"
#include "session/session.h"

namespace pf {

void Session::carry(Archive& archive) {
  auto& [kind, gravity_W, gravity_map] = data_;
  archive.within(kind, 0, static_cast<int>(FrameKind::kObservations));
  archive.numbers(gravity_W);
  archive.any(gravity_map);
  if (settings_.mask.mask != nullptr) mask_.carry(archive);
  imu_.carry(archive);
  map_.carry(archive, has_filter() ? filter_->filter().state().slots : 1);
  if (has_filter())
    filter_->carry(archive);
  else
    window_->carry(archive);
}

}  // namespace pf
