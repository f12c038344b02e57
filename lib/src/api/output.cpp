#include "api/context.h"
#include "api/copy.h"
#include "base/elapsed.h"
#include "covariance/select.h"
#include "vision/template_mask.h"

namespace {

using pf::copy;
using pf::copy_covariance;

/// (w, x, y, z)
void copy_quaternion(const pf::Quat& from, double* to) {
  to[0] = static_cast<double>(from.w());
  copy(from.vec(), 3, to + 1);
}

void pose_at(const pf::View& view, int64_t t_ns, pf_pose_t* pose) {
  pf::Body body;
  pf::Mat6 covariance;
  view.pose_at(t_ns, &body, &covariance);
  pose->t_ns = t_ns;
  pose->map_id = view.tracking().map_id();
  pose->reserved = 0;
  copy_quaternion(body.q_WC, pose->q_WC);
  copy(body.p_W, 3, pose->p_WC);
  copy(body.v_W, 3, pose->v_W);
  copy(body.w_C, 3, pose->w_C);
  copy_covariance(covariance, pose->covariance);
}

int32_t feature_kind(pf::BlockKind kind) {
  switch (pf::info(kind).form) {
    case pf::FeatureForm::kPoint:
      return PF_FEATURE_POINT;
    case pf::FeatureForm::kFolded:
      return PF_FEATURE_FOLDED;
    case pf::FeatureForm::kFixed:
      return PF_FEATURE_FIXED;
    default:
      return PF_FEATURE_INVERSE_DEPTH;
  }
}

}  // namespace

pf_status_t pf_get_state(const pf_slam_t* slam, pf_state_t* state) {
  PF_REQUIRE_CONTEXT(slam);
  if (state == nullptr) return PF_ERROR_NULL;
  *state = static_cast<pf_state_t>(slam->session.view().tracking().state());
  return PF_OK;
}

pf_status_t pf_get_pose(const pf_slam_t* slam, pf_pose_t* pose) {
  PF_REQUIRE_CONTEXT(slam);
  if (pose == nullptr) return PF_ERROR_NULL;
  const pf::View view = slam->session.view();
  if (!view.tracking().has_pose()) return PF_ERROR_STATE;
  pose_at(view, view.last_ns(), pose);
  return PF_OK;
}

pf_status_t pf_predict_pose(const pf_slam_t* slam, int64_t t_ns, pf_pose_t* pose) {
  PF_REQUIRE_CONTEXT(slam);
  if (pose == nullptr) return PF_ERROR_NULL;
  if (!slam->session.view().tracking().has_pose()) return PF_ERROR_STATE;
  if (t_ns < slam->session.view().last_ns()) return PF_ERROR_TIME;
  if (pf::elapsed_ns(slam->session.view().last_ns(), t_ns) > INT64_C(10000000000)) return PF_ERROR_RANGE;
  pose_at(slam->session.view(), t_ns, pose);
  return PF_OK;
}

pf_status_t pf_get_motion_since_mark(const pf_slam_t* slam, pf_motion_t* motion) {
  PF_REQUIRE_CONTEXT(slam);
  if (motion == nullptr) return PF_ERROR_NULL;
  const pf::View view = slam->session.view();
  pf::MotionView since;
  if (!view.motion_since_mark(&since)) return PF_NOTE_NOTHING;
  motion->mark_t_ns = since.mark_ns;
  motion->t_ns = view.last_ns();
  copy_quaternion(since.q_KC, motion->q_KC);
  copy(since.p_KC, 3, motion->p_KC);
  copy_covariance(since.covariance, motion->covariance);
  motion->map_id = view.tracking().map_id();
  motion->reserved = 0;
  return PF_OK;
}

pf_status_t pf_project_point(const pf_slam_t* slam, const double p_W[3], double pixel[2], double covariance[4]) {
  PF_REQUIRE_CONTEXT(slam);
  if (p_W == nullptr || pixel == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(p_W, 3)) return PF_ERROR_NONFINITE;
  if (!slam->session.view().tracking().has_pose()) return PF_ERROR_STATE;
  pf::Vec2 z;
  pf::Mat2 C;
  const pf::Vec3 p(static_cast<pf::Scalar>(p_W[0]), static_cast<pf::Scalar>(p_W[1]), static_cast<pf::Scalar>(p_W[2]));
  if (!slam->session.view().project(p, &z, covariance != nullptr ? &C : nullptr)) return PF_ERROR_RANGE;
  copy(z, 2, pixel);
  if (covariance != nullptr) copy_covariance(C, covariance);
  return PF_OK;
}

