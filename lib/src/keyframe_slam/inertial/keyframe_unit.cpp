#include "keyframe_slam/inertial/keyframe_unit.h"

#include <cmath>
#include <new>

#include "base/elapsed.h"
#include "frame/start/tuning.h"
#include "geometry/small_cholesky.h"
#include "inertial/tuning.h"
#include "model/camera_at.h"

namespace pf {
namespace {

constexpr double kPatience = 5;  ///< [s] of a map, after which waiting for a better scale costs more than it brings
constexpr Scalar kKnownLength = Scalar(1e-3);       ///< share to which a length of the map is its own unit
constexpr FilterCapacity kCapacity = {0, 1, 8, 0};  ///< but for the rows of the state

/// Where the map's unit is the metre.
void begin_in_metres(const RestReading& rest, const Settings& settings, const Mounting& known, Filter* filter) {
  Transition transition;
  begin_at_rest(filter->state().body, settings.body, known, rest, &transition);
  filter->predict(transition);
  filter->set_mounting(known);
  filter->set_metric();
}

}  // namespace

void KeyframeUnit::layout(Arena& arena) {
  if (!settings_.inertial) return;
  Parts* const place = arena.take<Parts>(1);
  const auto lay_out = [&](Parts& parts) {
    FilterCapacity capacity = kCapacity;
    capacity.state_dim = settings_.body.rows() + 6;
    parts.filter.layout(arena, capacity);
    parts.mounting.layout(arena);
    parts.watch.layout(arena);
    parts.rest.layout(arena);
  };
  if (place == nullptr) {
    Parts counted(settings_, frame_, imu_);
    return lay_out(counted);
  }
  parts_ = new (place) Parts(settings_, frame_, imu_);
  lay_out(*parts_);
}

void KeyframeUnit::init() {
  data_ = Data();
  if (parts_ == nullptr) return;
  parts_->filter.init(settings_.kernels, settings_.body, false);
  parts_->filter.set_lens(settings_.camera, LensPrior());
  parts_->mounting.init();
  parts_->motion.init();
  parts_->motion.unit_noise().init();
  parts_->watch.init();
  parts_->forces.init();
  begin_map();
}

void KeyframeUnit::begin_map() {
  if (parts_ == nullptr) return;
  if (data_.has_begun) parts_->mounting.keep();
  data_ = Data();
  parts_->rest.init();
  parts_->hold.init();
  parts_->moving.init();
}

/// With the body where the map has it, in the map's coordinates. Views that were kept before the depths are those of a start from a rest:
/// without one their rotations, by a map that was just begun, would give the gyroscope's bias too certainly.
bool KeyframeUnit::begin(const MapOfUnit& map) {
  using namespace tuning::inertial;
  using tuning::filter_start::kStartRate;
  Filter& filter = parts_->filter;
  const Mounting& initial = parts_->mounting.initial();
  const BodyLayout& layout = settings_.body;
  filter.init(settings_.kernels, layout, false);
  filter.set_lens(map_.camera(), LensPrior());
  filter.set_mounting({initial.R_CB, Vec3::Zero(), initial.delay, false, initial.intrinsics});
  filter.tell_gauge();
  const int dim = layout.unit_rows();
  Scalar P[BodyLayout::kMaxUnitRows * BodyLayout::kMaxUnitRows] = {};
  const KeyframeMotion::Covariance& known = motion_.covariance();
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) P[i * dim + j] = known(i, j);
  const auto set_sigma = [&](BodyPart part, int rows, Scalar sigma) {
    for (int i = layout.row(part); i < layout.row(part) + rows; ++i) P[i * dim + i] = sigma * sigma;
  };
  Body body = motion_.body();
  const RestReading* const rest = parts_->moving.rest();
  if (rest == nullptr) parts_->moving.init();
  if (rest != nullptr && filter.uses_samples()) body.gyro_bias = rest->gyro;
  const Scalar of_gyro = rest != nullptr ? rest->sigma_gyro : kGyroBias;
  set_sigma(BodyPart::kGyroBias, 3, filter.uses_samples() ? of_gyro : kStartRate);
  set_sigma(BodyPart::kAccelBias, 3, kAccelBias);
  set_sigma(BodyPart::kGravity, 2, kGravity);
  if (layout.estimates_unit()) parts_->mounting.put_covariance(P);
  parts_->motion.begin(frame_.report.t_ns, &body);
  filter.set_body(body, P);
  if (!parts_->ruler.begin(body.p_W, map.median_depth, kKnownLength)) return false;
  data_.begin_ns = frame_.report.t_ns;
  data_.left = motion_.view();
  data_.has_begun = true;
  return true;
}

