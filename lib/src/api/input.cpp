#include <cmath>

#include "api/checks.h"
#include "api/context.h"
#include "frame/frame_entry.h"

namespace {

using pf::is_covariance;
using pf::kMaxMetres;
using pf::kMaxRate;
using pf::quaternion_from;
using pf::Scalar;
using pf::vec3;
using pf::within;

/// Where a rectangle is in W; all zero: W is the rectangle's frame.
pf_status_t place_from(const pf_target_t& target, pf::Target* out) {
  if (!pf::finite(target.q_WT, 4) || !pf::finite(target.p_WT, 3)) return PF_ERROR_NONFINITE;
  if (within(target.q_WT, 4, 0.0) && within(target.p_WT, 3, 0.0)) return PF_OK;
  if (!quaternion_from(target.q_WT, &out->q_WT) || !within(target.p_WT, 3, kMaxMetres)) return PF_ERROR_RANGE;
  out->p_WT = vec3(target.p_WT);
  out->has_place = true;
  return PF_OK;
}

pf_status_t body_from(const pf_pose_t& pose, pf::Body* body) {
  if (!pf::finite(pose.q_WC, 4) || !pf::finite(pose.p_WC, 3) || !pf::finite(pose.covariance, 36) ||
      !pf::finite(pose.v_W, 3) || !pf::finite(pose.w_C, 3))
    return PF_ERROR_NONFINITE;
  if (!within(pose.p_WC, 3, kMaxMetres) || !within(pose.v_W, 3, kMaxMetres) || !within(pose.w_C, 3, kMaxRate))
    return PF_ERROR_RANGE;
  if (!is_covariance(pose.covariance, 6)) return PF_ERROR_RANGE;
  if (!quaternion_from(pose.q_WC, &body->q_WC)) return PF_ERROR_RANGE;
  body->p_W = vec3(pose.p_WC);
  body->v_W = vec3(pose.v_W);
  body->w_C = vec3(pose.w_C);
  return PF_OK;
}

}  // namespace

pf_status_t pf_start_from_target(pf_slam_t* slam, const pf_target_t* target) {
  PF_BEGIN_CHANGE(slam);
  if (target == nullptr) return PF_ERROR_NULL;
  if (slam->session.view().used()) return PF_ERROR_STATE;
  if (!pf::finite(&target->sigma, 1)) return PF_ERROR_NONFINITE;
  if (!(target->sigma >= pf::kMinSigma && target->sigma < 1e3)) return PF_ERROR_RANGE;
  pf::Target t;
  t.sigma_m = static_cast<Scalar>(target->sigma);
  if (target->kind == PF_TARGET_RECTANGLE) {
    const double size[2] = {target->width, target->height};
    if (!pf::finite(size, 2)) return PF_ERROR_NONFINITE;
    for (double s : size)
      if (!(s > 1e-4 && s < 1e3)) return PF_ERROR_RANGE;
    t.kind = pf::TargetKind::kRectangle;
    t.width = static_cast<Scalar>(target->width);
    t.height = static_cast<Scalar>(target->height);
    const pf_status_t status = place_from(*target, &t);
    if (status != PF_OK) return status;
  } else if (target->kind == PF_TARGET_POINTS) {
    if (target->count < 4 || target->count > PF_TARGET_MAX_POINTS) return PF_ERROR_RANGE;
    t.kind = pf::TargetKind::kPoints;
    t.count = target->count;
    for (int i = 0; i < t.count; ++i) {
      if (!pf::finite(target->points_W[i], 3)) return PF_ERROR_NONFINITE;
      if (!within(target->points_W[i], 3, kMaxMetres)) return PF_ERROR_RANGE;
      t.point_W[i] = vec3(target->points_W[i]);
    }
    const pf_status_t status = body_from(target->first_pose, &t.first_pose);
    if (status != PF_OK) return status;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        t.first_covariance(i, j) = static_cast<Scalar>(target->first_pose.covariance[i * 6 + j]);
  } else {
    return PF_ERROR_RANGE;
  }
  return in_call.end(slam->session.start_from_target(t));
}

pf_status_t pf_start_from_pose(pf_slam_t* slam, const pf_pose_t* pose, const double velocity_covariance[36]) {
  PF_BEGIN_CHANGE(slam);
  if (pose == nullptr) return PF_ERROR_NULL;
  if (slam->session.view().used()) return PF_ERROR_STATE;
  pf::KnownBody known;
  const pf_status_t status = body_from(*pose, &known.body);
  if (status != PF_OK) return status;
  const pf::BodyLayout& layout = slam->session.settings().body;
  const bool moves = layout.has(pf::BodyPart::kVelocity);
  const int dim = layout.known_rows();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) known.covariance[i * dim + j] = static_cast<Scalar>(pose->covariance[i * 6 + j]);
  if (moves) {
    if (velocity_covariance == nullptr) return PF_ERROR_NULL;
    if (!pf::finite(velocity_covariance, 36)) return PF_ERROR_NONFINITE;
    if (!is_covariance(velocity_covariance, 6)) return PF_ERROR_RANGE;
    const int first = layout.row(pf::BodyPart::kVelocity);  // the angular velocity follows
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        known.covariance[(first + i) * dim + first + j] = static_cast<Scalar>(velocity_covariance[i * 6 + j]);
  }
  return in_call.end(slam->session.start_from_pose(known));
}

