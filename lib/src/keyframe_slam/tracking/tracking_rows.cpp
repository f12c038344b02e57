#include "base/elapsed.h"
#include "geometry/small_cholesky.h"
#include "keyframe_slam/tracking/tracking.h"
#include "keyframe_slam/tracking/tuning.h"
#include "model/camera_at.h"

/// KeyframeTracking with the rows of a rolling shutter (window_rows.h).

namespace pf {
namespace {

Body body_of(const PosePrior& at) {
  Body body;
  body.q_WC = at.q_WC;
  body.p_W = at.p_W;
  body.v_W = at.v_W;
  body.w_C = at.w_C;
  return body;
}

}  // namespace

PosePrior KeyframeTracking::now() const {
  const Body& body = motion_.body();
  return {body.q_WC, body.p_W, motion_.pose_covariance(), body.v_W, body.w_C, &motion_.covariance()};
}

/// Pixel and spread by the pose alone, in the pixel's own row.
bool KeyframeTracking::expect_row(const PosePrior& at, const Vec3& m, Scalar w, ExpectedPixel* out) const {
  Mat212 J;
  if (!project_row(map_.camera(), body_of(at), m, w, &out->pixel, &J)) return false;
  if (at.with_velocities != nullptr) {
    const Mat212 JP = J.lazyProduct(*at.with_velocities);
    out->spread = JP.lazyProduct(J.transpose());
  } else {
    const Mat26 J_C = J.leftCols<6>();
    const Mat26 JP = J_C.lazyProduct(at.covariance);
    out->spread = JP.lazyProduct(J_C.transpose());
  }
  return true;
}

Vec2 KeyframeTracking::match_at_frame_time(const Match& match, const PosePrior& at, Scalar depth) const {
  if (!has_rows()) return match.measured;
  const KeyframePoint& point = map_.point(match.feature);
  const Scalar rho = point.has_depth ? point.rho : 1 / depth;
  return pf::at_frame_time(map_.camera(), body_of(at), map_.ray_W(match.feature) + rho * map_.keyframes[point.host].p_W,
                           rho, match.measured);
}

Vec2 KeyframeTracking::at_frame_time(const Match& match, Scalar depth) const {
  return has_rows() ? match_at_frame_time(match, now(), depth) : match.measured;
}

/// Of a point's pixel since it was last accepted [px/s]. In the first keyframe nothing was known of the motion, so its pixel is that of
/// its row:
///
///   z2 - z1 = u (dt + tau2 - tau1),   tau1 = 0 where z1 is at its frame's time
Vec2 KeyframeTracking::image_motion(const Match& match) const {
  const KeyframePoint& point = map_.point(match.feature);
  const Feature& f = map_.feature(match.feature);
  const Scalar tau = row_time(map_.camera(), match.measured.y());
  const Scalar before = is_seen_again(match) ? row_time(map_.camera(), point.pixel.y()) : Scalar(0);
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(f.last_seen_ns, frame_.report.t_ns))) + tau - before;
  return dt > Scalar(0) ? Vec2((match.measured - point.pixel) / dt) : Vec2(Vec2::Zero());
}

/// Whether this is the second sight of a point of the first keyframe.
bool KeyframeTracking::is_seen_again(const Match& match) const {
  return map_.feature(match.feature).observations == 1 && map_.keyframes[map_.point(match.feature).host].number == 1;
}

Vec2 KeyframeTracking::followed_at_frame_time(const Match& match) const {
  if (!has_rows()) return match.measured;
  return match.measured - row_time(map_.camera(), match.measured.y()) * image_motion(match);
}

/// A point of the first keyframe is seen again: its pixel there is taken to the frame's time by how far it has moved since.
void KeyframeTracking::correct_first_pixel(const Match& match) {
  KeyframePoint& point = map_.point(match.feature);
  const Vec2 first = point.pixel - row_time(map_.camera(), point.pixel.y()) * image_motion(match);
  Vec3 ray_C;
  if (!unproject(map_.camera(), first, &ray_C)) return;
  map_.keyframes.set_pixel(point.host, match.feature, first);
  if (!map_.feature(match.feature).is_target) point.ray_K = ray_C.normalized();
}

/// The pose with the velocities that follow from it: how far the camera is from where it was predicted tells them.
bool KeyframeTracking::follow_velocities(const CameraPose& pose, const Mat6& information, KeyframeMotion* after) const {
  SmallCholesky<6, double> factored;
  return factored.factor(information.cast<double>()) && after->correct(pose.q_WC, pose.p_WC, factored.inverse());
}

/// Pixels at the frame's time were found with the predicted velocities; a jerk is found once more with those that the pose tells.
void KeyframeTracking::correct_by_rows(const PosePrior& before, CameraPose pose, Mat6 information) {
  const int found = frame_.report.matches;
  for (int pass = 0; pass < tuning::keyframe_tracking::kRowPasses; ++pass) {
    KeyframeMotion after = motion_;
    if (!follow_velocities(pose, information, &after)) break;
    PosePrior at = before;
    at.v_W = after.body().v_W;
    at.w_C = after.body().w_C;
    if (find_pose(found, at, &pose, &information) > 0) continue;
    find_pose(found, before, &pose, &information);  // the consensus of before counts
    break;
  }
  correct(pose, information);
}

}  // namespace pf
