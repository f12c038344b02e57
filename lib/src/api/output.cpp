#include "api/context.h"
#include "api/copy.h"
#include "base/elapsed.h"
#include "covariance/select.h"
#include "filter/gauge_information.h"
#include "filter/observe/point.h"

namespace {

using pf::copy;
using pf::copy_matrix;

void pose_at(const pf::FilterSlam& slam, int64_t t_ns, pf_pose_t* pose) {
  pf::Body body;
  pf::Mat6 covariance;
  slam.predict_pose(t_ns, &body, &covariance);
  pose->t_ns = t_ns;
  pose->q_WC[0] = static_cast<double>(body.q_WC.w());
  copy(body.q_WC.vec(), 3, pose->q_WC + 1);
  copy(body.p_W, 3, pose->p_WC);
  copy(body.v_W, 3, pose->v_W);
  copy(body.w_C, 3, pose->w_C);
  copy_matrix(covariance, pose->covariance);
}

int32_t feature_kind(pf::BlockKind kind) {
  switch (kind) {
    case pf::BlockKind::kPoint:
      return PF_FEATURE_POINT;
    case pf::BlockKind::kPlanePoint:
      return PF_FEATURE_FOLDED;
    case pf::BlockKind::kPatchPoint:
      return PF_FEATURE_FIXED;
    default:
      return PF_FEATURE_INVERSE_DEPTH;
  }
}

}  // namespace

pf_status_t pf_get_state(const pf_slam_t* slam, pf_state_t* state) {
  PF_REQUIRE_CONTEXT(slam);
  if (state == nullptr) return PF_ERROR_NULL;
  *state = static_cast<pf_state_t>(slam->slam.state());
  return PF_OK;
}

pf_status_t pf_get_pose(const pf_slam_t* slam, pf_pose_t* pose) {
  PF_REQUIRE_CONTEXT(slam);
  if (pose == nullptr) return PF_ERROR_NULL;
  if (!slam->slam.has_pose()) return PF_ERROR_STATE;
  pose_at(slam->slam, slam->slam.last_ns(), pose);
  return PF_OK;
}

pf_status_t pf_predict_pose(const pf_slam_t* slam, int64_t t_ns, pf_pose_t* pose) {
  PF_REQUIRE_CONTEXT(slam);
  if (pose == nullptr) return PF_ERROR_NULL;
  if (!slam->slam.has_pose()) return PF_ERROR_STATE;
  if (t_ns < slam->slam.last_ns()) return PF_ERROR_TIME;
  if (pf::elapsed_ns(slam->slam.last_ns(), t_ns) > INT64_C(10000000000)) return PF_ERROR_RANGE;
  pose_at(slam->slam, t_ns, pose);
  return PF_OK;
}

pf_status_t pf_project_point(const pf_slam_t* slam, const double p_W[3], double pixel[2], double covariance[4]) {
  PF_REQUIRE_CONTEXT(slam);
  if (p_W == nullptr || pixel == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(p_W, 3)) return PF_ERROR_NONFINITE;
  if (!slam->slam.has_pose()) return PF_ERROR_STATE;
  pf::Vec2 z;
  pf::Mat26 J_body;
  pf::Mat23 J_point;
  const pf::Vec3 p(static_cast<pf::Scalar>(p_W[0]), static_cast<pf::Scalar>(p_W[1]), static_cast<pf::Scalar>(p_W[2]));
  if (!pf::observe_point(slam->settings.camera, slam->slam.filter().state().body, p, &z, &J_body, &J_point))
    return PF_ERROR_RANGE;
  copy(z, 2, pixel);
  if (covariance == nullptr) return PF_OK;
  pf::Body body;
  pf::Mat6 P;
  slam->slam.predict_pose(slam->slam.last_ns(), &body, &P);
  const pf::Mat26 JP = J_body.lazyProduct(P);
  const pf::Mat2 C = JP.lazyProduct(J_body.transpose());
  copy_matrix(C, covariance);
  return PF_OK;
}

