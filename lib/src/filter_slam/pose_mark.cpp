#include "filter_slam/pose_mark.h"

namespace pf {

Status PoseMark::set(std::int64_t t_ns, bool may_evict, std::int64_t not_since_ns) {
  const int old = map_.mark.camera;
  const bool leaves_rows = old >= 0 && filter_.state().block[old].children == 0;
  const bool fits = leaves_rows || filter_.room() >= kRows;
  if (!fits && !(may_evict && features_.make_rows(kRows, not_since_ns))) return Status::kFull;
  remove();
  map_.mark.camera = filter_.add_reference_camera();
  filter_.pin(map_.mark.camera);
  map_.mark.t_ns = t_ns;
  return Status::kOk;
}

void PoseMark::drop_unsound() {
  if (map_.mark.camera >= 0 && !filter_.block_is_sound(map_.mark.camera)) remove();
}

void PoseMark::remove() {
  if (map_.mark.camera >= 0) filter_.unpin(map_.mark.camera);
  map_.mark = Mark();
}

}  // namespace pf
