#include "filter_slam/features/same_view.h"

#include "base/elapsed.h"
#include "filter_slam/features/tuning.h"

namespace pf {

void SameView::note(const Body& body, Scalar median_depth, Scalar focal_px) {
  if (data_.frames == 0 || has_moved(body, median_depth, focal_px)) data_ = {body.q_WC, body.p_W, 0};
  count_frame(&data_.frames);
}

/// Whether a point near the median depth moves by more than 2 px in the image, or is behind the camera. Rotation and position are tested
/// together, since the estimate of a camera at rest drifts about the point that it looks at.
bool SameView::has_moved(const Body& body, Scalar median_depth, Scalar focal_px) const {
  namespace near = tuning::same_view;
  const Quat q_CW = body.q_WC.conjugate();
  for (const Scalar share : {Scalar(1) / near::kDepthRatio, Scalar(1), near::kDepthRatio})
    for (int corner = 0; corner < 5; ++corner) {
      const Vec2 before = corner == 4 ? Vec2(Vec2::Zero())
                                      : Vec2(corner % 2 == 0 ? -near::kCorner : near::kCorner,
                                             corner < 2 ? -near::kCorner : near::kCorner);
      const Vec3 p_W = data_.p_W + data_.q_WC * (Vec3(before.x(), before.y(), Scalar(1)) * (share * median_depth));
      const Vec3 p_C = q_CW * (p_W - body.p_W);
      if (!(p_C.z() > Scalar(0) && focal_px * (p_C.head<2>() / p_C.z() - before).norm() < near::kMaxMotionPx))
        return true;
    }
  return false;
}

}  // namespace pf
