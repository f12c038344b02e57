#pragma once

#include "geometry/camera.h"
#include "geometry/p3p.h"
#include "geometry/pnp.h"

/// Fits the ratio of the lens's focal length to the calibrated one, by the points of one image.

namespace pf {

struct ZoomFit {
  Scalar log_ratio = 0;  ///< ln of the image's focal length over the calibrated one
  Scalar variance = 0;   ///< of it; 0: the points do not measure it
};

/// Pixel of a point for a lens that is exp(s) times as long as its calibration, with its derivatives by the pose, as in project_from_pose()
/// with the pivot at the camera, and by s. False where the point cannot be seen.
///
///   u = c + e^s (z(q, p) - c),   du/d(theta, p) = e^s dz/d(theta, p),   du/ds = u - c,   c the principal point
bool project_zoomed(const Camera& camera, const CameraPose& pose, Scalar s, const PnpPoint& point, Vec2* u,
                    Mat26* J_pose, Vec2* J_s);

/// Points of the map in one image, at most kMax of them.
class ZoomPoints {
 public:
  static constexpr int kMax = 64;

  /// variance: of each coordinate of the pixel, its own noise and that of the point's depth [px^2]. by_readout: by how much one standard
  /// deviation of the camera's readout moves it [px]: rows that are read out later stretch an image that moves along them as a zoom does.
  void add(const PnpPoint& point, Scalar variance, const Vec2& by_readout = Vec2::Zero());

  /// Least squares of the pixels over pose, log ratio s and the readout's error (about zero) together, from a pose nearby. A longer lens
  /// and a camera nearer to a scene of one depth give the same image; the variance, with pose and readout eliminated, allows for that, and
  /// grows with the points' residuals, which contain the map's own errors:
  ///
  ///   var(s) = max(1, chi^2 / (2n - 7)) / (c_ss - a^T A^-1 a)
  ///
  /// src  elimination of the pose by the Schur complement; variance of unit weight (Foerstner and Wrobel 2016, 4.2)
  ZoomFit fit(const Camera& camera, const CameraPose& near) const;

 private:
  struct Point {
    PnpPoint point;
    Scalar variance;
    Vec2 by_readout;
  };
  Point point_[kMax];
  int count_ = 0;
};

}  // namespace pf
