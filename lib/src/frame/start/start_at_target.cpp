#include "frame/start/start_at_target.h"

#include <algorithm>
#include <limits>

#include "frame/start/tuning.h"
#include "geometry/symmetric_eigen.h"

namespace pf {
namespace {

using namespace tuning::start_at_target;

constexpr int kMaxQuads = 8;

/// Standard deviation of a corner's pixel, including the uncertainty of the target's point, since the pose is fitted as if the points
/// were exact.
Scalar pixel_sigma(const Camera& camera, Scalar sigma_m, Scalar distance) {
  const Scalar of_points = camera.fx * sigma_m / distance;
  return std::sqrt(kCornerSigma * kCornerSigma + of_points * of_points);
}

}  // namespace

bool StartAtTarget::layout(Arena& arena, int width, int height) {
  quad_workspace_ = take_quad_workspace(&arena, width, height);
  return arena.ok();
}

bool StartAtTarget::find(const Camera& camera, const Tracker& tracker, TargetSighting* sighting) {
  const bool is_rectangle = target_.kind == TargetKind::kRectangle;
  if (!(is_rectangle ? find_rectangle(camera, tracker, sighting) : find_points(camera, tracker, sighting)))
    return false;
  if (is_rectangle) {
    target_.count = 4;
    rectangle_points(target_.width, target_.height, target_.point_W);
    if (target_.has_place) put_in_place(sighting);
  }
  target_.first_pose.q_WC = sighting->pose.q_WC;
  target_.first_pose.p_W = sighting->pose.p_WC;
  target_.first_covariance = sighting->pose.covariance;
  return true;
}

/// The points and the pose, found with the rectangle as world, in W:  T_WC = T_WT T_TC,  (theta, p)_W = R_WT (theta, p)_T.
void StartAtTarget::put_in_place(TargetSighting* sighting) {
  const Mat3 R = target_.q_WT.toRotationMatrix();
  for (int i = 0; i < target_.count; ++i) target_.point_W[i] = target_.p_WT + R * target_.point_W[i];
  PoseEstimate& pose = sighting->pose;
  pose.q_WC = target_.q_WT * pose.q_WC;
  pose.p_WC = target_.p_WT + R * pose.p_WC;
  Mat6 J = Mat6::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = R;
  const Mat6 JC = J.lazyProduct(pose.covariance);
  pose.covariance = JC.lazyProduct(J.transpose());
}

bool StartAtTarget::find_rectangle(const Camera& camera, const Tracker& tracker, TargetSighting* sighting) const {
  RectangleSighting found;
  if (!find_dark_rectangle(tracker.image(), camera, target_.width, target_.height, kCornerSigma, quad_workspace_,
                           &found, tracker.pyramid().mask))
    return false;
  std::copy(found.quad.corners, found.quad.corners + 4, sighting->pixel);
  const Scalar sigma = pixel_sigma(camera, target_.sigma_m, found.pose.p_WC.norm());
  return rectangle_pose(camera, target_.width, target_.height, sighting->pixel, sigma, &sighting->pose);
}

/// Finds known points near their prediction from the first pose: as the corners of a dark quadrilateral if there are four that match
/// one, otherwise as the strongest image corners. All points must be found.
bool StartAtTarget::find_points(const Camera& camera, const Tracker& tracker, TargetSighting* sighting) const {
  Vec2 predicted[Target::kMaxPoints];
  Scalar reach[Target::kMaxPoints];
  Scalar distance;
  if (!predict_points(camera, predicted, reach, &distance)) return false;
  const Scalar sigma = pixel_sigma(camera, target_.sigma_m, distance);

  Vec2 z[Target::kMaxPoints];
  if (target_.count == 4) {
    Quad quad[kMaxQuads];
    const int quads = find_dark_quads(tracker.image(), quad_workspace_, quad, kMaxQuads);
    for (int k = 0; k < quads; ++k) {
      if (!is_in_scene(quad[k], tracker.pyramid().mask) || !refine_quad(tracker.image(), camera, &quad[k])) continue;
      if (match_quad(quad[k], predicted, reach, z) && fit(camera, z, sigma, sighting)) return true;
    }
  }
  for (int i = 0; i < target_.count; ++i) {
    Rect roi;
    roi.x = static_cast<int>(predicted[i].x() - reach[i]);
    roi.y = static_cast<int>(predicted[i].y() - reach[i]);
    roi.width = roi.height = static_cast<int>(Scalar(2) * reach[i]) + 1;
    Corner corner;
    if (tracker.corners(roi, 8, &corner, 1) != 1) return false;
    z[i] = Vec2(static_cast<Scalar>(corner.x), static_cast<Scalar>(corner.y));
  }
  return fit(camera, z, sigma, sighting);
}

/// Predicts the points from the first pose: pixels, search radii [px], and their mean distance [m]. False if one is outside of the image.
bool StartAtTarget::predict_points(const Camera& camera, Vec2* predicted, Scalar* reach, Scalar* distance) const {
  const Body& first = target_.first_pose;
  *distance = 0;
  for (int i = 0; i < target_.count; ++i) {
    Mat26 J;
    if (!project_from_pose(camera, first.q_WC, first.p_W, target_.point_W[i], first.p_W, &predicted[i], &J))
      return false;
    if (!is_in_image(camera, predicted[i])) return false;
    const Mat26 JP = J.lazyProduct(target_.first_covariance);
    const Mat2 S = JP.lazyProduct(J.transpose());
    const Scalar widest = symmetric_eigenvalues(S)(1);
    if (!(widest >= Scalar(0))) return false;
    reach[i] = std::clamp(Scalar(3) * std::sqrt(widest), kMinReach, kMaxReach);
    *distance += (target_.point_W[i] - first.p_W).norm() / static_cast<Scalar>(target_.count);
  }
  return true;
}

/// Assigns a corner of the quadrilateral to each of four points. False if a point has none within its search radius.
bool StartAtTarget::match_quad(const Quad& quad, const Vec2* predicted, const Scalar* reach, Vec2* z) const {
  bool taken[4] = {};
  for (int i = 0; i < 4; ++i) {
    int nearest = -1;
    Scalar best = reach[i] * reach[i];
    for (int c = 0; c < 4; ++c) {
      const Scalar d2 = (quad.corners[c] - predicted[i]).squaredNorm();
      if (!taken[c] && d2 < best) {
        best = d2;
        nearest = c;
      }
    }
    if (nearest < 0) return false;
    taken[nearest] = true;
    z[i] = quad.corners[nearest];
  }
  return true;
}

/// Fits the pose to these pixels of the points. False if the fit fails or its error is large.
bool StartAtTarget::fit(const Camera& camera, const Vec2* z, Scalar sigma_px, TargetSighting* sighting) const {
  PoseEstimate estimate;
  estimate.q_WC = target_.first_pose.q_WC;
  estimate.p_WC = target_.first_pose.p_W;
  if (!refine_pose(camera, target_.point_W, z, target_.count, sigma_px, &estimate)) return false;
  if (estimate.rms_px > kMaxRmsPx) return false;
  sighting->pose = estimate;
  std::copy(z, z + target_.count, sighting->pixel);
  return true;
}

}  // namespace pf
