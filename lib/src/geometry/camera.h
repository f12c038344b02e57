#pragma once

#include "base/eigen.h"

namespace pf {

/// The same numbers as pf_camera_model_t.
enum class CameraModel : int { kPinhole = 1, kRadtan = 2, kEquidistant = 3, kDivision = 4 };

/// A calibrated camera. Pixel (0, 0) is the centre of the top-left one.
///
/// With m = (x/z, y/z) and r = |m|, the pixel is (fx m'x + cx, fy m'y + cy), where
///
///   pinhole      m' = m
///   radtan       m' = m (1 + k1 r² + k2 r⁴ + k3 r⁶) + (2 p1 mx my + p2 (r² + 2 mx²), p1 (r² + 2 my²) + 2 p2 mx my)
///   equidistant  m' = m θd / r,   θd = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸),   θ = atan2(|(x, y)|, z)
///   division     (fx m'x, fy m'y) = u / sqrt(1 + 2 k |u|²),   u = (fx mx, fy my)                        [px]
///
/// src  Brown 1966 (radtan), Kannala and Brandt 2006 (equidistant), Harris 1992 (division)
struct Camera {
  int model = 0;                          ///< CameraModel
  int width = 0, height = 0;              ///< [px]
  Scalar fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px]
  Scalar distortion[8] = {};              ///< radtan k1 k2 p1 p2 k3; equidistant k1 k2 k3 k4; division k [1/px²]
  Scalar readout = 0;  ///< from the first row to the last [s]; frames have the time of the middle one
  Scalar max_r2 = 0;   ///< domain: |m|² (pinhole, radtan), θ² (equidistant), |u|² [px²] (division)
};

/// Copies the numbers, with their types, and finds the domain. Null when all is well, else the name of the first field
/// that check_camera rejects; the camera is then not to be used.
const char* make_camera(int model, int width, int height, const double intrinsics[4], const double distortion[8],
                        Camera* camera);

/// Finds max_r2: the largest disc about the axis on which the model is one to one, with a slope of at least 0.01.
void init_camera(Camera* camera);

/// Name of the first field that makes no sense, or null. The model must be one to one over at least the inner half of
/// the image. Needs init_camera before.
const char* check_camera(const Camera& camera);

/// Pixel of a point in C, and its Jacobian (2x3, [px/m]; null to skip).
/// False outside the domain (z <= 0 for all but equidistant) and where the pixel is not finite; outputs untouched. The pixel may
/// lie outside the image.
bool project(const Camera& camera, const Vec3& p_C, Vec2* pixel, Mat23* J_pixel_p = nullptr);

/// Unit ray in C that projects to a pixel, and its Jacobian (3x2, [1/px]; null to skip).
/// False where the model has none; outputs untouched.
bool unproject(const Camera& camera, const Vec2& pixel, Vec3* ray_C, Mat32* J_ray_pixel = nullptr);

/// Whether a pixel lies in the image, so far or farther from the centres of its outermost pixels. False for what is no number.
inline bool is_in_image(const Camera& camera, const Vec2& pixel, Scalar margin = 0) {
  return pixel.x() >= margin && pixel.y() >= margin && pixel.x() <= static_cast<Scalar>(camera.width - 1) - margin &&
         pixel.y() <= static_cast<Scalar>(camera.height - 1) - margin;
}

}  // namespace pf