bool KeyframeUnit::predict(std::int64_t before_ns, bool follows, bool coasting_or_lost, bool nothing_measured,
                           Scalar median_depth) {
  if (parts_ != nullptr && !data_.has_begun) parts_->motion.unit_noise().note_samples();
  if (!has_begun()) return false;
  const std::int64_t t_ns = frame_.report.t_ns;
  data_.follows = follows;
  data_.is_again = false;
  data_.has_other = follows;
  parts_->ruler.move_about(data_.left, motion_.view());
  parts_->watch.begin_frame(before_ns, t_ns);
  if (parts_->watch.take_alignment()) {
    parts_->mounting.keep();
    parts_->moving.integrate_again();
  }
  if (!parts_->hold.predict(follows, before_ns, t_ns, median_depth * parts_->ruler.scale()))
    advance(before_ns, coasting_or_lost, nothing_measured);
  put_prediction();
  return true;
}

void KeyframeUnit::advance(std::int64_t before_ns, bool coasting_or_lost, bool nothing_measured) {
  const std::int64_t begin_ns = parts_->hold.motion_begin_ns(before_ns);
  parts_->watch.keep_prior(begin_ns);
  parts_->motion.advance(begin_ns, frame_.report.t_ns, coasting_or_lost, nothing_measured);
  parts_->hold.note_motion();
}

void KeyframeUnit::put_prediction() {
  MapRuler::MotionRows rows;
  const Filter& filter = parts_->filter;
  parts_->ruler.set_rows(filter.state().mounting.rate_by_reading(), &rows);
  KeyframeMotion::Covariance P = filter.covariance_of<12>(rows);
  const Scalar of_gyro = noise().gyro_density;  // of one sample
  P.bottomRightCorner<3, 3>().diagonal().array() += of_gyro * of_gyro * static_cast<Scalar>(imu_.rate_hz());
  motion_.set_prediction(parts_->ruler.body(), P, data_.has_other ? tuning::unit_watch::kMaxPoseNis : Scalar(0));
  data_.left = motion_.view();
}

/// Corrects the filter by the pose that the frame has measured. False, with nothing changed, where its NIS is above the bound, if there is
/// one.
bool KeyframeUnit::update(Scalar max_nis) {
  const KeyframeMotion::MeasuredPose& measured = motion_.measured();
  MapRuler::PoseMeasurement z;
  parts_->ruler.set_measurement(measured.q_WC, measured.p_W, noise_.correlation_frames() * measured.R, &z);
  Filter& filter = parts_->filter;
  const Measurement view = z.view();
  Scalar nis = 0;
  filter.begin_update(&view, 1);
  const Mat6 S = filter.covariance_of<6>(z.H) + z.R_update;
  const bool solved = filter.solve_update(&view, 1, nullptr, &nis);
  if (max_nis > Scalar(0) && !(solved && nis <= max_nis)) return false;
  if (!solved) return true;
  SmallCholesky<3> of_rotation;
  const Vec3 e = (z.measured - z.predicted).head<3>();
  PoseNis& pose = frame_.report.pose;
  if (of_rotation.factor(Mat3(S.topLeftCorner<3, 3>()))) {
    pose.nis += static_cast<double>(nis);
    pose.of_rotation += static_cast<double>(e.dot(of_rotation.solve<1>(e)));
    pose.dof += 6;
  }
  filter.commit_update();
  return true;
}

