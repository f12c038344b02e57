#include "filter/plane_from_camera.h"

#include "geometry/plane.h"
#include "geometry/so3.h"
#include "model/gauge.h"

namespace pf {

RowsOf<3, 9, 2> plane_from_camera(const State& state, int plane) {
  constexpr int kPlaneRows = 3, kColumns = 9;
  const Block& block = state.block[plane];
  const Mat37 N = plane_gauge(state.frame_of(block), block.xyz());
  const Mat3 N_T = N.block<3, 3>(0, gauge::kTranslation), N_R = N.block<3, 3>(0, gauge::kRotation);
  const Mat3 by_rotation = -(N_T * hat(state.body.p_W) + N_R), by_position = -N_T;
  RowsOf<3, 9, 2> J;
  J.parts = 2;
  J.part[0] = Part::of(plane, 0, kPlaneRows);
  J.part[1] = Part::body(Body::kTheta, 2 * kPlaneRows);
  put<3, 3>(J.h, kColumns, 0, Mat3::Identity());
  put<3, 3>(J.h, kColumns, kPlaneRows, by_rotation);
  put<3, 3>(J.h, kColumns, 2 * kPlaneRows, by_position);
  return J;
}

}  // namespace pf
