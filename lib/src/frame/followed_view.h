#pragma once

#include "geometry/camera.h"
#include "track/thumbnail.h"
#include "track/tracker.h"
#include "vision/pyramid.h"

/// Where to search in an image when the motion model is too vague: where the image as a whole has moved since the last frame that supported
/// its pose (lib/docs/theory/matching.md).

namespace pf {

class Archive;

/// A camera that rotates or stops faster than the motion model allows leaves the search ellipses, and searches about the prediction find
/// nothing. The thumbnails of both images give the rotation between them, to a fraction of a thumbnail's pixel, as if the camera had only
/// rotated.
class FollowedView {
 public:
  void init() { data_.is_kept = false; }

  /// Keeps the view of a frame that supported its pose.
  void keep(const Pyramid& image, const Quat& q_WC, const Vec3& p_W);
  /// Finds the kept view in an image. False if there is none, or the images do not match.
  bool find(const Camera& camera, const Pyramid& image);

  /// Centre of the camera in whose image the view was found: that of the kept one, as if it had only rotated.
  const Vec3& p_W() const { return data_.p_W; }
  /// Directs a search to where that camera sees a point. False where the point is not in front of it.
  bool aim(const Camera& camera, const Vec3& point_W, SearchTask* task) const;
  /// Covariance of the pixel there [px^2].
  static Mat2 covariance(const Camera& camera);
  /// Whether the ellipse of a search is several times as large as that about such a pixel, so that aiming helps.
  static bool is_wide(const Camera& camera, const Mat2& innovation, Scalar gate);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    Thumbnail thumbnail;
    bool is_kept = false;
    Quat q_WC = Quat::Identity(), q_now_WC = Quat::Identity();
    Vec3 p_W = Vec3::Zero();
  };

  Data data_;
};

}  // namespace pf