bool KeyframeUnit::take_pose(const MapOfUnit& map) {
  if (parts_ == nullptr) return false;
  if (!data_.has_begun) {
    if (map.is_tracked && !map.is_pending) begin(map);
    return false;
  }
  const bool has_pose = map.is_tracked && motion_.measured().is_set;
  if (data_.is_again) {
    if (has_pose) update(0);
    parts_->watch.settle(map.is_tracked);
    const bool again = !map.is_tracked && data_.has_other;
    data_.has_other = false;
    if (!map.is_tracked) put_prediction();
    data_.left = motion_.view();
    return again;
  }
  const Scalar of_samples = parts_->watch.begin_measuring(data_.follows);
  bool fits = !has_pose || update(data_.follows ? of_samples : tuning::unit_watch::kMaxPoseNis);
  if (!fits && !data_.follows) {  // found again somewhere else: the map is, and how the body moves says nothing of it
    const Body predicted = parts_->ruler.body();
    parts_->ruler.move_about({predicted.q_WC, predicted.p_W}, motion_.view());
    fits = true;
  }
  const bool is_open = data_.has_other && frame_.report.inliers == 0;
  if (!parts_->watch.is_refused(!fits) && !is_open) {
    data_.left = motion_.view();
    return false;
  }
  if (parts_->hold.holds()) {
    parts_->hold.take_back();
    advance(parts_->hold.before_ns(), false, false);
  } else {
    parts_->watch.leave_prediction();
  }
  if (!has_pose) {
    put_prediction();
    data_.is_again = true;
    return true;
  }
  update(0);
  parts_->watch.settle(true);
  data_.left = motion_.view();
  return false;
}

MovingPoints KeyframeUnit::moving_points() const {
  const auto find = [](const void* owner, std::uint32_t id, Vec3* p_W) {
    const KeyframeMap& map = static_cast<const KeyframeUnit*>(owner)->map_;
    const int i = map.tables().features.entry_of(id);
    if (i < 0 || !map.point(i).has_depth) return false;
    const KeyframePoint& point = map.point(i);
    if (!(std::sqrt(point.variance) < tuning::moving_verdict::kMaxDepthSigma * point.rho)) return false;
    *p_W = map.position(i);
    return true;
  };
  // At the frame's time, since the match was accepted.
  const auto pixel_of = [](const void* owner, const Match& match) {
    return static_cast<const KeyframeUnit*>(owner)->map_.point(match.feature).pixel;
  };
  return {this, map_.camera(), find, pixel_of};
}

/// Frames are kept while the delay or the depths are open, and judged once they are not.
bool KeyframeUnit::look_for_scale(const MapOfUnit& map, MovingSolution* solution) {
  if (parts_ == nullptr) return false;
  Filter& filter = parts_->filter;
  const bool open = parts_->watch.is_open() && !is_rejected(parts_->watch.mode());
  const bool has_axes = !open || !(settings_.unit.sigma_turn > tuning::rate_alignment::kOpenTurn);
  const CameraView view = motion_.view();
  parts_->forces.note(view.q_WC.toRotationMatrix() * filter.state().mounting.R_CB, has_axes && map.is_tracked);
  Scalar value;
  const bool reads_force = parts_->forces.reason(&value) == UnitReason::kNone;
  const bool is_used = filter.uses_samples() || open;
  RestReading rest;
  if (is_used && parts_->rest.note(map.is_tracked, &rest) && reads_force && !filter.is_metric()) {
    if (!map.knows_scale) {
      parts_->moving.begin_at_rest(rest, parts_->rest.begin_ns());
    } else if (data_.has_begun && filter.uses_samples()) {
      begin_in_metres(rest, settings_, parts_->mounting.now(), &filter);
      return true;
    }
  }
  if (data_.has_begun && filter.uses_samples()) parts_->hold.end_frame(frame_.report.t_ns);
  MovingFrame told;
  told.view = view;
  told.is_placed = data_.has_begun;
  told.keep = map.is_tracked && !filter.is_metric() && !map.knows_scale && is_used && reads_force;
  told.judge = data_.has_begun && !map.is_pending && filter.uses_samples();
  told.patient = seconds(elapsed_ns(data_.begin_ns, frame_.report.t_ns)) < kPatience;
  told.map_id = map.map_id;
  told.depth = map.median_depth;
  told.correlation = noise_.correlation_frames();
  if (!parts_->moving.note(told, moving_points(), solution)) return false;
  filter.set_metric(*solution, parts_->mounting.now());
  data_.is_from_motion = true;
  return true;
}

