#pragma once

#include <cstdint>

#include "geometry/camera.h"

/// The numbers of a calibration as something uncertain (lib/docs/theory/lens.md).

namespace pf {

inline constexpr int kLensDistortion = 5;                        ///< distortion[0 .. 4]
inline constexpr int kLensParameters = 4 + kLensDistortion + 1;  ///< fx fy cx cy, distortion, readout
inline constexpr int kReadoutParameter = kLensParameters - 1;

using LensJacobian = Eigen::Matrix<Scalar, 2, kLensParameters>;

/// Derivative of a point's pixel with respect to all of a camera's parameters, [px] each by its unit; those that the model lacks are zero,
/// and so is the readout, which moves the camera of a row and not the pixel of a camera (CameraAt::by_readout). The point must project.
///
///   pixel = (fx m'x + cx, fy m'y + cy):   by fx (m'x, 0), by cx (1, 0), by k  (fx dm'x/dk, fy dm'y/dk)
///   radtan       dm'/dk1 = m r²,  k2 m r⁴,  p1 (2 mx my, r² + 2 my²),  p2 (r² + 2 mx², 2 mx my),  k3 m r⁶
///   equidistant  dm'/dki = m θ^(2i+1) / r
///   division     m' = s m, s = 1 / sqrt(1 + 2 k |u|²), u = (fx mx, fy my):  ds/dk = -|u|² s³,
///                ds/dfx = -2 k s³ fx mx²,  ds/dfy in the same way
LensJacobian lens_jacobian(const Camera& camera, const Vec3& p_C);

/// Of the unit ray of a given pixel, from its derivative by the pixel:  J_ray_lens = -J_ray_pixel J_pixel_lens.
inline Eigen::Matrix<Scalar, 3, kLensParameters> ray_lens_jacobian(const Camera& camera, const Vec3& ray_C,
                                                                   const Mat32& J_ray_pixel) {
  return -J_ray_pixel.lazyProduct(lens_jacobian(camera, ray_C));
}

/// Which parameters are uncertain, one row each.
struct LensRows {
  int count = 0;                                ///< 0: the calibration is exact
  std::int8_t parameter[kLensParameters] = {};  ///< of each row, ascending

  bool has_readout() const { return count > 0 && parameter[count - 1] == kReadoutParameter; }
  /// Of them, those that shape a picture.
  int shape_count() const { return count - (has_readout() ? 1 : 0); }
};

/// And how much they are.
struct LensPrior {
  LensRows rows;
  Scalar variance[kLensParameters] = {};  ///< of each row
  Scalar between_focal = 0;               ///< covariance of the first two, fx and fy; all others are independent

  Scalar covariance(int a, int b) const { return a == b ? variance[a] : a + b == 1 ? between_focal : Scalar(0); }
};

/// Standard deviations that a calibration states.
///
///   e_fx = fx (e_focal + e_aspect / 2),   e_fy = fy (e_focal - e_aspect / 2)
struct LensSigmas {
  Scalar focal = 0;                         ///< common to fx and fy, relative
  Scalar aspect = 0;                        ///< of fx against fy, relative
  Scalar centre = 0;                        ///< of cx and of cy [px]
  Scalar distortion[kLensDistortion] = {};  ///< 0: exact, and no row
  Scalar readout = 0;                       ///< the same [s]
};

/// The prior of a camera. A pinhole whose first distortion coefficient is uncertain becomes a radial-tangential camera without distortion.
LensPrior make_lens_prior(const LensSigmas& sigmas, Camera* camera);

/// The same without the readout: for who compares pictures that are taken at once.
LensPrior shape_prior(const LensPrior& prior);

/// The readout alone: for who has other pictures to learn the rest from. No row where it is exact.
LensPrior readout_prior(const LensPrior& prior);

/// Inverse of a prior's covariance, rows x rows. inflation: how many times too much an adjustment weights its pixels; the prior must have
/// the same factor.
void lens_information(const LensPrior& prior, Scalar inflation, Scalar* information);

/// Moves a camera's parameters by an error over these rows, and finds its domain anew.
void move_lens(const LensRows& rows, const Scalar* e, Camera* camera);

/// e of a camera over another one of its model: move_lens(rows, e, &from) gives `to` in these rows.
void lens_difference(const LensRows& rows, const Camera& from, const Camera& to, Scalar* e);

}  // namespace pf
