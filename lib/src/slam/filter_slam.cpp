#include "slam/filter_slam.h"

#include <cmath>

#include "base/elapsed.h"

namespace pf {
namespace {

/// How little is known of the velocities at a start that says nothing of them.
constexpr Scalar kStartSpeed = Scalar(0.5);  // [m/s], times the start depth where that sets the scale
constexpr Scalar kStartRate = Scalar(0.5);   // [rad/s]

constexpr Scalar kHandSeconds = Scalar(0.25);  ///< in which a speed decays while nothing is measured
constexpr Scalar kMostTurn = Scalar(0.5);      ///< [rad] standard deviation at which it grows no more

/// Of a pose that defines the world: small enough to be certain, large enough to keep P invertible.
constexpr Scalar kDefinedSigma = Scalar(1e-5);

constexpr int kHopelessUpdates = 10;  ///< that could not be made, in a row: P is no covariance any more

}  // namespace

bool FilterSlam::layout(Arena& arena, const Settings& settings) {
  filter_.layout(arena,
                 {settings.max_state_dim, settings.max_features, settings.max_observations, settings.max_planes});
  features_.layout(arena, settings.max_features);
  planes_.layout(arena, settings.max_planes);
  candidate_ = arena.take<PlaneCandidate>(static_cast<std::size_t>(settings.max_features));
  candidate_entry_ = arena.take<int>(static_cast<std::size_t>(settings.max_features));
  quad_workspace_ = take_quad_workspace(&arena, settings.camera.width, settings.camera.height);
  record_.layout(arena);
  bundle_.layout(arena);
  tracker_.layout(arena, settings.camera.width, settings.camera.height, settings.max_features);
  const std::size_t observations = static_cast<std::size_t>(settings.max_observations);
  tracks_ = arena.take<Track>(static_cast<std::size_t>(settings.max_features + settings.max_observations));
  observation_ = arena.take<Observation>(observations);
  entry_ = arena.take<int>(observations);
  keep_ = arena.take<unsigned char>(observations);
  track_of_ = arena.take<int>(observations);
  scratch_ = arena.take<int>(static_cast<std::size_t>(settings.max_features));
  inbox_ = arena.take<PixelObservation>(static_cast<std::size_t>(settings.max_features + settings.max_observations));
  return arena.ok();
}

void FilterSlam::init(const Settings& settings) {
  settings_ = settings;
  begin_filter();
  features_.init();
  planes_.init();
  random_ = 1;
  tracker_.init(settings.camera);
  target_ = Target();
  known_body_ = KnownBody();
  target_withdrawn_ = false;
  record_.init();
  recording_ = false;
  depth_known_ = false;
  state_ = SlamState::kStarting;
  has_pose_ = false;
  sighted_ = false;
  lost_ = false;
  gave_up_ = false;
  failed_updates_ = 0;
  last_tracked_ns_ = 0;
  steering_v_C_.setZero();
  steering_w_C_.setZero();
  report_ = FrameReport();
  track_count_ = 0;
}

/// A filter without a map.
void FilterSlam::begin_filter() {
  filter_.init(settings_.kernels, settings_.constant_velocity ? Body::kMaxDim : Body::kPoseDim, settings_.keep_gauge);
  filter_.set_roughness(settings_.fold.roughness);
  planes_.clear();
}

bool FilterSlam::fits(const Target& target) const {
  return target.count <= settings_.max_features &&
         3 * target.count <= settings_.max_state_dim - filter_.state().body_dim;
}

Status FilterSlam::start_from_target(const Target& target) {
  if (used() || (known_body_.given && target.kind == TargetKind::kRectangle)) return Status::kState;
  if (!fits(target)) return Status::kRange;
  target_ = target;
  return Status::kOk;
}

Status FilterSlam::start_from_pose(const KnownBody& known) {
  if (used() || target_.kind == TargetKind::kRectangle) return Status::kState;
  known_body_ = known;
  known_body_.given = true;
  return Status::kOk;
}

void FilterSlam::push_steering(const Vec3& dv_C, const Vec3& dw_C) {
  steering_v_C_ += dv_C;
  steering_w_C_ += dw_C;
}

/// Starts the report and moves the body to the new time. False for a time that does not rise.
bool FilterSlam::begin_frame(std::int64_t t_ns) {
  if (used() && t_ns <= report_.t_ns) return false;
  const std::int64_t before = report_.t_ns;
  const int frames = report_.frames;
  const bool unseen = report_.inliers == 0;
  report_ = FrameReport();
  report_.t_ns = t_ns;
  report_.frames = frames;
  count_frame(&report_.frames);
  sighted_ = false;
  gave_up_ = false;
  track_count_ = 0;
  const Vec3 dv_C = steering_v_C_, dw_C = steering_w_C_;
  steering_v_C_.setZero();
  steering_w_C_.setZero();
  if (!has_pose_) return true;

  StageTimer timer(settings_.hooks, &report_.stage_ns[kPredict]);
  // A gap that is longer than any motion stays predictable grows the covariance no further.
  const std::int64_t gap = elapsed_ns(before, t_ns);
  const Scalar dt = static_cast<Scalar>(static_cast<double>(gap < kLongestGap ? gap : kLongestGap) * 1e-9);
  MotionNoise noise = settings_.motion_noise;
  if (state_ == SlamState::kCoasting || state_ == SlamState::kLost) {
    // A hand does not keep its speed for long, and what is known of the turn to half a radian is enough to search everywhere:
    // without this, one second without a picture would carry the camera out of the room.
    if (settings_.constant_velocity && unseen) damp(dt);
    if (filter_.variance(Body::kTheta) > kMostTurn * kMostTurn) noise.linear = noise.angular = Scalar(0);
  }
  Transition transition;
  if (settings_.constant_velocity) {
    filter_.steer(dv_C, dw_C);
    predict_constant_velocity(filter_.body(), dt, noise, &transition);
  } else {
    predict_constant_position(filter_.body(), dt, noise, &transition);
  }
  filter_.predict(transition);
  if (!filter_.body_is_sound()) start_over();
  return true;
}

/// A hand's speed decays while nothing is measured.
void FilterSlam::damp(Scalar dt) {
  Mat6 P_speed;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) P_speed(i, j) = filter_.covariance()(Body::kVelocity + i, Body::kVelocity + j);
  Transition transition;
  damp_speed(filter_.body(), std::exp(-dt / kHandSeconds), P_speed, &transition);
  filter_.predict(transition);
}

