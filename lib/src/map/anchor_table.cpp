#include "map/anchor_table.h"

namespace pf {

void place_by(const RelativePlace& T_WK, const Mat6& covariance_WK, const AnchorPlane* plane, Anchor* anchor) {
  Anchor& a = *anchor;
  const HeldPose view = held_pose(T_WK, a.T_KV);
  a.T_WV = {view.q_WA, view.p_WA};
  a.covariance_WV = view.J_V.lazyProduct(covariance_WK).lazyProduct(view.J_V.transpose()) + a.between;
  const HeldPose held = held_pose(a.T_WV, a.T_VA);
  HeldPose on = held;
  a.is_on_plane = plane != nullptr && held_pose_on(a.T_WV, a.T_VA, plane->frame, plane->x, &on);
  if (a.is_on_plane) {
    const Mat6 apart = on.J_V - held.J_V;
    a.beside = apart.lazyProduct(a.covariance_WV).lazyProduct(apart.transpose()) +
               on.J_plane.lazyProduct(plane->covariance).lazyProduct(on.J_plane.transpose());
    a.covariance = on.J_V.lazyProduct(a.covariance_WV).lazyProduct(on.J_V.transpose()) +
                   on.J_plane.lazyProduct(plane->covariance).lazyProduct(on.J_plane.transpose());
  } else {
    if (plane != nullptr && a.beside.isZero(0)) {  // its distance along the ray is not constrained
      const Scalar length2 = a.T_VA.p.squaredNorm();
      a.beside.diagonal() << Vec3::Ones(), Vec3::Constant(length2);
    }
    a.covariance = held.J_V.lazyProduct(a.covariance_WV).lazyProduct(held.J_V.transpose()) + a.beside;
  }
  a.T_WA = {on.q_WA, on.p_WA};
}

int AnchorTable::count() const {
  int count = 0;
  for (int i = 0; i < capacity_; ++i) count += used(i) ? 1 : 0;
  return count;
}

int AnchorTable::find_free() const {
  for (int i = 0; i < capacity_; ++i)
    if (!used(i)) return i;
  return -1;
}

void AnchorTable::move(std::uint32_t map_id, std::uint32_t new_map_id, const Similarity& T) {
  const auto move = [&](RelativePlace* place) { *place = {(T.q * place->q).normalized(), T.of(place->p)}; };
  for (const int i : used_entries(*this)) {
    Anchor& a = anchor_[i];
    if (a.map_id != map_id) continue;
    a.map_id = new_map_id;
    if (a.place == 0 && a.camera == Anchor::kNoCamera)
      move(&a.T_KV);  // K is W itself
    else
      a.T_KV.p *= T.s;
    a.T_VA.p *= T.s;
    move(&a.T_WV);
    move(&a.T_WA);
    for (Mat6* P : {&a.between, &a.beside, &a.covariance_WV, &a.covariance}) *P = T.of_pose_covariance(*P);
  }
}

}  // namespace pf
