#include "slam/same_view.h"

#include "base/elapsed.h"
#include "geometry/so3.h"
#include "slam/tuning.h"

namespace pf {

void SameView::note(const Body& body, Scalar median_depth, Scalar focal_px) {
  if (data_.frames == 0 || has_moved(body, median_depth, focal_px)) data_ = {body.q_WC, body.p_W, 0};
  count_frame(&data_.frames);
}

/// How far points at the median depth move in the picture, roughly: f (|theta| + |t| / depth).
bool SameView::has_moved(const Body& body, Scalar median_depth, Scalar focal_px) const {
  const Scalar rotation = log_so3(data_.q_WC.conjugate() * body.q_WC).norm();
  const Scalar parallax = (body.p_W - data_.p_W).norm() / median_depth;
  return !(focal_px * (rotation + parallax) < tuning::same_view::kMaxMotionPx);
}

}  // namespace pf
