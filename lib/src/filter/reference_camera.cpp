#include "model/reference_camera.h"

#include "filter/filter.h"
#include "geometry/relative_pose.h"
#include "model/camera_at.h"

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
  return slot;
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
