#include "keyframe_slam/adjustment/move_window.h"

#include "base/table_entries.h"

namespace pf {

void move_keyframe(const Similarity& T, int k, KeyframeMap* map) {
  const Scalar s = T.s;
  const auto move = [&](CameraView* view) { *view = {(T.q * view->q_WC).normalized(), T.of(view->c_W)}; };
  Keyframe& keyframe = map->keyframes[k];
  keyframe.q_WC = (T.q * keyframe.q_WC).normalized();
  keyframe.p_W = T.of(keyframe.p_W);
  keyframe.v_W = s * (T.q * keyframe.v_W);
  keyframe.row_depth *= s;
  keyframe.covariance = T.of_pose_covariance(keyframe.covariance);
  for (const int i : used_entries(*map)) {
    KeyframePoint& point = map->point(i);
    if (point.host != k) continue;
    point.rho /= s;
    point.variance /= s * s;
    point.remembered = {point.remembered.mean / s, point.remembered.sigma / s};
    move(&point.seen_from);
    move(&map->tables().first_view(i));
  }
}

void move_window(const Similarity& T, KeyframeMap* map, KeyframePlanes* planes, KeyframeMotion* motion) {
  for (const int k : used_entries(map->keyframes)) move_keyframe(T, k, map);
  map->tables().target_normal_W = T.q * map->tables().target_normal_W;
  map->places.move(T);
  planes->move(T);
  motion->move(T);
}

}  // namespace pf
