#include "session/keyframe_reader.h"

#include <algorithm>

#include "base/table_entries.h"
#include "geometry/ray_plane.h"
#include "geometry/so3.h"
#include "keyframe_slam/keyframe_slam.h"

namespace pf {

int KeyframeReader::kept_views() const { return slam_.kept_views(); }

/// That of the camera against the map, and that of the map against the keyframes that were held fixed.
void KeyframeReader::pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const {
  // Of a frame that repeats the one before, the pose is that one's.
  const std::int64_t now_ns = t_ns > slam_.frame().report.t_ns ? slam_.body_ns() : t_ns;
  if (!slam_.placement().unit().predict_pose(now_ns, t_ns, body, covariance))
    slam_.motion().predict_pose(now_ns, t_ns, body, covariance);
  *covariance += slam_.placement().map_covariance(body->p_W);
}

///   q_KC = q_Kᵀ q_C,   p_KC = R_Kᵀ (p_C - p_K);   both poses are taken as independent, which overstates the covariance
bool KeyframeReader::motion_since_mark(MotionView* out) const {
  const MarkedPose& mark = slam_.placement().mark();
  if (!mark.is_set) return false;
  Body body;
  Mat6 now;
  pose_at(slam_.frame().report.t_ns, &body, &now);
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

bool KeyframeReader::project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const {
  Body body;
  Mat6 P;
  pose_at(slam_.frame().report.t_ns, &body, &P);
  Mat26 J;
  const Mat3 R_WC = body.q_WC.toRotationMatrix();
  if (!project_bearing(slam_.map().camera(), R_WC, Vec3(p_W - body.p_W), Vec3::Zero(), Scalar(0), pixel, &J))
    return false;
  if (covariance == nullptr) return true;
  project_bearing(slam_.map().camera(), R_WC, p_W, Vec3(-body.p_W), Scalar(1), pixel, &J);
  *covariance = J.lazyProduct(P).lazyProduct(J.transpose());
  return true;
}

const Camera& KeyframeReader::lens(Scalar covariance[kLensParameters][kLensParameters]) const {
  const KeyframeLens& lens = slam_.map().lens();
  const LensRows& rows = lens.rows();
  for (int i = 0; i < rows.count; ++i)
    for (int j = 0; j < rows.count; ++j)
      covariance[rows.parameter[i]][rows.parameter[j]] = lens.covariance()[i * rows.count + j];
  return lens.camera();
}

/// A point without a depth is shown at the median one, with as much again as standard deviation.
void KeyframeReader::place_feature(int i, FeatureView* out) const {
  const KeyframeMap& map = slam_.map();
  const KeyframePoint& point = map.point(i);
  out->kind = map.kind(i);
  out->plane = point.has_depth && point.plane >= 0 ? map_.planes[point.plane].id : 0;
  const Scalar depth = point.has_depth ? 1 / point.rho : slam_.median_depth();
  const Vec3 ray_W = map.ray_W(i);
  out->p_W = map.keyframes[point.host].p_W + depth * ray_W;
  out->covariance = point.has_depth ? map.covariance(i) : Mat3(depth * depth * Mat3::Identity());
}

bool KeyframeReader::surface_of(int i, const Vec3& viewer_W, Vec3* normal_W) const {
  const KeyframePoint& point = slam_.map().point(i);
  if (!point.has_depth || point.plane < 0) return false;
  *normal_W = slam_.placement().planes().plane(point.plane).frame.R_WP.col(2);
  if (normal_W->dot(viewer_W - slam_.map().position(i)) < 0) *normal_W = -*normal_W;
  return true;
}

MapCounts KeyframeReader::counts() const {
  const KeyframeMap& map = slam_.map();
  MapCounts counts;
  for (const int i : used_entries(map)) {
    ++counts.features;
    const BlockKind kind = map.kind(i);
    ++(kind == BlockKind::kPoint          ? counts.points
       : kind == BlockKind::kInverseDepth ? counts.inverse_depths
                                          : counts.folded);
  }
  for (int k = 0; k < map_.planes.capacity(); ++k) counts.planes += map_.planes.used(k) ? 1 : 0;
  counts.keyframes = map.keyframes.count();
  counts.places = map.places.count();
  counts.places_returned = map.places.returned();
  counts.state_dim =
      6 * std::min(static_cast<int>(settings_.window_keyframes), counts.keyframes) + counts.points + counts.folded;
  counts.state_dim_points_only = counts.state_dim;
  return counts;
}

/// The newest keyframe in which a point on the plane began; -1: none is on it.
int KeyframeReader::newest_host_on(int i) const {
  const KeyframeMap& map = slam_.map();
  int newest = -1;
  for (const int p : used_entries(map)) {
    const KeyframePoint& point = map.point(p);
    if (!point.has_depth || point.plane != i) continue;
    if (newest < 0 || map.keyframes[point.host].number > map.keyframes[newest].number) newest = point.host;
  }
  return newest;
}

/// What a keyframe may be off in W, (theta, p): its covariance when it was the newest.
///
///   alpha = y . theta,   beta = -x . theta,   delta = n . (p + theta x (o - p_K))        axes x, y, n and origin o of the plane
Mat3 KeyframeReader::plane_with_keyframe(int i) const {
  const KeyframeMap& map = slam_.map();
  const PlaneFrame& frame = slam_.placement().planes().plane(i).frame;
  const int k = newest_host_on(i);
  if (k < 0) return Mat3::Zero();
  const Keyframe& keyframe = map.keyframes[k];
  const Vec3 n = frame.R_WP.col(2);
  Eigen::Matrix<Scalar, 3, 6> J;
  J.setZero();
  J.row(0).head<3>() = frame.R_WP.col(1).transpose();
  J.row(1).head<3>() = -frame.R_WP.col(0).transpose();
  J.row(2).head<3>() = Vec3(frame.o_W - keyframe.p_W).cross(n).transpose();
  J.row(2).tail<3>() = n.transpose();
  return J.lazyProduct(keyframe.covariance).lazyProduct(J.transpose());
}

///   (alpha, beta, delta) = (-a, -b, h)
PlaneView KeyframeReader::plane(int i) const {
  const KeyframePlane& plane = slam_.placement().planes().plane(i);
  PlaneView out;
  out.id = map_.planes[i].id;
  out.points = slam_.placement().planes().points_on(i);
  out.fixed_points = out.trial = 0;  // every point on it has a depth of its own
  const bool is_wall = map_.planes[i].known;
  out.known = is_wall;
  out.doubted = map_.planes[i].doubted;
  out.R_WP = plane.frame.R_WP;
  out.p_WP = plane.frame.o_W;
  out.normal_W = plane.frame.R_WP.col(2);
  out.distance = out.normal_W.dot(out.p_WP);
  const Mat3 J = plane_error_jacobian();
  const Mat3 covariance = is_wall ? slam_.placement().walls().covariance(i) : plane.covariance;
  out.covariance = J.lazyProduct(covariance).lazyProduct(J.transpose());
  if (!is_wall) out.covariance += plane_with_keyframe(i);
  out.outline = map_.planes[i].seen;
  return out;
}

bool KeyframeReader::hit(const Vec2& pixel, HitView* hit) const {
  Vec3 ray_C;
  Mat32 J_ray_pixel;
  if (!unproject(slam_.map().camera(), pixel, &ray_C, &J_ray_pixel)) return false;
  Body body;
  Mat6 P;
  pose_at(slam_.frame().report.t_ns, &body, &P);
  const Vec3 direction = body.q_WC * ray_C;
  *hit = HitView();
  for (const int k : used_entries(map_.planes)) {
    if (!map_.planes[k].counts()) continue;
    const KeyframePlane& plane = slam_.placement().planes().plane(k);
    Vec3 at;
    Mat3 J_origin, J_direction, J_plane;
    if (!intersect_ray_plane(plane.frame, Vec3::Zero(), body.p_W, direction, &at, &J_origin, &J_direction, &J_plane))
      continue;
    const Scalar range = (at - body.p_W).norm();
    if (!outline_contains(map_.planes[k].seen, plane_coordinates(plane.frame, at))) continue;
    if (hit->plane != 0 && range >= hit->range) continue;
    Eigen::Matrix<Scalar, 3, 6> J_pose;
    J_pose.leftCols<3>() = -J_direction * hat(direction);
    J_pose.rightCols<3>() = J_origin;
    *hit = {map_.planes[k].id, range, at,
            Mat3(J_pose.lazyProduct(P).lazyProduct(J_pose.transpose()) +
                 J_plane.lazyProduct(plane.covariance).lazyProduct(J_plane.transpose()))};
  }
  return true;
}

}  // namespace pf