/// The estimate is no estimate any more: everything that came from it goes. What the caller said of the first pose is not true
/// here; a target that is still there may be found again.
void FilterSlam::start_over() {
  begin_filter();
  features_.clear();
  tracker_.init(settings_.camera);
  record_.init();
  recording_ = depth_known_ = has_pose_ = sighted_ = lost_ = false;
  failed_updates_ = 0;
  known_body_ = KnownBody();
  if (target_withdrawn_) target_ = Target();
  steering_v_C_.setZero();
  steering_w_C_.setZero();
  state_ = SlamState::kStarting;
  for (int t = 0; t < track_count_; ++t) tracks_[t].feature = -1;
  gave_up_ = true;
  settings_.hooks.say("the estimate is no longer finite: starting again without it");
}

/// What the caller is told, from how many inliers there were.
Status FilterSlam::end_frame() {
  if (has_pose_ && (failed_updates_ >= kHopelessUpdates || !filter_.body_is_sound())) start_over();
  if (!has_pose_) return Status::kStarting;
  if (report_.inliers >= kMinInliers || sighted_) {
    if (lost_) settings_.hooks.say("found the map again");
    lost_ = false;
    last_tracked_ns_ = report_.t_ns;
    const bool starting = recording_ && !depth_known_;
    state_ = starting ? SlamState::kStarting : SlamState::kTracking;
    return starting ? Status::kStarting : Status::kOk;
  }
  if (recording_ && last_tracked_ns_ == report_.t_ns) return Status::kStarting;  // has just begun
  if (!lost_ && elapsed_ns(last_tracked_ns_, report_.t_ns) > settings_.coast_ns) {
    lost_ = true;
    settings_.hooks.say("lost: too few features were found for too long");
  }
  state_ = lost_ ? SlamState::kLost : SlamState::kCoasting;
  return lost_ ? Status::kLost : Status::kCoasting;
}

void FilterSlam::begin_at(const Body& body, const Scalar* covariance) {
  filter_.set_body(body, covariance);
  has_pose_ = true;
  last_tracked_ns_ = report_.t_ns;
}

/// The pose before the first measurement: what was said to be known, or the world's own definition.
void FilterSlam::begin_from_knowledge() {
  if (known_body_.given) {
    begin_at(known_body_.body, known_body_.covariance);
    return;
  }
  const int dim = filter_.state().body_dim;
  Scalar* covariance = start_covariance_;
  for (Scalar& c : start_covariance_) c = Scalar(0);
  const bool has_target = target_.kind != TargetKind::kNone;
  for (int i = 0; i < Body::kPoseDim; ++i)
    for (int j = 0; j < Body::kPoseDim; ++j)
      covariance[i * dim + j] =
          has_target ? target_.first_covariance(i, j) : (i == j ? kDefinedSigma * kDefinedSigma : Scalar(0));
  for (int i = Body::kPoseDim; i < dim; ++i) {
    const Scalar sigma = i < Body::kRate ? kStartSpeed * (has_target ? Scalar(1) : settings_.start_depth) : kStartRate;
    covariance[i * dim + i] = sigma * sigma;
  }
  begin_at(has_target ? target_.first_pose : Body(), covariance);
}

void FilterSlam::predict_pose(std::int64_t t_ns, Body* body, Mat6* covariance) const {
  *body = filter_.state().body;
  const int dim = filter_.state().body_dim;
  Scalar P[Body::kMaxDim * Body::kMaxDim];
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) P[i * dim + j] = filter_.covariance()(i, j);
  if (t_ns > report_.t_ns) {
    const Scalar dt = static_cast<Scalar>(static_cast<double>(elapsed_ns(report_.t_ns, t_ns)) * 1e-9);
    Transition transition;
    if (settings_.constant_velocity)
      predict_constant_velocity(*body, dt, settings_.motion_noise, &transition);
    else
      predict_constant_position(*body, dt, settings_.motion_noise, &transition);
    Scalar FP[Body::kMaxDim * Body::kMaxDim];
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) {
        Scalar sum = 0;
        for (int k = 0; k < dim; ++k) sum += transition.F[i * dim + k] * P[k * dim + j];
        FP[i * dim + j] = sum;
      }
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) {
        Scalar sum = transition.Q[i * dim + j];
        for (int k = 0; k < dim; ++k) sum += FP[i * dim + k] * transition.F[j * dim + k];
        P[i * dim + j] = sum;
      }
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) (*covariance)(i, j) = P[i * dim + j];
}

}  // namespace pf
