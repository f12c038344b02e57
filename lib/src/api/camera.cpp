#include "api/context.h"

namespace {

pf_status_t camera_from(const pf_camera_t& c, pf::Camera* camera) {
  const double intrinsics[4] = {c.fx, c.fy, c.cx, c.cy};
  return pf::make_camera(c.model, c.width, c.height, intrinsics, c.distortion, camera) == nullptr ? PF_OK
                                                                                                  : PF_ERROR_CONFIG;
}

}  // namespace

pf_status_t pf_camera_project(const pf_camera_t* camera, const double p_C[3], double pixel[2]) {
  if (camera == nullptr || p_C == nullptr || pixel == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(p_C, 3)) return PF_ERROR_NONFINITE;
  pf::Camera c;
  if (camera_from(*camera, &c) != PF_OK) return PF_ERROR_CONFIG;
  pf::Vec2 z;
  const pf::Vec3 p(static_cast<pf::Scalar>(p_C[0]), static_cast<pf::Scalar>(p_C[1]), static_cast<pf::Scalar>(p_C[2]));
  if (!pf::project(c, p, &z)) return PF_ERROR_RANGE;
  pixel[0] = static_cast<double>(z.x());
  pixel[1] = static_cast<double>(z.y());
  return PF_OK;
}

pf_status_t pf_camera_unproject(const pf_camera_t* camera, const double pixel[2], double ray_C[3]) {
  if (camera == nullptr || pixel == nullptr || ray_C == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(pixel, 2)) return PF_ERROR_NONFINITE;
  pf::Camera c;
  if (camera_from(*camera, &c) != PF_OK) return PF_ERROR_CONFIG;
  pf::Vec3 ray;
  if (!pf::unproject(c, pf::Vec2(static_cast<pf::Scalar>(pixel[0]), static_cast<pf::Scalar>(pixel[1])), &ray))
    return PF_ERROR_RANGE;
  for (int i = 0; i < 3; ++i) ray_C[i] = static_cast<double>(ray[i]);
  return PF_OK;
}