pf_status_t pf_set_second_pose(pf_slam_t* slam, int64_t t_ns, const pf_pose_t* pose) {
  PF_BEGIN_CHANGE(slam);
  if (pose == nullptr) return PF_ERROR_NULL;
  pf::Body body;
  const pf_status_t status = body_from(*pose, &body);
  if (status != PF_OK) return status;
  const double* P = pose->covariance;
  const Scalar sigma = static_cast<Scalar>(std::sqrt(P[21] + P[28] + P[35]));
  return in_call.end(slam->session.set_second_pose(t_ns, body.p_W, sigma));
}

pf_status_t pf_withdraw_target(pf_slam_t* slam) {
  PF_BEGIN_CHANGE(slam);
  slam->session.withdraw_target();
  return in_call.end(PF_OK);
}

pf_status_t pf_mark_pose(pf_slam_t* slam) {
  PF_BEGIN_CHANGE(slam);
  return in_call.end(slam->session.mark_pose());
}

pf_status_t pf_push_control(pf_slam_t* slam, const double dv_C[3], const double dw_C[3]) {
  PF_BEGIN_CHANGE(slam);
  if (dv_C == nullptr || dw_C == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(dv_C, 3) || !pf::finite(dw_C, 3)) return PF_ERROR_NONFINITE;
  if (!within(dv_C, 3, kMaxMetres) || !within(dw_C, 3, kMaxRate)) return PF_ERROR_RANGE;
  if (!slam->session.takes_control()) return PF_ERROR_STATE;
  slam->session.push_control(vec3(dv_C), vec3(dw_C));
  return in_call.end(PF_OK);
}

pf_status_t pf_push_frame(pf_slam_t* slam, const pf_image_t* image) {
  PF_BEGIN_CHANGE(slam);
  if (image == nullptr || image->pixels == nullptr) return PF_ERROR_NULL;
  if (!slam->session.takes_images()) return PF_ERROR_STATE;
  const pf_camera_t& camera = slam->config.camera;
  if (image->width != camera.width || image->height != camera.height || image->stride < image->width)
    return PF_ERROR_SIZE;
  if (!pf::is_next_frame(slam->session.view().frame(), image->t_ns)) return PF_ERROR_TIME;
  return in_call.end(
      slam->session.push_frame({image->pixels, image->width, image->height, image->stride}, image->t_ns));
}

pf_status_t pf_push_observations(pf_slam_t* slam, int64_t t_ns, const pf_observation_t* observations, size_t count) {
  PF_BEGIN_CHANGE(slam);
  if (observations == nullptr && count > 0) return PF_ERROR_NULL;
  if (!slam->session.takes_observations()) return PF_ERROR_STATE;
  if (!pf::is_next_frame(slam->session.view().frame(), t_ns)) return PF_ERROR_TIME;
  for (size_t i = 0; i < count; ++i) {
    const pf_observation_t& o = observations[i];
    if (!pf::finite(o.pixel, 2) || !pf::finite(&o.sigma_px, 1)) return PF_ERROR_NONFINITE;
    if (!(o.sigma_px == 0.0 || (o.sigma_px >= 0.01 && o.sigma_px <= 100.0))) return PF_ERROR_RANGE;
    if (!(std::fabs(o.pixel[0]) < 1e5 && std::fabs(o.pixel[1]) < 1e5)) return PF_ERROR_RANGE;
  }
  if (slam->session.needs_images()) return PF_ERROR_STATE;
  pf::PixelObservation* taken = slam->session.inbox();
  const size_t most = static_cast<size_t>(slam->session.inbox_size());
  const size_t n = count < most ? count : most;
  for (size_t i = 0; i < n; ++i) {
    const pf_observation_t& o = observations[i];
    taken[i].external_id = o.id;
    taken[i].pixel = pf::Vec2(static_cast<Scalar>(o.pixel[0]), static_cast<Scalar>(o.pixel[1]));
    taken[i].sigma_px = o.sigma_px > 0.0 ? static_cast<Scalar>(o.sigma_px) : slam->session.settings().sigma_px;
  }
  return in_call.end(slam->session.push_observations(static_cast<int>(n), t_ns));
}
