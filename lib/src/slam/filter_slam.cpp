#include "slam/filter_slam.h"

#include "base/elapsed.h"

namespace pf {
namespace {

/// How little is known of the velocities at a start that says nothing of them.
constexpr Scalar kStartSpeed = Scalar(0.5);  // [m/s], times the start depth where that sets the scale
constexpr Scalar kStartRate = Scalar(0.5);   // [rad/s]

/// Of a pose that defines the world: small enough to be certain, large enough to keep P invertible.
constexpr Scalar kDefinedSigma = Scalar(1e-5);

}  // namespace

bool FilterSlam::layout(Arena& arena, const Settings& settings) {
  filter_.layout(arena,
                 {settings.max_state_dim, settings.max_features, settings.max_observations, settings.max_planes});
  map_.layout(arena, settings.max_features, settings.max_planes);
  candidate_ = arena.take<PlaneCandidate>(static_cast<std::size_t>(settings.max_features));
  candidate_entry_ = arena.take<int>(static_cast<std::size_t>(settings.max_features));
  quad_workspace_ = take_quad_workspace(&arena, settings.camera.width, settings.camera.height);
  record_.layout(arena);
  bundle_.layout(arena);
  tracker_.layout(arena, settings.camera.width, settings.camera.height, settings.max_features);
  const std::size_t observations = static_cast<std::size_t>(settings.max_observations);
  frame_.layout(arena, settings.max_features + settings.max_observations);
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
  map_.init();
  frame_.init();
  tracking_.init();
  motion_.init();
  random_ = 1;
  tracker_.init(settings.camera);
  target_ = Target();
  known_body_ = KnownBody();
  record_.init();
  start_ = StartProgress();
}

/// A filter without a map.
void FilterSlam::begin_filter() {
  filter_.init(settings_.kernels, settings_.constant_velocity ? Body::kMaxDim : Body::kPoseDim, settings_.keep_gauge);
  filter_.set_roughness(settings_.fold.roughness);
  map_.planes.clear();
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

/// Starts the report and moves the body to the new time. False for a time that does not rise.
bool FilterSlam::begin_frame(std::int64_t t_ns) {
  const std::int64_t before_ns = frame_.report.t_ns;
  if (used() && t_ns <= before_ns) return false;
  const bool unseen = frame_.report.inliers == 0;
  frame_.begin(t_ns);
  tracking_.begin_frame();
  if (!tracking_.has_pose()) {
    motion_.init();  // what was pushed was for this frame
    return true;
  }

  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
  motion_.advance(elapsed_ns(before_ns, t_ns), tracking_.adrift(), unseen);
  if (!filter_.body_is_sound()) start_over();
  return true;
}

/// The estimate is no estimate any more: everything that came from it goes. What the caller said of the first pose is not true
/// here; a target that is still there may be found again.
void FilterSlam::start_over() {
  begin_filter();
  map_.features.clear();
  tracker_.init(settings_.camera);
  record_.init();
  start_ = StartProgress();
  known_body_ = KnownBody();
  if (map_.target_withdrawn) target_ = Target();
  motion_.init();
  tracking_.give_up();
  frame_.forget_all();
  settings_.hooks.say("the estimate is no longer finite: starting again without it");
}

/// What the caller is told, from how many inliers there were.
Status FilterSlam::end_frame() {
  if (tracking_.has_pose() && (tracking_.hopeless() || !filter_.body_is_sound())) start_over();
  return tracking_.conclude(frame_.report, start_, settings_.coast_ns, settings_.hooks);
}

void FilterSlam::begin_at(const Body& body, const Scalar* covariance) {
  filter_.set_body(body, covariance);
  tracking_.begin_pose(frame_.report.t_ns);
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

}  // namespace pf