pf_status_t pf_get_features(const pf_slam_t* slam, pf_feature_t* features, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (features == nullptr && capacity > 0)) return PF_ERROR_NULL;
  const pf::FeatureTable& table = slam->slam.features();
  const pf::State& state = slam->slam.filter().state();
  *count = 0;
  for (int i = 0; i < table.capacity(); ++i) {
    if (!table.used(i)) continue;
    const size_t at = (*count)++;
    if (at >= capacity) continue;
    const pf::Feature& f = table[i];
    const pf::Block& block = state.block[f.slot];
    pf_feature_t& out = features[at];
    out = pf_feature_t();
    out.id = f.id;
    out.external_id = f.track;
    out.is_target = f.is_target ? 1 : 0;
    out.observations = f.observations;
    out.attempts = f.attempts;
    out.kind = feature_kind(block.kind);
    if (pf::is_planar(block.kind)) out.plane = slam->slam.planes().id_at(state.plane_of(f.slot));
    copy(slam->slam.filter().point(f.slot), 3, out.p_W);
    copy_matrix(slam->slam.filter().covariance3(f.slot), out.covariance);
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}

pf_status_t pf_get_matches(const pf_slam_t* slam, pf_match_t* matches, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (matches == nullptr && capacity > 0)) return PF_ERROR_NULL;
  *count = static_cast<size_t>(slam->slam.track_count());
  for (size_t i = 0; i < *count && i < capacity; ++i) {
    const pf::Match& t = slam->slam.tracks()[i];
    pf_match_t& out = matches[i];
    out.id = t.id;
    out.status = static_cast<int32_t>(t.status);
    out.kind = feature_kind(t.kind);
    copy(t.predicted, 2, out.predicted_px);
    copy_matrix(t.innovation, out.covariance_px);
    copy(t.measured, 2, out.measured_px);
    out.nis = static_cast<double>(t.nis);
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}

pf_status_t pf_get_report(const pf_slam_t* slam, pf_report_t* report) {
  PF_REQUIRE_CONTEXT(slam);
  if (report == nullptr) return PF_ERROR_NULL;
  const pf::FrameReport& r = slam->slam.report();
  *report = pf_report_t();
  report->t_ns = r.t_ns;
  report->state = static_cast<int32_t>(slam->slam.state());
  report->frames = r.frames;
  report->attempts = r.attempts;
  report->matches = r.matches;
  report->inliers = r.inliers;
  report->new_features = r.new_features;
  report->evicted = r.evicted;
  const pf::FeatureTable& table = slam->slam.features();
  const pf::State& state = slam->slam.filter().state();
  int unfolded_rows = 0;
  for (int i = 0; i < table.capacity(); ++i) {
    if (!table.used(i)) continue;
    ++report->features;
    const pf::Block& block = state.block[table[i].slot];
    switch (feature_kind(block.kind)) {
      case PF_FEATURE_POINT:
        ++report->features_point;
        break;
      case PF_FEATURE_INVERSE_DEPTH:
        ++report->features_inverse_depth;
        break;
      case PF_FEATURE_FOLDED:
        ++report->features_folded;
        break;
      default:
        ++report->features_fixed;
    }
    if (pf::is_planar(block.kind)) unfolded_rows += 3 - block.size;
  }
  report->planes = state.planes;
  report->state_dim = state.dim;
  report->state_dim_held = state.held_dim;
  for (int s = 0; s < state.slots; ++s)
    if (state.block[s].kind == pf::BlockKind::kPlane || state.block[s].kind == pf::BlockKind::kPatch)
      unfolded_rows -= state.block[s].size;
  report->state_dim_points_only = state.dim + unfolded_rows;
  report->nis = r.nis;
  report->nis_dof = r.nis_dof;
  report->kernels = static_cast<int32_t>(pf::kernels_id(slam->settings.kernels));
  for (int i = 0; i < PF_STAGE_COUNT; ++i) report->stage_ns[i] = r.stage_ns[i];
  return PF_OK;
}

pf_status_t pf_get_gauge_information(const pf_slam_t* slam, double* scratch, size_t scratch_count,
                                     double information[49]) {
  PF_REQUIRE_CONTEXT(slam);
  if (scratch == nullptr || information == nullptr) return PF_ERROR_NULL;
  if (!slam->slam.has_pose()) return PF_ERROR_STATE;
  const size_t n = static_cast<size_t>(slam->slam.filter().state().dim);
  if (scratch_count < n * (n + 8)) return PF_ERROR_MEMORY;
  return pf::gauge_information(slam->slam.filter(), scratch, information) ? PF_OK : PF_ERROR_RANGE;
}
