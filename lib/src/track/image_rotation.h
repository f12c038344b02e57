#pragma once

#include "geometry/camera.h"
#include "track/thumbnail.h"

/// How a camera has turned between two images, from the images alone. A shift of the camera counts as the turn that explains it best.

namespace pf {

/// Pixel of an image where a pixel of its thumbnail is, and the reverse.
Vec2 from_thumbnail(const Camera& camera, const Vec2& pixel);
Vec2 to_thumbnail(const Camera& camera, const Vec2& pixel);

/// Rotation that takes unit vector a to unit vector b by the shortest way.
Quat shortest_rotation(const Vec3& a, const Vec3& b);

/// Rotation by which an image whose pixels have moved by `shift` [px of the thumbnail] since another one turns into that: what was at the
/// centre minus half of the shift is now at the centre plus half of it. Identity where the lens has no ray there.
Quat rotation_of_shift(const Camera& camera, const Vec2& shift);

/// Rotation that takes rays of the camera now to rays of the camera before, by which the thumbnails differ least, gain and bias apart:
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
