#include "filter_slam/start/map_beginning.h"

#include "base/limits.h"
#include "base/table_entries.h"
#include "filter_slam/start/tuning.h"
#include "frame/start/tuning.h"
#include "frame/tuning.h"
#include "geometry/planar_pose.h"
#include "inertial/tuning.h"
#include "model/camera_at.h"
#include "model/reference_camera.h"

namespace pf {

using namespace tuning::filter_start;

void MapBeginning::use(const KnownBody& known) {
  data_.known = known;
  data_.known.given = true;
}

bool MapBeginning::has_known_speed() const {
  if (!data_.known.given || !settings_.body.has(BodyPart::kVelocity)) return false;
  const int dim = settings_.body.known_rows(), first = settings_.body.row(BodyPart::kVelocity);
  Scalar variance = 0;
  for (int i = first; i < first + 3; ++i) variance += data_.known.covariance[i * dim + i];
  return !(data_.known.body.v_W.squaredNorm() < kKnownSpeed * kKnownSpeed * variance);
}

void MapBeginning::clear_filter() {
  empty_filter();
  map_.planes.clear();
}

/// Anchors stay where they are before the camera of this frame, which holds them once the filter knows it again:
///
///   T_KV <- T_WCᵀ T_WK T_KV,   covariance of A_V e_K - A_C e_C        A_V, A_C: by what K and C hold (held_pose)
void MapBeginning::leave_anchors() {
  using model::ReferenceCamera;
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  const RelativePlace T_WC = {camera.q_WC, camera.p_W};
  for (const int i : used_entries(map_.anchors)) {
    Anchor& anchor = map_.anchors[i];
    if (anchor.camera < 0) continue;
    const Block& block = filter_.state().block[anchor.camera];
    const HeldPose view = held_pose({ReferenceCamera::q_WC(block), ReferenceCamera::p_WC(block)}, anchor.T_KV);
    const RelativePlace T_WV = {view.q_WA, view.p_WA}, T_CV = T_WC.inverse().of(T_WV);
    RowsOf<6, 12, 2> J;
    J.parts = 2;
    J.part[0] = camera.part();
    J.part[1] = Part::of(anchor.camera, 0, 6);
    put<6, 6>(J.h, 12, 0, Mat6(-held_pose(T_WC, T_CV).J_V));
    put<6, 6>(J.h, 12, 6, view.J_V);
    anchor.between += filter_.rounded_covariance_of<6>(J);
    anchor.T_KV = T_CV;
    anchor.camera = Anchor::kAwaitsCamera;
  }
}

void MapBeginning::empty_filter() {
  leave_anchors();
  filter_.init(settings_.kernels, settings_.body, settings_.research.keep_gauge);
  filter_.set_lens(settings_.camera, settings_.lens);
  // Where the scale is not known, neither is the unit's place in it.
  filter_.set_mounting(
      {mounting_.initial().R_CB, Vec3::Zero(), mounting_.initial().delay, false, mounting_.initial().intrinsics});
  filter_.set_roughness(settings_.fold.roughness);
  map_.mark = Mark();
}

void MapBeginning::clear_all_but_walls() {
  PlaneTable& planes = map_.planes;
  const State& state = filter_.state();
  int frame[kMaxPlanes];
  for (int k = 0; k < planes.capacity(); ++k)
    frame[k] = planes.used(k) && planes[k].known ? state.block[planes[k].slot].frame : -1;
  empty_filter();
  planes.keep_known();
  // The filter keeps the frames of its planes where they are until others take their place, and the first free place is taken first.
  for (int f = 0; f < state.max_planes; ++f)
    for (int k = 0; k < planes.capacity(); ++k) {
      if (frame[k] != f) continue;
      const PlaneFrame plan = state.plane_frame[f];
      planes[k].slot =
          filter_.add_known_plane(plan, planes[k].prior_covariance(), planes[k].roughness, planes[k].apart);
      filter_.set_owner(planes[k].slot, k);
    }
}

void MapBeginning::begin(const Target* target, bool fitted) {
  data_.begin_ns = frame_.report.t_ns;
  if (data_.known.given) {
    set_body(data_.known.body, data_.known.covariance);
    return;
  }
  const int dim = settings_.body.known_rows();
  for (Scalar& c : data_.covariance) c = Scalar(0);
  for (int i = 0; i < Body::kPoseDim; ++i)
    for (int j = 0; j < Body::kPoseDim; ++j)
      data_.covariance[i * dim + j] =
          target != nullptr ? target->first_covariance(i, j) : (i == j ? kDefinedSigma * kDefinedSigma : Scalar(0));
  set_initial_velocities(kStartSpeed * (target != nullptr ? Scalar(1) : settings_.start_depth));
  begin_at(target != nullptr ? target->first_pose : Body(), fitted ? target : nullptr);
}

void MapBeginning::begin_at(const Body& body, const Target* fitted_to) {
  Scalar J_lens[BodyLayout::kMaxUnitRows * kLensParameters] = {};  // of the pose; velocities do not depend on the lens
  const LensRows& rows = filter_.state().lens_rows;
  PoseEstimate pose;
  pose.q_WC = body.q_WC;
  pose.p_WC = body.p_W;
  const bool by_lens = fitted_to != nullptr && rows.count > 0 &&
                       pose_by_lens(settings_.camera, fitted_to->point_W, fitted_to->count, pose, rows, J_lens);
  set_body(body, data_.covariance, by_lens ? J_lens : nullptr);
}

void MapBeginning::begin_anywhere(const Quat& q_WC, const Vec3& p_W, Scalar depth) {
  using namespace tuning::body_motion;
  const int dim = settings_.body.known_rows();
  for (Scalar& c : data_.covariance) c = Scalar(0);
  for (int i = 0; i < 3; ++i) {
    data_.covariance[i * dim + i] = kAnyRotation * kAnyRotation;
    data_.covariance[(3 + i) * dim + 3 + i] = kAnyPosition * kAnyPosition * depth * depth;
  }
  set_initial_velocities(kStartSpeed * depth);
  Body body;
  body.q_WC = q_WC;
  body.p_W = p_W;
  filter_.tell_gauge();  // W is that of a map
  begin_at(body, nullptr);
}

void MapBeginning::note_covariance() {
  const int dim = settings_.body.known_rows();
  Scalar P[Body::kPoseDim * Body::kPoseDim];
  filter_.body_covariance(Body::kPoseDim, P);
  for (Scalar& c : data_.covariance) c = Scalar(0);
  for (int i = 0; i < Body::kPoseDim; ++i)
    for (int j = 0; j < Body::kPoseDim; ++j) data_.covariance[i * dim + j] = P[i * Body::kPoseDim + j];
  set_initial_velocities(kStartSpeed * settings_.start_depth);
}

/// known: covariance over the known rows of the layout. Of an inertial unit, or of accelerations, nothing is known yet.
void MapBeginning::set_body(const Body& body, const Scalar* known, const Scalar* J_lens) {
  using namespace tuning::inertial;
  Scalar all[BodyLayout::kMaxUnitRows * BodyLayout::kMaxUnitRows];
  if (settings_.inertial) {
    const BodyLayout& layout = settings_.body;
    const int dim = layout.unit_rows(), stride = layout.known_rows(), moving = layout.row(BodyPart::kGyroBias);
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) all[i * dim + j] = i < moving && j < moving ? known[i * stride + j] : Scalar(0);
    const auto set_sigma = [&](BodyPart part, int rows, Scalar sigma) {
      for (int i = layout.row(part); i < layout.row(part) + rows; ++i) all[i * dim + i] = sigma * sigma;
    };
    set_sigma(BodyPart::kGyroBias, 3, filter_.uses_samples() ? kGyroBias : kStartRate);
    set_sigma(BodyPart::kAccelBias, 3, kAccelBias);
    set_sigma(BodyPart::kGravity, 2, kGravity);
    mounting_.put_covariance(all);
    known = all;
  } else if (settings_.body.has(BodyPart::kAcceleration)) {
    const Scalar kVariance = tuning::body_motion::kAcceleration * tuning::body_motion::kAcceleration;
    const int dim = settings_.body.dynamic_rows(), stride = settings_.body.known_rows();
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        all[i * dim + j] = i < stride && j < stride ? known[i * stride + j] : i == j ? kVariance : Scalar(0);
    known = all;
  }
  Body now = body;
  motion_.begin(frame_.report.t_ns, &now);
  filter_.set_body(now, known, J_lens);
  tracking_.set_has_pose(frame_.report.t_ns);
}

/// Sets the variances of velocities that nothing is known of.
void MapBeginning::set_initial_velocities(Scalar speed) {
  const BodyLayout& layout = settings_.body;
  const int dim = layout.known_rows();
  const auto set_sigma = [&](BodyPart part, Scalar sigma) {
    if (!layout.has(part)) return;
    for (int i = layout.row(part); i < layout.row(part) + 3; ++i) data_.covariance[i * dim + i] = sigma * sigma;
  };
  set_sigma(BodyPart::kVelocity, speed);
  set_sigma(BodyPart::kAngularVelocity, kStartRate);
}

}  // namespace pf
