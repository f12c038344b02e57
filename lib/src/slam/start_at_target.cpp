#include <algorithm>
#include <limits>

#include "geometry/symmetric_eigen.h"
#include "slam/filter_slam.h"

/// A start in front of something known: find it, take the pose from it, and let its points be features.

namespace pf {
namespace {

constexpr Scalar kCornerSigma = Scalar(0.25);  ///< [px] of a corner that is found as the meeting of two lines
constexpr Scalar kMostRms = Scalar(2);         ///< [px] of known points against the pose that explains them best
constexpr int kQuads = 8;

/// Uncertainty of the target's points seen as uncertainty of the pixels, since the pose is fitted as if they were exact.
Scalar pixel_sigma(const Camera& camera, Scalar sigma_m, Scalar distance) {
  const Scalar of_points = camera.fx * sigma_m / distance;
  return std::sqrt(kCornerSigma * kCornerSigma + of_points * of_points);
}

}  // namespace

/// The pose at the first frame, in one of the ways that the caller chose. False: not yet.
bool FilterSlam::start_in_image() {
  if (target_.kind == TargetKind::kNone) {
    begin_from_knowledge();
    start_.recording = !known_body_.given;
    return true;
  }
  PoseEstimate pose;
  Vec2 pixel[Target::kMaxPoints];
  const bool seen = target_.kind == TargetKind::kRectangle ? sight_rectangle(&pose, pixel) : sight_points(&pose, pixel);
  if (!seen) return false;

  if (target_.kind == TargetKind::kRectangle) {
    target_.count = 4;
    rectangle_points(target_.width, target_.height, target_.point_W);
  }
  target_.first_pose.q_WC = pose.q_WC;
  target_.first_pose.p_W = pose.p_WC;
  target_.first_covariance = pose.covariance;
  if (frame_.report.frames > 1) known_body_ = KnownBody();  // it was the pose of the first frame
  begin_from_knowledge();
  add_target_points();
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!map_.features.used(i) || !map_.features[i].is_target) continue;
    Feature& f = map_.features[i];
    const Vec2 z = pixel[f.track];
    f.appearance = tracker_.remember(z, pose.q_WC, pose.p_WC);
    f.observations = f.attempts = 1;
    ++frame_.report.inliers;
    frame_.add({i, f.id, MatchStatus::kInlier, BlockKind::kPoint, z, Mat2::Zero(), z, Scalar(0)});
  }
  frame_.report.attempts = frame_.report.matches = frame_.report.inliers;
  tracking_.sight();
  settings_.hooks.say("started at the target");
  return true;
}

bool FilterSlam::sight_rectangle(PoseEstimate* pose, Vec2* pixel) const {
  RectangleSighting sighting;
  const Camera& camera = settings_.camera;
  if (!find_dark_rectangle(tracker_.image(), camera, target_.width, target_.height, kCornerSigma, quad_workspace_,
                           &sighting))
    return false;
  std::copy(sighting.quad.corners, sighting.quad.corners + 4, pixel);
  const Scalar sigma = pixel_sigma(camera, target_.sigma_m, sighting.pose.p_WC.norm());
  return rectangle_pose(camera, target_.width, target_.height, pixel, sigma, pose);
}

/// Known points near where the first pose puts them: the corners of a dark quadrilateral when there are four that match one,
/// otherwise the strongest image corners. All points must be there.
bool FilterSlam::sight_points(PoseEstimate* pose, Vec2* pixel) const {
  const Camera& camera = settings_.camera;
  const int count = target_.count;
  const Body& first = target_.first_pose;
  Vec2 predicted[Target::kMaxPoints];
  Scalar reach[Target::kMaxPoints];  // [px]
  Scalar distance = 0;
  for (int i = 0; i < count; ++i) {
    Mat26 J;
    if (!project_from_pose(camera, first.q_WC, first.p_W, target_.point_W[i], first.p_W, &predicted[i], &J))
      return false;
    if (!(predicted[i].x() > 0 && predicted[i].x() < static_cast<Scalar>(camera.width) && predicted[i].y() > 0 &&
          predicted[i].y() < static_cast<Scalar>(camera.height)))
      return false;
    const Mat26 JP = J.lazyProduct(target_.first_covariance);
    const Mat2 S = JP.lazyProduct(J.transpose());
    const Scalar widest = symmetric_eigenvalues(S)(1);
    if (!(widest >= Scalar(0))) return false;
    reach[i] = std::clamp(Scalar(3) * std::sqrt(widest), Scalar(6), Scalar(60));
    distance += (target_.point_W[i] - first.p_W).norm() / static_cast<Scalar>(count);
  }
  const Scalar sigma = pixel_sigma(camera, target_.sigma_m, distance);

  const auto try_pixels = [&](const Vec2* z) {
    PoseEstimate estimate;
    estimate.q_WC = first.q_WC;
    estimate.p_WC = first.p_W;
    if (!refine_pose(camera, target_.point_W, z, count, sigma, &estimate)) return false;
    if (estimate.rms_px > kMostRms) return false;
    *pose = estimate;
    std::copy(z, z + count, pixel);
    return true;
  };

  if (count == 4) {
    Quad quad[kQuads];
    const int quads = find_dark_quads(tracker_.image(), quad_workspace_, quad, kQuads);
    for (int k = 0; k < quads; ++k) {
      if (!refine_quad(tracker_.image(), camera, &quad[k])) continue;
      Vec2 z[4];
      bool taken[4] = {};
      bool all = true;
      for (int i = 0; i < 4 && all; ++i) {
        int nearest = -1;
        Scalar best = reach[i] * reach[i];
        for (int c = 0; c < 4; ++c) {
          const Scalar d2 = (quad[k].corners[c] - predicted[i]).squaredNorm();
          if (!taken[c] && d2 < best) {
            best = d2;
            nearest = c;
          }
        }
        all = nearest >= 0;
        if (!all) break;
        taken[nearest] = true;
        z[i] = quad[k].corners[nearest];
      }
      if (all && try_pixels(z)) return true;
    }
  }

  Vec2 z[Target::kMaxPoints];
  for (int i = 0; i < count; ++i) {
    Rect roi;
    roi.x = static_cast<int>(predicted[i].x() - reach[i]);
    roi.y = static_cast<int>(predicted[i].y() - reach[i]);
    roi.width = roi.height = static_cast<int>(Scalar(2) * reach[i]) + 1;
    Corner corner;
    if (tracker_.corners(roi, 8, &corner, 1) != 1) return false;
    z[i] = Vec2(static_cast<Scalar>(corner.x), static_cast<Scalar>(corner.y));
  }
  return try_pixels(z);
}

}  // namespace pf
