#pragma once

#include "geometry/ray_plane.h"
#include "model/camera_at.h"
#include "model/kinds.h"

/// Where the ray of a pixel meets a plane of the state, with what it depends on: for points that begin there.

namespace pf {

/// q = where the ray meets the plane; e_q = J_c e_c + J_d (-[d]x theta + R J_ray_z e_z + R J_ray_lens e_lens) + J_x e_x
struct RayOnPlane {
  CameraAt camera;
  Mat3 R_WC;
  Vec3 d_W;  ///< direction of the ray
  Vec3 q_W;
  Mat3 J_c, J_d, J_x;

  /// Rows of A e_q over camera, plane and lens, for A of kRows x 3.
  template <int kRows>
  using RowsFor = RowsOf<kRows, CameraAt::kMaxColumns + 3 + kLensParameters, 3>;

  /// tau: the time of the pixel's row. False where the ray does not meet the plane.
  bool meet(const State& state, int plane, const Vec3& ray_C, Scalar tau);

  /// Jacobian of A q by the ray.
  template <int kRows>
  Eigen::Matrix<Scalar, kRows, 3> by_ray(const Eigen::Matrix<Scalar, kRows, 3>& A) const {
    return A * (J_d * R_WC);
  }

  template <int kRows>
  void rows(const State& state, int plane, const Vec3& ray_C, const Mat32& J_ray_z,
            const Eigen::Matrix<Scalar, kRows, 3>& A, RowsFor<kRows>* J) const {
    const int lens = state.lens_rows.count, own = camera.columns(), columns = own + 3 + lens;
    for (int i = 0; i < kRows * columns; ++i) J->h[i] = Scalar(0);
    J->parts = lens > 0 ? 3 : 2;
    J->part[0] = camera.part();
    J->part[1] = Part::of(plane, 0, 3);
    Eigen::Matrix<Scalar, kRows, 6> J_camera;
    J_camera.template leftCols<3>() = -A * (J_d * hat(d_W));
    J_camera.template rightCols<3>() = A * J_c;
    camera.chain(J_camera, J->h, columns);
    put<kRows, 3>(J->h, columns, own, Eigen::Matrix<Scalar, kRows, 3>(A * J_x));
    if (lens == 0) return;
    J->part[2] = Part::body(state.layout.row(BodyPart::kLens), lens);
    Eigen::Matrix<Scalar, kRows, kLensParameters> J_lens =
        by_ray<kRows>(A).lazyProduct(ray_lens_jacobian(state.lens, ray_C, J_ray_z));
    J_lens.col(kReadoutParameter) = camera.by_readout<kRows>(J_camera, state.lens.readout);
    put_lens<kRows>(J_lens, state.lens_rows, own + 3, columns, J->h);
  }
};

}  // namespace pf
