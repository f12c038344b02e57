#pragma once

#include "geometry/camera.h"
#include "track/thumbnail.h"

/// Rotation of a camera between two images, from the images alone. A translation counts as the rotation that explains it best.

namespace pf {

/// Pixel of an image where a pixel of its thumbnail is, and the reverse.
Vec2 from_thumbnail(const Camera& camera, const Vec2& pixel);
Vec2 to_thumbnail(const Camera& camera, const Vec2& pixel);

/// Rotation that takes unit vector a to unit vector b by the shortest way.
Quat shortest_rotation(const Vec3& a, const Vec3& b);

/// Rotation that a shift of the pixels by `shift` [px of the thumbnail] between two images stands for: what was at the centre minus half of
/// the shift is now at the centre plus half of it. Identity where the lens has no ray there.
Quat rotation_of_shift(const Camera& camera, const Vec2& shift);

/// Rotation that takes rays of the camera now to rays of the camera before, by which the thumbnails differ least, up to gain and bias:
///
///   sum_x (now(x) - g before(w(x)) - b)^2,   w(x) = pixel of R ray(x)
///
/// First the best shift, then Gauss-Newton on SO(3), R <- Exp(phi) R. False where the images do not match.
/// mask: pixels that count in neither.
bool find_rotation(const Camera& camera, const Thumbnail& before, const Thumbnail& now, const ThumbnailMask& mask,
                   Quat* q_before_now);
inline bool find_rotation(const Camera& camera, const Thumbnail& before, const Thumbnail& now, Quat* q_before_now) {
  return find_rotation(camera, before, now, ThumbnailMask(), q_before_now);
}

}  // namespace pf
