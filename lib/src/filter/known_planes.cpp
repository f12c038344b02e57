#include "filter/filter.h"
#include "geometry/small_cholesky.h"

/// Planes known beforehand: they enter with a prior, which can be taken back.

namespace pf {

int Filter::add_known_plane(const PlaneFrame& frame, const Mat3& covariance, Scalar roughness) {
  if (state_.planes >= state_.max_planes) return -1;
  tell_gauge();
  const int slot = take_slot(BlockKind::kPlane);
  if (slot < 0) return -1;
  Rows known;  // depends on nothing
  known.rows = 3;
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, covariance);
  blocks_.augment(slot, known, raw);
  place_plane(slot, frame, roughness);
  return slot;
}

/// What the prior of the plane, zero with covariance C, has taught is taken back but for 1 / widening of it. Information D goes,
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
