#include "filter/filter.h"
#include "geometry/small_cholesky.h"

/// Planes known beforehand: they enter with a prior, which can be taken back.

namespace pf {

int Filter::add_known_plane(const PlaneFrame& frame, const Mat3& covariance, Scalar roughness, bool apart) {
  if (state_.planes >= state_.max_planes) return -1;
  if (!apart) tell_gauge();
  const int slot = take_slot(apart ? BlockKind::kPlaneApart : BlockKind::kPlane);
  if (slot < 0) return -1;
  augment_known<3>(&blocks_, slot, covariance);
  place_plane(slot, frame, roughness);
  return slot;
}

/// Scales means and P; what is apart belongs to W's directions and stays. Then the planes are correlated with the gauge of the map.
void Filter::join_planes_apart(Scalar scale, const Vec3& pivot) {
  Scalar* factor = blocks_.row_factors();
  for (int i = 0; i < 3; ++i) factor[Body::kPosition + i] = scale;
  state_.body.p_W *= scale;
  if (state_.layout.has(BodyPart::kVelocity)) {
    for (int i = 0; i < 3; ++i) factor[state_.layout.row(BodyPart::kVelocity) + i] = scale;
    state_.body.v_W *= scale;
  }
  if (state_.layout.has(BodyPart::kAcceleration)) {
    for (int i = 0; i < 3; ++i) factor[state_.layout.row(BodyPart::kAcceleration) + i] = scale;
    state_.body.a_C *= scale;
  }
  scale_map(scale, factor);
  blocks_.scale_rows(factor);
  translate((Scalar(1) - scale) * pivot);
  tell_gauge();
  for (int s = 0; s < state_.slots; ++s)
    if (state_.block[s].kind == BlockKind::kPlaneApart) state_.block[s].kind = BlockKind::kPlane;
}

/// Translates all places but those of planes that are apart; no error changes.
void Filter::translate(const Vec3& t) {
  state_.body.p_W += t;
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (block.kind == BlockKind::kAnchor || block.kind == BlockKind::kPoint) block.set_xyz(block.xyz() + t);
    if (block.kind == BlockKind::kReferenceCamera)
      for (int i = 0; i < 3; ++i) block.value[4 + i] += t(i);
    if (block.kind == BlockKind::kPlane) state_.plane_frame[block.frame].o_W += t;
  }
}

/// Removes what the plane's prior, zero with covariance C, contributed, but for 1 / widening of it. The information D is removed:
///
///   D = C^-1 - ((1 + w) C)^-1,   P' = (P^-1 - E D E^T)^-1 = P + P_xp M P_px,   M = ((1 + 1/w) C - P_pp)^-1,
///
/// E the columns of the plane. The mean would move by P_xp M e, e the plane now, (a, b, h). It stays, and that counts as uncertain:
///
///   P += P_xp (M + M e e^T M) P_px
bool Filter::forget_prior(int plane, const Mat3& prior, Scalar widening) {
  const Part part = Part::of(plane, 0, 3);
  RowsOf<3, 3, 1> J;
  J.parts = 1;
  J.part[0] = part;
  put<3, 3>(J.h, 3, 0, Mat3::Identity());
  SmallCholesky<3> cholesky;
  if (!cholesky.factor((Scalar(1) + Scalar(1) / widening) * prior - blocks_.covariance_of<3>(J))) return false;
  const Vec3 Me = cholesky.solve<1>(state_.block[plane].xyz());
  blocks_.inflate_by(part, cholesky.inverse() + Me * Me.transpose());
  return true;
}

}  // namespace pf
