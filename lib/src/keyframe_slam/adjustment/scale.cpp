#include "keyframe_slam/adjustment/scale.h"

#include "base/table_entries.h"

namespace pf {

void scale_window(Scalar s, const Vec3& c_W, KeyframeMap* map, KeyframePlanes* planes, KeyframeMotion* motion) {
  const auto move = [&](Vec3* p_W) { *p_W = c_W + s * (*p_W - c_W); };
  for (const int k : used_entries(map->keyframes)) {
    Keyframe& keyframe = map->keyframes[k];
    move(&keyframe.p_W);
    keyframe.covariance.bottomRows<3>() *= s;
    keyframe.covariance.rightCols<3>() *= s;
  }
  for (const int i : used_entries(*map)) {
    KeyframePoint& point = map->point(i);
    point.rho /= s;
    point.variance /= s * s;
    point.remembered = {point.remembered.mean / s, point.remembered.sigma / s};
    move(&point.seen_from.c_W);
    move(&map->tables().first_view(i).c_W);
  }
  map->places.scale(s, c_W);
  planes->scale(s, c_W);
  motion->scale(s, c_W);
}

}  // namespace pf
