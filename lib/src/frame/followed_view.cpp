#include "frame/followed_view.h"

#include "frame/ellipse.h"
#include "frame/tuning.h"
#include "track/image_rotation.h"

namespace pf {

void FollowedView::keep(const Pyramid& image, const Quat& q_WC, const Vec3& p_W) {
  make_thumbnail(image, &data_.thumbnail);
  data_.is_kept = true;
  data_.q_WC = q_WC;
  data_.p_W = p_W;
}

bool FollowedView::find(const Camera& camera, const Pyramid& image) {
  if (!data_.is_kept) return false;
  Thumbnail now;
  make_thumbnail(image, &now);
  ThumbnailMask mask;
  make_thumbnail_mask(image, &mask);
  Quat q_before_now;
  if (!find_rotation(camera, data_.thumbnail, now, mask, &q_before_now)) return false;
  data_.q_now_WC = (data_.q_WC * q_before_now).normalized();
  return true;
}

bool FollowedView::aim(const Camera& camera, const Vec3& point_W, SearchTask* task) const {
  task->q_WC = data_.q_now_WC;
  task->c_W = data_.p_W;
  task->innovation = covariance(camera);
  return project(camera, data_.q_now_WC.conjugate() * (point_W - data_.p_W), &task->predicted);
}

Mat2 FollowedView::covariance(const Camera& camera) {
  const Scalar sigma = tuning::followed_view::kSigma * static_cast<Scalar>(camera.width) / Thumbnail::kWidth;
  return Mat2::Identity() * (sigma * sigma);
}

bool FollowedView::is_wide(const Camera& camera, const Mat2& innovation, Scalar gate) {
  return ellipse_area(innovation, gate) > tuning::followed_view::kWideArea * ellipse_area(covariance(camera), gate);
}

}  // namespace pf