const char* KeyframeUnit::leaves_metres(const MapOfUnit& map, std::int64_t dt_ns) {
  using tuning::moving_verdict::kLateSigmaScale;
  if (!has_begun()) return nullptr;
  const bool rejected = parts_->watch.note(data_.follows && !parts_->hold.holds(), map.is_tracked, dt_ns);
  if (rejected && parts_->watch.is_map_on_trial() && !map.knows_scale) {
    parts_->watch.take(UnitEvent::kNewMap);
    begin_map();
    return "they came from an inertial unit that is rejected";
  }
  const bool gave_metres = is_from_motion();
  const BlockFilter::Repair repair = parts_->filter.repair(frame_.report.frames);
  if (repair == BlockFilter::Repair::kDone) count_frame(&frame_.report.repairs);
  if (repair == BlockFilter::Repair::kImpossible || !parts_->filter.body_is_sound()) {
    begin_map();
    return gave_metres ? "the estimate of the inertial unit is not finite, or its covariance is invalid" : nullptr;
  }
  if (!gave_metres || !(parts_->ruler.scale_variance() > kLateSigmaScale * kLateSigmaScale)) return nullptr;
  begin_map();
  return "the map has lost what held its size";
}

/// While innovations add up that the samples' noise does not explain, the map stays where it is.
Similarity KeyframeUnit::follow_adjustment(const KeyframeAdjustment& adjustment) {
  if (!is_metric()) return Similarity();
  const Keyframe& newest = map_.keyframes[map_.keyframes.newest()];
  if (newest.number == data_.newest) return Similarity();
  data_.newest = newest.number;
  parts_->ruler.move_about(data_.left, motion_.view());
  data_.left = motion_.view();
  const MapDrift drift = adjustment.drift();
  if (drift.any) parts_->ruler.drift(drift.Q, newest.p_W, drift.sigma_scale);
  const bool is_sound = is_from_motion() && !(parts_->watch.sum() > Scalar(0));
  return is_sound ? parts_->ruler.to_filter() : Similarity();
}

/// Where something else gives the map's unit, the filter's lengths are the map's. A map that has none yet, and is scaled, is another one to
/// the filter.
void KeyframeUnit::move(const Similarity& T) {
  if (!has_begun()) return;
  if (!is_metric() && std::abs(T.s - 1) > kKnownLength) return begin_map();
  const auto moved = [&](const CameraView& view) { return CameraView{(T.q * view.q_WC).normalized(), T.of(view.c_W)}; };
  parts_->ruler.move(T, is_from_motion());
  data_.left = moved(data_.left);
}

Mat3 KeyframeUnit::covariance_of_scale(const Vec3& p_W, const Vec3& first_W) const {
  if (!is_from_motion()) return Mat3::Zero();
  const Vec3 lever = p_W - first_W;
  return parts_->ruler.scale_variance() * lever * lever.transpose();
}

bool KeyframeUnit::predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const {
  if (!has_begun() || t_ns <= now_ns || !parts_->filter.uses_samples()) return false;
  parts_->motion.predict_pose(parts_->hold.motion_begin_ns(now_ns), t_ns, body, covariance);
  const Similarity T = parts_->ruler.to_filter();
  if (parts_->filter.is_metric()) body->v_W = camera_velocity(*body, parts_->filter.state().mounting);
  body->p_W = (body->p_W - T.t) / T.s;
  body->v_W /= T.s;
  Similarity back;
  back.s = 1 / T.s;
  *covariance = back.of_pose_covariance(*covariance);
  return true;
}

UnitReason KeyframeUnit::reason(Scalar* value, Mat3* R_CB) const {
  return reason_of(parts_->watch, parts_->forces, parts_->moving, {is_metric(), has_begun()}, value, R_CB);
}

}  // namespace pf