pf_status_t pf_get_features(const pf_slam_t* slam, pf_feature_t* features, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (features == nullptr && capacity > 0)) return PF_ERROR_NULL;
  const pf::View view = slam->session.view();
  *count = 0;
  for (int i = 0; i < view.map().features.capacity(); ++i) {
    if (!view.map().features.used(i)) continue;
    const size_t at = (*count)++;
    if (at >= capacity) continue;
    const pf::FeatureView f = view.feature(i);
    pf_feature_t& out = features[at];
    out = pf_feature_t();
    out.id = f.id;
    out.external_id = f.external_id;
    out.is_target = f.is_target ? 1 : 0;
    out.observations = f.observations;
    out.attempts = f.attempts;
    out.log_odds = static_cast<double>(f.log_odds);
    out.kind = feature_kind(f.kind);
    out.plane = f.plane;
    out.on_trial = f.on_trial ? 1 : 0;
    out.map_id = view.tracking().map_id();
    copy(f.p_W, 3, out.p_W);
    copy_covariance(f.covariance, out.covariance);
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}

pf_status_t pf_get_matches(const pf_slam_t* slam, pf_match_t* matches, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (matches == nullptr && capacity > 0)) return PF_ERROR_NULL;
  const pf::View view = slam->session.view();
  *count = static_cast<size_t>(view.frame().match_count());
  for (size_t i = 0; i < *count && i < capacity; ++i) {
    const pf::Match& t = view.frame().match(static_cast<int>(i));
    pf_match_t& out = matches[i];
    out.id = t.id;
    out.status = static_cast<int32_t>(t.status);
    out.kind = feature_kind(t.kind);
    copy(t.predicted, 2, out.predicted_px);
    copy_covariance(t.innovation, out.covariance_px);
    copy(t.measured, 2, out.measured_px);
    out.nis = static_cast<double>(t.nis);
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}

pf_status_t pf_get_patches(const pf_slam_t* slam, pf_patch_t* patches, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (patches == nullptr && capacity > 0)) return PF_ERROR_NULL;
  const pf::View view = slam->session.view();
  *count = 0;
  const pf::PatchStore* const stored = view.patches();
  for (int i = 0; stored != nullptr && i < stored->capacity(); ++i) {
    if (!stored->used(i)) continue;
    const size_t at = (*count)++;
    if (at >= capacity) continue;
    const pf::StoredPatch& p = (*stored)[i];
    pf_patch_t& out = patches[at];
    out = pf_patch_t();
    out.id = p.id;
    out.plane = p.wait.waits() ? 0 : view.map().planes.find(p.plane);
    out.status = static_cast<int32_t>(p.status);
    out.frames = p.frames;
    for (int k = 0; k < 4; ++k) copy(p.corner[k], 2, out.corners_px[k]);
    pf::copy_covariance(p.covariance, out.covariance_px);
    out.weight = static_cast<double>(p.weight);
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}

pf_status_t pf_get_template(const pf_slam_t* slam, uint32_t feature, pf_template_t* out) {
  PF_REQUIRE_CONTEXT(slam);
  if (out == nullptr) return PF_ERROR_NULL;
  pf::TemplateView t;
  if (!slam->session.view().template_of(feature, &t)) return PF_NOTE_NOTHING;
  *out = pf_template_t();
  out->feature = feature;
  out->side = t.shape->side;
  for (int y = 0; y < t.shape->side; ++y)
    for (int x = 0; x < t.shape->side; ++x) {
      const int at = y * t.shape->side + x;
      out->grey[at] = t.grey(x, y);
      out->mask[at] = pf::mask_probability(t.mask[at]);
    }
  copy(t.normal_W, 3, out->normal_W);
  out->sigma_normal_rad = static_cast<double>(t.sigma_normal);
  out->centre_px[0] = t.shape->left + t.shape->side / 2;
  out->centre_px[1] = t.shape->top + t.shape->side / 2;
  out->frames = t.shape->frames;
  return PF_OK;
}

