#include "filter_slam/filter_anchors.h"

#include "base/table_entries.h"
#include "model/camera_at.h"
#include "model/reference_camera.h"

namespace pf {

Status FilterAnchors::add(const AnchorRequest& asked, std::uint32_t map_id, std::int64_t t_ns,
                          std::int64_t not_since_ns, std::uint32_t* id) {
  const int entry = map_.anchors.find_free();
  if (entry < 0) return Status::kFull;
  const State& state = filter_.state();
  const CameraAt camera = camera_at(state, Scalar(0));
  const RelativePlace T_WV = {camera.q_WC, camera.p_W};
  Anchor anchor;
  anchor.map_id = map_id;
  anchor.t_ns = t_ns;
  anchor.T_VA = T_WV.inverse().of(asked.T_WA);
  if (asked.plane >= 0) {
    const Block& plane = state.block[map_.planes[asked.plane].slot];
    Vec3 n_W;
    Scalar d_W;
    plane_normal(state.frame_of(plane), plane.xyz(), &n_W, &d_W);
    anchor.plane = map_.planes[asked.plane].id;
    anchor.T_VA.q = upright_on(T_WV.q.conjugate() * n_W);
    HeldPose on;
    if (!project(filter_.lens(), anchor.T_VA.p, &anchor.pixel) ||
        !held_pose_on(T_WV, anchor.T_VA, state.frame_of(plane), plane.xyz(), &on))
      return Status::kRange;
  }
  const int shared = camera_of(t_ns, map_id);
  anchor.camera = shared >= 0 ? shared : copy_camera(not_since_ns);
  if (anchor.camera < 0) return Status::kFull;
  filter_.pin(anchor.camera);
  *id = map_.anchors.add(entry, anchor);
  place(&map_.anchors[entry]);
  return Status::kOk;
}

/// Anchors of one frame share a camera. -1: none has been set in it.
int FilterAnchors::camera_of(std::int64_t t_ns, std::uint32_t map_id) const {
  for (const int i : used_entries(map_.anchors)) {
    const Anchor& other = map_.anchors[i];
    if (other.camera >= 0 && other.t_ns == t_ns && other.map_id == map_id) return other.camera;
  }
  return -1;
}

/// -1: there is no room.
int FilterAnchors::copy_camera(std::int64_t not_since_ns) {
  constexpr int kRows = 6;
  if (filter_.room() < kRows && !features_.make_rows(kRows, not_since_ns)) return -1;
  return filter_.add_reference_camera();
}

void FilterAnchors::remove(int entry) {
  const int camera = map_.anchors[entry].camera;
  map_.anchors.remove(entry);
  if (camera >= 0) filter_.unpin(camera);
}

/// It stays where it is in W.
void FilterAnchors::leave(int entry) {
  Anchor& anchor = map_.anchors[entry];
  const int camera = anchor.camera;
  anchor.leave_plane();
  anchor.hold_by(0, RelativePlace());
  anchor.camera = Anchor::kNoCamera;
  if (camera >= 0) filter_.unpin(camera);
}

/// The filter has begun again with this frame. Where there is no room for its camera, W holds the anchors.
void FilterAnchors::give_awaited(std::uint32_t map_id, std::int64_t not_since_ns) {
  int copy = Anchor::kAwaitsCamera;
  for (const int i : used_entries(map_.anchors)) {
    Anchor& anchor = map_.anchors[i];
    if (anchor.map_id != map_id || anchor.camera != Anchor::kAwaitsCamera) continue;
    if (copy == Anchor::kAwaitsCamera) copy = copy_camera(not_since_ns);
    anchor.camera = copy;
    anchor.t_ns = INT64_MIN;  // no other anchor shares what holds it
    if (copy >= 0)
      filter_.pin(copy);
    else
      leave(i);
  }
}

void FilterAnchors::follow(std::uint32_t map_id, std::int64_t not_since_ns) {
  if (!kHasMemory) return;
  give_awaited(map_id, not_since_ns);
  for (const int i : used_entries(map_.anchors)) {
    Anchor& anchor = map_.anchors[i];
    if (anchor.map_id != map_id || anchor.camera < 0) continue;
    if (filter_.block_is_sound(anchor.camera))
      place(&anchor);
    else
      leave(i);
  }
}

/// By K and by what is between it and V, on a plane by that and by the lens with which V saw it:
///
///   e = J_V (A e_K + e_between) + J_plane e_plane + J_ray |p_VA| R_V J_ray_lens e_lens        A: held_pose(T_WK, T_KV)
void FilterAnchors::place(Anchor* anchor) const {
  using model::ReferenceCamera;
  Anchor& a = *anchor;
  const State& state = filter_.state();
  const Block& camera = state.block[a.camera];
  const HeldPose view = held_pose({ReferenceCamera::q_WC(camera), ReferenceCamera::p_WC(camera)}, a.T_KV);
  const std::uint32_t now = a.plane != 0 ? map_.planes.find(a.plane) : 0;
  if (now == 0)
    a.leave_plane();
  else
    a.plane = now;
  a.T_WV = {view.q_WA, view.p_WA};
  RowsOf<6, 9 + kLensParameters, 3> J;
  J.parts = 1;
  J.part[0] = Part::of(a.camera, 0, 6);
  const auto covariance_by = [&](const Mat6& J_V, int columns) {
    put<6, 6>(J.h, columns, 0, Mat6(J_V.lazyProduct(view.J_V)));
    return Mat6(filter_.rounded_covariance_of<6>(J) + J_V.lazyProduct(a.between).lazyProduct(J_V.transpose()));
  };
  a.covariance_WV = covariance_by(Mat6::Identity(), 6);
  const HeldPose held = held_pose(a.T_WV, a.T_VA);
  HeldPose on = held;
  RelativePlace T_VA = a.T_VA;
  Vec3 ray_V;
  Mat32 J_ray_pixel;
  const int lens_rows = state.lens_rows.count;
  const bool by_lens = now != 0 && lens_rows > 0 && unproject(state.lens, a.pixel, &ray_V, &J_ray_pixel);
  if (by_lens) T_VA.p = a.T_VA.p.norm() * ray_V;
  const int slot = now != 0 ? map_.planes[map_.planes.entry_of(now)].slot : -1;
  a.is_on_plane =
      slot >= 0 && held_pose_on(a.T_WV, T_VA, state.frame_of(state.block[slot]), state.block[slot].xyz(), &on);
  a.T_WA = {on.q_WA, on.p_WA};
  if (!a.is_on_plane) {
    a.covariance = covariance_by(held.J_V, 6) + a.beside;
    return;
  }
  const int columns = 9 + (by_lens ? lens_rows : 0);
  J.parts = by_lens ? 3 : 2;
  J.part[1] = Part::of(slot, 0, 3);
  put<6, 3>(J.h, columns, 6, on.J_plane);
  if (by_lens) {
    J.part[2] = Part::body(state.layout.row(BodyPart::kLens), lens_rows);
    const Mat3 J_ray = a.T_VA.p.norm() * on.J_ray * a.T_WV.q.toRotationMatrix();
    Eigen::Matrix<Scalar, 6, kLensParameters> J_lens = Eigen::Matrix<Scalar, 6, kLensParameters>::Zero();
    J_lens.bottomRows<3>() = J_ray.lazyProduct(ray_lens_jacobian(state.lens, ray_V, J_ray_pixel));
    put_lens<6>(J_lens, state.lens_rows, 9, columns, J.h);
  }
  a.covariance = covariance_by(on.J_V, columns);
  a.beside = covariance_by(on.J_V - held.J_V, columns);
}

}  // namespace pf
