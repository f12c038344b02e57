#include "keyframe_slam/map/readout.h"

#include "base/table_entries.h"
#include "bundle/row_column.h"

namespace pf {

Vec2 expected_by_readout(const KeyframeMap& map, int point, const Body& at, Scalar rho, Scalar y) {
  const Camera& camera = map.camera();
  const Keyframe& host = map.keyframes[map.point(point).host];
  const Mat3 R_CW = at.q_WC.toRotationMatrix().transpose();
  const Vec3 d = map.ray_W(point) + rho * (host.p_W - at.p_W);
  Vec2 z;
  Mat23 J;
  if (!project(camera, R_CW * d, &z, &J)) return Vec2::Zero();
  const Mat23 J_W = J.lazyProduct(R_CW);
  const Vec2 own = readout_column(camera, {R_CW, {at.v_W, at.w_C}, Scalar(0)}, y, J_W, d, rho);  // y is that of its row
  const HostPixel seen = map.host_pixel(point);
  Vec3 ray;
  Mat32 J_ray_z;
  if (!seen.given || !unproject(camera, seen.pixel, &ray, &J_ray_z)) return own;
  const Mat3 R_HW = host.q_WC.toRotationMatrix().transpose();
  const ViewOfRows view = {R_HW, {host.v_W, host.w_C}, camera.readout};
  const Vec3 by_host = R_HW.transpose() * (J_ray_z * readout_column(camera, view, seen.pixel, rho));
  return own - J_W * by_host;
}

void move_readout(Scalar readout, Scalar depth, KeyframeMap* map) {
  Camera now = map->camera();
  const Scalar before = now.readout;
  KeyframeTable& keyframes = map->keyframes;
  for (const int k : used_entries(keyframes)) {
    const Keyframe& keyframe = keyframes[k];
    const Mat3 R_CW = keyframe.q_WC.toRotationMatrix().transpose();
    const ViewOfRows view = {R_CW, {keyframe.v_W, keyframe.w_C}, before};
    for (const int i : used_entries(*map)) {
      KeyframePoint& point = map->point(i);
      if (!keyframes.pixels(k)[i].seen || map->feature(i).is_target) continue;
      const Vec2 pixel = keyframes.pixels(k)[i].pixel();
      const Scalar far = point.has_depth                  ? (map->position(i) - keyframe.p_W).norm()
                         : keyframe.row_depth > Scalar(0) ? keyframe.row_depth
                                                          : depth;
      const Vec2 shift = (before - readout) * readout_column(now, view, pixel, 1 / far);
      keyframes.set_pixel(k, i, pixel + shift);
      if (k == keyframes.newest() && map->feature(i).last_seen_ns == keyframe.t_ns) point.pixel += shift;
      const HostPixel host = map->host_pixel(i);
      if (point.host == k && host.given) unproject(now, host.pixel + shift, &point.ray_K);
    }
  }
  now.readout = readout;
  map->lens().move(now);
}

}  // namespace pf
