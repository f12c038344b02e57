#include "filter/filter.h"

/// The update.

namespace pf {

const Measurement* Filter::views_of(const PixelMeasurement* z, int count) {
  for (int i = 0; i < count; ++i) view_[i] = z[i].view();
  return view_;
}

bool Filter::finish_update(const Measurement* z, int count, const unsigned char* keep, Scalar* nis) {
  Scalar sum;
  const Scalar* dx = blocks_.gain(z, count, keep, &sum);
  if (dx == nullptr) return false;
  if (nis != nullptr) *nis = sum;
  if (!is_step(dx)) return false;
  transport_.skip();
  ScaleRow l;
  if (keep_gauge_) {
    scale_row(&l);
    transport_.begin(state_, blocks_, l);
  }
  apply_error(state_, blocks_, dx);
  if (keep_gauge_) transport_.finish(state_, blocks_);
  blocks_.downdate(transport_.U(), transport_.G(), transport_.rows());
  if (keeps_apart()) end_update_apart(l);
  return true;
}

}  // namespace pf
