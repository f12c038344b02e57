#include <algorithm>

#include "filter/filter.h"
#include "filter/row_follow.h"
#include "model/reference_camera.h"
#include "observe/ray_point.h"

/// Patches on planes: corners that a reference camera saw, as the camera sees them now (lib/docs/theory/homography.md).

namespace pf {

int Filter::add_patch(int camera, const PatchMeasurement::Matrix& covariance) {
  PF_ASSERT(state_.block[camera].kind == BlockKind::kReferenceCamera);
  const int slot = take_slot(BlockKind::kPatchCorners);
  if (slot < 0) return -1;
  augment_known<PatchMeasurement::kHeight>(&blocks_, slot, covariance);
  state_.adopt(camera, slot);
  return slot;
}

bool Filter::predict_patch(const Camera& lens, int patch, int plane, const Vec2* reference_px,
                           PatchMeasurement* out) const {
  using model::ReferenceCamera;
  const Block &corners = state_.block[patch], &reference = state_.block[corners.parent], &wall = state_.block[plane];
  PF_ASSERT(corners.kind == BlockKind::kPatchCorners);
  const bool rolls = rows_roll(state_, lens);
  const int lens_rows = state_.lens_rows.count;
  CameraAt camera = camera_at(state_, Scalar(0));
  const Part body = rolls ? camera_at(state_, lens.readout).part() : camera.part();
  const int at_reference = body.size, at_plane = at_reference + 6, at_own = at_plane + 3, at_lens = at_own + 8;
  const int columns = at_lens + lens_rows;
  std::fill(out->H.h, out->H.h + PatchMeasurement::kHeight * columns, Scalar(0));
  for (int k = 0; k < PatchMeasurement::kHeight / 2; ++k) {
    const Vec2 pixel = reference_px[k] + Vec2(corners.value[2 * k], corners.value[2 * k + 1]);
    RayPoint point;
    const auto observe = [&] {
      return point.observe(lens, camera, ReferenceCamera::q_WC(reference), ReferenceCamera::p_WC(reference),
                           state_.frame_of(wall), wall.xyz(), pixel, lens_rows > 0);
    };
    camera = camera_at(state_, Scalar(0));
    if (!observe()) return false;
    Mat2 M = Mat2::Identity();
    for (int round = 0; rolls && round < 2; ++round) {  // as predict_pixel
      camera = camera_at(state_, row_time(lens, point.z.y()));
      if (!observe()) return false;
      M = row_follow(camera, point.J_camera, lens.readout / static_cast<Scalar>(lens.height));
    }
    Scalar* h = out->H.h + 2 * k * columns;
    camera.chain<2>(M * point.J_camera, h, columns);
    put<2, 6>(h, columns, at_reference, M * point.J_reference);
    put<2, 3>(h, columns, at_plane, M * point.J_plane);
    put<2, 2>(h, columns, at_own + 2 * k, M * point.J_own);
    if (lens_rows > 0) {
      LensJacobian J_lens = point.J_lens;
      J_lens.col(kReadoutParameter) = camera.by_readout<2>(point.J_camera, lens.readout);
      put_lens<2>(M * J_lens, state_.lens_rows, at_lens, columns, h);
    }
    out->predicted.segment<2>(2 * k) = point.z;
  }
  out->block = patch;
  out->H.part[0] = body;
  out->H.part[1] = Part::of(corners.parent, 0, 6);
  out->H.part[2] = Part::of(plane, 0, 3);
  out->H.part[3] = Part::of(patch, 0, 8);
  out->H.parts = 4;
  if (lens_rows > 0) out->H.part[out->H.parts++] = Part::body(state_.layout.row(BodyPart::kLens), lens_rows);
  return true;
}

}  // namespace pf
