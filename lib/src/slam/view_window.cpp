#include <algorithm>

#include "geometry/so3.h"
#include "slam/view.h"
#include "slam/window_slam.h"

/// What the view shows of the window.

namespace pf {

/// That of the camera against the map, and that of the map against the keyframes that were held fixed.
void View::window_pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const {
  // Of a frame that repeats the one before, the pose is that one's.
  window_->motion().predict_pose(t_ns > last_ns() ? window_->body_ns() : t_ns, t_ns, body, covariance);
  *covariance += window_->map_covariance();
}

///   q_KC = q_Kᵀ q_C,   p_KC = R_Kᵀ (p_C - p_K);   both poses are taken as independent, which overstates the covariance
bool View::window_motion_since_mark(MotionView* out) const {
  const WindowSlam::Mark& mark = window_->mark();
  if (!mark.is_set) return false;
  Body body;
  Mat6 now;
  window_pose_at(last_ns(), &body, &now);
  const Mat3 R_KW = mark.q_WC.conjugate().toRotationMatrix();
  const Vec3 d = body.p_W - mark.p_W;
  out->mark_ns = mark.t_ns;
  out->q_KC = mark.q_WC.conjugate() * body.q_WC;
  out->p_KC = R_KW * d;
  Mat6 J_now = Mat6::Zero(), J_mark = Mat6::Zero();
  J_now.topLeftCorner<3, 3>() = J_now.bottomRightCorner<3, 3>() = R_KW;
  J_mark = -J_now;
  J_mark.bottomLeftCorner<3, 3>() = R_KW * hat(d);
  out->covariance = J_now.lazyProduct(now).lazyProduct(J_now.transpose()) +
                    J_mark.lazyProduct(mark.covariance).lazyProduct(J_mark.transpose());
  return true;
}

bool View::window_project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const {
  Body body;
  Mat6 P;
  window_pose_at(last_ns(), &body, &P);
  Mat26 J;
  const Mat3 R_WC = body.q_WC.toRotationMatrix();
  if (!project_bearing(settings_.camera, R_WC, Vec3(p_W - body.p_W), Vec3::Zero(), Scalar(0), pixel, &J)) return false;
  if (covariance == nullptr) return true;
  project_bearing(settings_.camera, R_WC, p_W, Vec3(-body.p_W), Scalar(1), pixel, &J);
  *covariance = J.lazyProduct(P).lazyProduct(J.transpose());
  return true;
}

/// A point without a depth is shown at the median one, with as much again as standard deviation.
FeatureView View::window_feature(int i) const {
  const WindowMap& map = window_->map();
  const Feature& f = map.feature(i);
  const WindowPoint& point = map.point(i);
  FeatureView out;
  out.id = f.id;
  out.external_id = f.external_id;
  out.is_target = f.is_target;
  out.observations = f.observations;
  out.attempts = f.attempts;
  out.kind = map.kind(i);
  out.plane = point.has_depth && point.plane >= 0 ? map_.planes[point.plane].id : 0;
  const Scalar depth = point.has_depth ? 1 / point.rho : window_->median_depth();
  const Vec3 ray_W = map.ray_W(i);
  out.p_W = map.keyframes[point.host].p_W + depth * ray_W;
  out.covariance = point.has_depth ? map.covariance(i) : Mat3(depth * depth * Mat3::Identity());
  return out;
}

bool View::window_surface_of(int i, const Vec3& viewer_W, Vec3* normal_W) const {
  (void)i, (void)viewer_W, (void)normal_W;
  return false;
}

MapCounts View::window_counts() const {
  const WindowMap& map = window_->map();
  MapCounts counts;
  for (int i = 0; i < map.capacity(); ++i) {
    if (!map.used(i)) continue;
    ++counts.features;
    const BlockKind kind = map.kind(i);
    ++(kind == BlockKind::kPoint ? counts.points
       : kind == BlockKind::kInverseDepth ? counts.inverse_depths
                                          : counts.folded);
  }
  for (int k = 0; k < map_.planes.capacity(); ++k) counts.planes += map_.planes.used(k) ? 1 : 0;
  counts.keyframes = map.keyframes.count();
  counts.state_dim = 6 * std::min(static_cast<int>(settings_.window_keyframes), counts.keyframes) +
                     counts.points + counts.folded;
  counts.state_dim_points_only = counts.state_dim;
  return counts;
}

PlaneView View::window_plane(int i) const {
  (void)i;
  return PlaneView();
}

bool View::window_hit(const Vec2& pixel, HitView* hit) const {
  Vec3 ray_C;
  if (!unproject(settings_.camera, pixel, &ray_C)) return false;
  *hit = HitView();
  return true;
}

}  // namespace pf
