#include "keyframe_slam/start/keyframe_start.h"

#include <cmath>

#include "frame/frame_entry.h"
#include "frame/start/target_surface.h"
#include "frame/start/tuning.h"
#include "frame/tuning.h"
#include "geometry/lens_deviation.h"
#include "keyframe_slam/map/keyframe_upkeep.h"

namespace pf {

using namespace tuning::filter_start;

namespace {

/// Adds a point at a known place. Returns its row, or -1.
int add_placed(const Vec3& p_W, int host, KeyframeMap* map) {
  const CameraView view = map->keyframes[host].view();
  Vec2 pixel;
  if (!project(map->camera(), view.q_WC.conjugate() * (p_W - view.c_W), &pixel)) return -1;
  const int i = map->add(host, pixel);
  if (i >= 0) map->place(i, p_W);
  return i;
}

}  // namespace

void KeyframeStart::init() {
  known_ = KnownBody();
  has_place_ = false;
  target_.init();
}

void KeyframeStart::start_over() {
  map_.clear();
  map_.tables().planes.clear();  // W is another one
  record_.init();
  known_ = KnownBody();
  has_place_ = false;
  second_ = SecondPose();
  if (map_.tables().target_withdrawn) target_.init();
}

Status KeyframeStart::use_target(const Target& target) {
  if (second_.given || is_in_loaded_map()) return Status::kState;
  const bool has_place = target.kind == TargetKind::kPoints || target.has_place;
  if (!has_place && map_.tables().planes.has_known()) return Status::kState;  // they would be in another W
  if (known_.given && target.kind == TargetKind::kRectangle) return Status::kState;
  target_.set_target(target);
  has_place_ = has_place || known_.given;
  return Status::kOk;
}

Status KeyframeStart::use_pose(const KnownBody& known) {
  if (target_.target().kind == TargetKind::kRectangle || is_in_loaded_map()) return Status::kState;
  known_ = known;
  known_.given = true;
  has_place_ = true;
  return Status::kOk;
}

Status KeyframeStart::use_second_pose(std::int64_t t_ns, const Vec3& p_W, Scalar sigma) {
  if (!is_next_frame(frame_, t_ns)) return Status::kTime;
  if (!((p_W - first_place_W()).norm() > sigma)) return Status::kRange;
  if (target_.target().kind != TargetKind::kNone || second_.given || is_in_loaded_map() ||
      map_.tables().planes.has_known())
    return Status::kState;
  second_ = SecondPose();
  second_.given = true;
  second_.t_ns = t_ns;
  second_.p_W = p_W;
  return Status::kOk;
}

/// The pose is that of any place, with a covariance that leaves it open.
Status KeyframeStart::use_map(const SavedMap& saved) {
  using namespace tuning::body_motion;
  const bool is_chosen =
      known_.given || second_.given || target_.target().kind != TargetKind::kNone || map_.tables().planes.has_known();
  if (is_chosen || is_in_loaded_map()) return Status::kState;
  const Status status = saving_.load(saved, tracking_.map_id());
  if (status != Status::kOk) return status;
  map_.move_lens(lens_of_map(settings_.lens, settings_.camera, saved.lens(), tuning::tracking::kMaxLensDeviation));
  const KeptPlace& place = map_.places[0];
  Mat6 anywhere = Mat6::Identity() * (kAnyRotation * kAnyRotation);
  anywhere.bottomRightCorner<3, 3>() = Mat3::Identity() * (kAnyPosition * kAnyPosition * place.depth * place.depth);
  Body body;
  body.q_WC = place.q_WK;
  body.p_W = place.p_WK;
  motion_.set(body, anywhere, kStartSpeed * place.depth, kStartRate);
  tracking_.set_has_pose(frame_.report.t_ns, true);
  return Status::kOk;
}

Mat6 KeyframeStart::first_covariance() const {
  if (!known_.given) return target_.target().first_covariance;
  const int dim = settings_.body.known_rows();
  Mat6 P;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) P(i, j) = known_.covariance[i * dim + j];
  return P;
}

/// The pose before the first measurement: the one that the caller gave, that of the target, or the one that defines the world.
void KeyframeStart::set_pose(bool at_target) {
  const int dim = settings_.body.known_rows();
  Body body = at_target ? target_.target().first_pose : Body();
  Mat6 P = at_target ? target_.target().first_covariance : Mat6(Mat6::Identity() * (kDefinedSigma * kDefinedSigma));
  Scalar speed = kStartSpeed * (at_target ? Scalar(1) : settings_.start_depth), rate = kStartRate;
  if (known_.given) {
    body = known_.body;
    P = first_covariance();
    const auto sigma = [&](int first) {
      Scalar trace = 0;
      for (int i = first; i < first + 3; ++i) trace += known_.covariance[i * dim + i];
      return std::sqrt(trace / 3);
    };
    if (settings_.constant_velocity || settings_.inertial) {
      speed = sigma(settings_.body.row(BodyPart::kVelocity));
      rate = sigma(settings_.body.row(BodyPart::kVelocity) + 3);
    }
  }
  motion_.set(body, P, speed, rate);
  tracking_.set_has_pose(frame_.report.t_ns);
}

bool KeyframeStart::start_in_image() {
  TargetSighting sighting;
  const bool expected = target_.is_expected();
  const bool seen = expected && target_.find(map_.camera(), images_.tracker(), &sighting);
  if (!seen && expected && !tracking_.may_skip_target()) return false;
  target_.note_begin();
  if (seen && frame_.report.frames > 1) known_ = KnownBody();  // it was the pose of the first frame
  set_pose(seen);
  const int keyframe = add_keyframe(frame_, motion_.view(), settings_.window_keyframes, &map_);
  if (!seen) {
    record_.begin();
    return true;
  }
  add_target(keyframe, sighting);
  held_.hold(motion_.view(), target_.target());
  tracking_.set_from_target();
  settings_.hooks.say("map ", tracking_.map_id(), " starts at the target: ", frame_.report.inliers,
                      " of its points are found");
  return true;
}

/// Adds the target's points, which are inliers of this frame.
void KeyframeStart::add_target(int keyframe, const TargetSighting& sighting) {
  const Target& target = target_.target();
  FrameReport& report = frame_.report;
  map_.tables().target_normal_W = target_normal(target);
  for (int i = 0; i < target.count; ++i) {
    const int row = add_placed(target.point_W[i], keyframe, &map_);
    if (row < 0) continue;
    Feature& f = map_.feature(row);
    f.is_target = true;
    f.external_id = static_cast<std::uint32_t>(i);
    const Vec2 z = sighting.pixel[i];
    images_.remember(&map_.tables(), row, z, motion_.view());
    map_.keyframes.set_pixel(keyframe, row, z);
    map_.point(row).pixel = z;
    ++report.inliers;
    frame_.add({row, f.id, MatchStatus::kInlier, BlockKind::kPoint, false, false, z, Mat2::Zero(), z, Scalar(0)});
  }
  report.new_features = 0;
  report.attempts = report.matches = report.inliers;
}

}  // namespace pf
