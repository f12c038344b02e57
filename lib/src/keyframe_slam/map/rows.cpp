#include "keyframe_slam/map/rows.h"

#include "geometry/pnp.h"
#include "geometry/so3.h"
#include "model/camera_at.h"

namespace pf {

bool project_moving(const Camera& camera, const Body& body, Scalar tau, const Vec3& m, Scalar w, Vec2* pixel,
                    Mat212* J_pixel_body) {
  const Vec3 rotation = body.w_C * tau;
  const Quat q_WC = (body.q_WC * exp_so3(rotation)).normalized();
  const Vec3 p_W = body.p_W + body.v_W * tau;
  Mat26 J;
  if (!project_from_pose(camera, q_WC, p_W, m, w, p_W, pixel, J_pixel_body != nullptr ? &J : nullptr)) return false;
  if (J_pixel_body == nullptr) return true;
  const Mat3 J_theta_w = tau * body.q_WC.toRotationMatrix().lazyProduct(left_jacobian_so3(rotation));
  J_pixel_body->leftCols<6>() = J;
  J_pixel_body->middleCols<3>(6) = tau * J.rightCols<3>();
  J_pixel_body->rightCols<3>() = J.leftCols<3>().lazyProduct(J_theta_w);
  return true;
}

bool project_row(const Camera& camera, const Body& body, const Vec3& m, Scalar w, Vec2* pixel, Mat212* J_pixel_body) {
  Vec2 z;
  if (!project_moving(camera, body, Scalar(0), m, w, &z)) return false;
  // The pixel's row gives its time, and its time the pixel: two iterations, since the camera moves little in between.
  if (!project_moving(camera, body, row_time(camera, z.y()), m, w, &z)) return false;
  return project_moving(camera, body, row_time(camera, z.y()), m, w, pixel, J_pixel_body);
}

Vec2 at_frame_time(const Camera& camera, const Body& body, const Vec3& m, Scalar w, const Vec2& measured) {
  Vec2 by_row, still;
  if (!has_rows(camera) || !project_moving(camera, body, row_time(camera, measured.y()), m, w, &by_row) ||
      !project_moving(camera, body, Scalar(0), m, w, &still))
    return measured;
  return measured - (by_row - still);
}

}  // namespace pf