pf_status_t pf_get_camera(const pf_slam_t* slam, pf_camera_t* camera, double* covariance) {
  PF_REQUIRE_CONTEXT(slam);
  if (camera == nullptr) return PF_ERROR_NULL;
  pf::Scalar C[pf::kLensParameters][pf::kLensParameters];
  const pf::Camera& lens = slam->session.view().lens(C);
  *camera = slam->config.camera;
  camera->model = lens.model;
  if (camera->estimate != PF_CAMERA_EXACT) {
    camera->fx = static_cast<double>(lens.fx);
    camera->fy = static_cast<double>(lens.fy);
    camera->cx = static_cast<double>(lens.cx);
    camera->cy = static_cast<double>(lens.cy);
    for (int i = 0; i < 8; ++i) camera->distortion[i] = static_cast<double>(lens.distortion[i]);
  }
  if (slam->session.settings().lens.rows.has_readout()) camera->readout_s = static_cast<double>(lens.readout);
  if (covariance == nullptr) return PF_OK;
  for (int i = 0; i < pf::kLensParameters; ++i)
    for (int j = 0; j < pf::kLensParameters; ++j)
      covariance[pf::kLensParameters * i + j] = static_cast<double>(C[i][j]);
  pf::repair_covariance(covariance, pf::kLensParameters);
  return PF_OK;
}

pf_status_t pf_get_report(const pf_slam_t* slam, pf_report_t* report) {
  PF_REQUIRE_CONTEXT(slam);
  if (report == nullptr) return PF_ERROR_NULL;
  const pf::View view = slam->session.view();
  const pf::FrameReport& r = view.frame().report;
  const pf::MapCounts map = view.counts();
  *report = pf_report_t();
  report->t_ns = r.t_ns;
  report->state = static_cast<int32_t>(view.tracking().state());
  report->frames = r.frames;
  report->attempts = r.attempts;
  report->matches = r.matches;
  report->inliers = r.inliers;
  report->new_features = r.new_features;
  report->evicted = r.evicted;
  report->features = map.features;
  report->features_point = map.points;
  report->features_inverse_depth = map.inverse_depths;
  report->features_folded = map.folded;
  report->features_fixed = map.fixed;
  report->features_trial = map.trial;
  report->planes = map.planes;
  report->state_dim = map.state_dim;
  report->state_dim_held = map.state_dim_held;
  report->state_dim_points_only = map.state_dim_points_only;
  report->map_id = view.tracking().map_id();
  report->kept_views = view.kept_views();
  report->patches = map.patches;
  report->cameras = map.cameras;
  report->nis = r.nis;
  report->nis_dof = r.nis_dof;
  report->duplicates = r.duplicates;
  report->covariance_repairs = r.repairs;
  report->log_odds = view.tracking().has_pose() ? static_cast<double>(view.tracking().belief().log_odds()) : 0.0;
  report->consensus = r.consensus;
  report->reason = static_cast<int32_t>(r.reason);
  report->sigma_gate_px = static_cast<double>(view.noise().sigma_gate());
  report->sigma_info_px = static_cast<double>(view.noise().sigma_info());
  report->correlation_frames = static_cast<double>(view.noise().correlation_frames());
  report->kernels = static_cast<int32_t>(pf::kernels_id(slam->session.settings().kernels));
  for (int i = 0; i < PF_STAGE_COUNT; ++i) report->stage_ns[i] = r.stage_ns[i];
  report->keyframes = map.keyframes;
  report->places = map.places;
  report->places_returned = map.places_returned;
  const pf::MapCorrection& correction = view.frame().correction;
  report->correction_scale = static_cast<double>(correction.T.s);
  copy_quaternion(correction.T.q, report->correction_q);
  copy(correction.T.t, 3, report->correction_p);
  report->correction_from_map_id = correction.from_map_id != 0 ? correction.from_map_id : report->map_id;
  report->masked_permille = static_cast<uint32_t>(view.frame().masked);
  report->templates = r.templates;
  if (r.templates > 0) report->template_area = static_cast<double>(r.template_area / static_cast<float>(r.templates));
  return PF_OK;
}
