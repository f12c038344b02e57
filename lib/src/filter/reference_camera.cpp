#include "model/reference_camera.h"

#include "filter/filter.h"
#include "filter/known_camera.h"
#include "geometry/relative_pose.h"
#include "geometry/small_cholesky.h"
#include "model/camera_at.h"
#include "model/kinds.h"

/// Reference cameras: copies of the camera that stay in the state.

namespace pf {

int Filter::add_reference_camera() {
  const int slot = take_slot(BlockKind::kReferenceCamera);
  if (slot < 0) return -1;
  const CameraAt camera = camera_at(state_, Scalar(0));
  RowsOf<6, CameraAt::kMaxColumns, 1> J;
  J.parts = 1;
  J.part[0] = camera.part();
  camera.chain<6>(Mat6::Identity(), J.h, camera.columns());
  const Scalar none[36] = {};
  blocks_.augment(slot, J, none);
  model::ReferenceCamera::set(&state_.block[slot], camera.q_WC, camera.p_W);
  state_.block[slot].owner = static_cast<std::int16_t>(cameras_++ & INT16_MAX);
  return slot;
}

int Filter::add_known_camera(const Quat& q_WK, const Vec3& p_WK, const Mat6& covariance) {
  tell_gauge();
  const int slot = take_slot(BlockKind::kReferenceCamera);
  if (slot < 0) return -1;
  augment_known<6>(&blocks_, slot, covariance);
  model::ReferenceCamera::set(&state_.block[slot], q_WK, p_WK);
  return slot;
}

///   f - o = R_K x_K = b / rho,   e_f - e_o = -[R_K x_K]x theta + R_K e_x
///   (e_b, e_rho) = M (e_f - e_o),   M = (rho B^T; -rho^2 b^T)    B: the bearing's tangent basis
int Filter::add_point_of(int camera, int anchor, const Vec3& x_K, const Mat3& covariance_K) {
  using model::ReferenceCamera;
  PF_ASSERT(state_.block[anchor].kind == BlockKind::kAnchor);
  const int slot = take_slot(BlockKind::kInverseDepth);
  if (slot < 0) return -1;
  const Mat3 R_WK = ReferenceCamera::q_WC(state_.block[camera]).normalized().toRotationMatrix();
  const Vec3 from_o = R_WK * x_K;
  InverseDepth feature;
  feature.rho = Scalar(1) / from_o.norm();
  const Vec3 b = feature.rho * from_o;
  feature.q_b = turn_z_to(b);
  Mat3 M;
  M.topRows<2>() = feature.rho * feature.q_b.toRotationMatrix().leftCols<2>().transpose();
  M.row(2) = -feature.rho * feature.rho * b.transpose();
  RowsOf<3, 3, 1> J;
  J.parts = 1;
  J.part[0] = Part::of(camera, 0, 3);
  put<3, 3>(J.h, 3, 0, Mat3(-M.lazyProduct(hat(from_o))));
  const Mat3 M_K = M * R_WK;
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, Mat3(M_K * covariance_K * M_K.transpose()));
  blocks_.augment(slot, J, raw);
  state_.block[slot].set_inverse_depth(feature);
  state_.adopt(anchor, slot);
  return slot;
}

///   C_f|K = C_ff - C_fK C_KK^-1 C_Kf,   x_K = R_K^T (f - p_K)
bool point_given(const Filter& filter, int camera, int slot, Vec3* x_K, Mat3* covariance_K) {
  using model::ReferenceCamera;
  const State& state = filter.state();
  Place at;
  if (!find_point(state, slot, &at)) return false;
  const Block& block = state.block[camera];
  const Mat3 R_KW = ReferenceCamera::q_WC(block).conjugate().toRotationMatrix();
  constexpr int kColumns = Place::kMaxColumns + 6;
  RowsOf<9, kColumns, Place::kMaxParts + 1> J;
  const int columns = at.columns + 6;
  J.parts = at.parts + 1;
  for (int p = 0; p < at.parts; ++p) J.part[p] = at.part[p];
  J.part[at.parts] = Part::of(camera, 0, 6);
  for (int i = 0; i < 9 * columns; ++i) J.h[i] = Scalar(0);
  for (int c = 0; c < at.columns; ++c)
    for (int r = 0; r < 3; ++r) J.h[r * columns + c] = at.J_o(r, c);
  for (int r = 0; r < 6; ++r) J.h[(3 + r) * columns + at.columns + r] = Scalar(1);
  const Eigen::Matrix<Scalar, 9, 9> C = filter.blocks().covariance_of<9>(J);
  SmallCholesky<6> cholesky;
  if (!cholesky.factor(C.bottomRightCorner<6, 6>())) return false;
  const Eigen::Matrix<Scalar, 6, 3> G = cholesky.solve<3>(C.bottomLeftCorner<6, 3>());
  Mat3 left = C.topLeftCorner<3, 3>() - C.topRightCorner<3, 6>().lazyProduct(G);
  if (!at.has_rows) left += at.J_own * state.block[slot].inside() * at.J_own.transpose();
  *x_K = R_KW * (at.o - ReferenceCamera::p_WC(block));
  *covariance_K = R_KW * left * R_KW.transpose();
  return true;
}

void Filter::unpin(int slot) {
  Block& block = state_.block[slot];
  PF_ASSERT(block.pins > 0);
  if (--block.pins == 0 && block.children == 0) remove(&slot, 1);
}

void Filter::motion_since(int camera, Quat* q_KC, Vec3* p_KC, Mat6* covariance) const {
  using model::ReferenceCamera;
  const Block& block = state_.block[camera];
  PF_ASSERT(block.kind == BlockKind::kReferenceCamera);
  const CameraAt now = camera_at(state_, Scalar(0));
  const RelativePose motion =
      relative_pose(ReferenceCamera::q_WC(block), ReferenceCamera::p_WC(block), now.q_WC, now.p_W);
  *q_KC = motion.q_KC;
  *p_KC = motion.p_KC;
  RowsOf<6, CameraAt::kMaxColumns + 6, 2> J;
  J.parts = 2;
  J.part[0] = now.part();
  J.part[1] = Part::of(camera, 0, 6);
  const int columns = now.columns() + 6;
  now.chain<6>(motion.J_C, J.h, columns);
  put<6, 6>(J.h, columns, now.columns(), motion.J_K);
  *covariance = rounded_covariance_of<6>(J);
}

}  // namespace pf
