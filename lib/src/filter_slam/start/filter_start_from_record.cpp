#include <algorithm>

#include "base/elapsed.h"
#include "filter/baseline.h"
#include "filter_slam/start/filter_start.h"
#include "frame/start/tuning.h"
#include "frame/tuning.h"
#include "geometry/so3.h"

/// FilterStart: what the record of a start tells the filter, and how the filter begins again from it.

namespace pf {

using namespace tuning::filter_start;

/// Restarts the filter at the record's frame 0 with the bundle's depths as wide priors, and repeats the recorded frames with every
/// linearisation at the bundle's poses and with residuals of zero. That moves no mean, and leaves the covariance that the recorded
/// pixels support. At a target its points are left out of that, since the record's unit of length is only as good as the bundle's depths of
/// them; their pixels in the last frame correct the mean. unit: W's lengths per length of the record.
void FilterStart::restart_from_record(Scalar unit) {
  Body body;
  body.q_WC = without_.base_q_WC();
  body.p_W = without_.base_p_W();
  clear_all_but_walls();
  if (without_.bundle().lens() != nullptr) parts_.filter.set_lens(*without_.bundle().lens(), settings_.lens);
  begin_body(body, progress().checking && !data_.known.given);
  // Residuals of zero say nothing about the lens: the bundle's solution holds for the one that the filter begins with.
  parts_.filter.consider_lens(true);
  restart_features(
      [&](int index) { return without_.bundle().good(index) ? without_.bundle().rho(index) / unit : Scalar(0); },
      kWideDepth);
  std::int64_t before_ns = without_.begin_ns();
  for (int k = 0; k < without_.record().frames(); ++k) {
    restart_frame(k, before_ns, unit);
    before_ns = without_.record().frame(k).t_ns;
  }
  parts_.filter.consider_lens(false);
  if (settings_.body.has(BodyPart::kVelocity)) restart_velocities(unit);
  if (has_walls_apart()) open_scale();
  if (progress().checking) restart_at_target();
}

/// As long as depths are open, no pixel's linearisation tells the baseline (Filter::parallax_noise), and it would grow with the unknown
/// speed, and with it search ellipses and what passes for a rotation. That a rotation explains all pixels does tell it.
void FilterStart::bound_baseline() {
  Mat3 covariance;
  if (!without_.baseline_covariance(settings_.camera, tuning::noise::kSearchSigma, settings_.start_depth, &covariance))
    return;
  for (int i = 0; i < parts_.map.features.capacity(); ++i) {
    if (!parts_.map.features.used(i) || without_.index_of(parts_.map.features[i].id) < 0) continue;
    const Block& block = parts_.filter.state().block[parts_.map.features[i].slot];
    if (block.kind != BlockKind::kInverseDepth) continue;
    take_baseline(parts_.filter, block.parent, covariance);
    return;
  }
}

/// What moves before a camera that stands still has drawn its pose along, since no depth is known: it is again that of the record's first
/// frame, and of the map what has not moved stays.
void FilterStart::stay_at_base() {
  Body body;
  body.q_WC = without_.base_q_WC();
  body.p_W = without_.base_p_W();
  clear_all_but_walls();
  begin_body(body, false);
  const Scalar rho = Scalar(1) / settings_.start_depth;
  restart_features([&](int index) { return without_.stays(settings_.camera, index) ? rho : Scalar(0); },
                   settings_.inverse_depth_relative_sigma);
}

/// The world stays, and a record begins with this frame. Features that were found in several frames begin again where they are now: where
/// most corners are never found again (speckles, leaves), a record of corners alone would run out of features before there is parallax.
void FilterStart::begin_anew() {
  Vec2 proven[StartRecord::kMaxFeatures];
  int count = 0;
  for (int t = 0; t < parts_.frame.match_count() && count < StartRecord::kMaxFeatures; ++t) {
    const Match& match = parts_.frame.match(t);
    if (match.feature >= 0 && match.status == MatchStatus::kInlier &&
        parts_.map.features[match.feature].observations >= kProven)
      proven[count++] = Vec2(match.measured.array().round());
  }
  parts_.features.drop_all();
  parts_.images.add_features_at(proven, count);
}

/// Adds the record's features to the filter; removes all others. rho(index): inverse depth of a feature of the record; 0: none.
template <typename Rho>
void FilterStart::restart_features(Rho&& rho_of, Scalar relative_sigma) {
  Filter& filter = parts_.filter;
  const int anchor = filter.add_anchor();
  const Mat2 noise = NoiseModel::search();
  for (int i = 0; i < parts_.map.features.capacity(); ++i) {
    if (!parts_.map.features.used(i)) continue;
    Feature& f = parts_.map.features[i];
    if (f.is_target) {
      f.slot = parts_.features.add_target_point(target_.target(), static_cast<int>(f.external_id));
      if (f.slot < 0)
        parts_.features.release(i);
      else
        filter.set_owner(f.slot, i);
      continue;
    }
    const int index = without_.index_of(f.id);
    Vec3 ray_C;
    Mat32 J_ray_pixel;
    Vec2 pixel;
    const Scalar rho = index < 0 ? Scalar(0) : rho_of(index);
    if (!(rho > Scalar(0)) || !project(filter.lens(), without_.record().ray(index), &pixel) ||
        !unproject(filter.lens(), pixel, &ray_C, &J_ray_pixel)) {
      parts_.features.release(i);
      continue;
    }
    f.slot = filter.add_inverse_depth(anchor, ray_C, J_ray_pixel, noise, rho, relative_sigma * rho);
    if (f.slot < 0)
      parts_.features.release(i);
    else
      filter.set_owner(f.slot, i);
  }
}

/// Moves the body to frame k of the record, and updates with its pixels and residuals of zero.
void FilterStart::restart_frame(int k, std::int64_t before_ns, Scalar unit) {
  Filter& filter = parts_.filter;
  const StartRecord& record = without_.record();
  const StartRecord::Frame& frame = record.frame(k);
  const Scalar dt = static_cast<Scalar>(seconds(std::min(elapsed_ns(before_ns, frame.t_ns), BodyMotion::kMaxGapNs)));
  Body now = filter.state().body;
  const Quat q_WC = without_.base_q_WC() * frame.q_WC;
  const Vec3 p_W = without_.base_p_W() + without_.base_q_WC() * frame.p_W * unit;
  now.v_W = (p_W - now.p_W) / dt;
  now.w_C = log_so3(now.q_WC.conjugate() * q_WC) / dt;
  Transition transition;
  // Residuals of zero do not say how the gyro agrees with the bundle's rotations, which are those of the pixels alone.
  if (settings_.inertial)
    motion_.predict_coasting(now, before_ns, frame.t_ns, &transition);
  else
    motion_.predict(now, before_ns, frame.t_ns, settings_.motion_noise, &transition);
  transition.mean.q_WC = q_WC;
  transition.mean.p_W = p_W;
  filter.predict(transition);
  // Its pixels are those of the frame's own time: rows would say how it moves, which nothing has told.
  Camera at_once = filter.lens();
  at_once.readout = Scalar(0);
  int count = 0;
  for (int i = 0; i < parts_.map.features.capacity() && count < settings_.max_observations; ++i) {
    const Feature& f = parts_.map.features[i];
    if (!parts_.map.features.used(i) || f.is_target || !record.seen(k, without_.index_of(f.id))) continue;
    PixelMeasurement& o = parts_.update.observation(count);
    if (!filter.predict_pixel(at_once, f.slot, &o)) continue;
    o.measured = o.predicted;
    o.set_noise(NoiseModel::search_update());
    ++count;
  }
  if (count == 0) return;
  filter.begin_update(parts_.update.observations(), count);
  filter.finish_update(parts_.update.observations(), count, nullptr, nullptr);
}

/// Sets the velocities from the last few frames of the record; several, because single poses are noisy.
void FilterStart::restart_velocities(Scalar unit) {
  const StartRecord& record = without_.record();
  const int frames = record.frames();
  const StartRecord::Frame& a = record.frame(frames > 4 ? frames - 4 : 0);
  const StartRecord::Frame& b = record.frame(frames - 1);
  if (b.t_ns <= a.t_ns) return;
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(a.t_ns, b.t_ns)));
  Body now = parts_.filter.state().body;
  now.v_W = without_.base_q_WC() * (b.p_W - a.p_W) * unit / dt;
  now.w_C = log_so3(a.q_WC.conjugate() * b.q_WC) / dt;
  parts_.filter.set_mean(now);
}

/// Updates with the target's pixels in this frame.
void FilterStart::restart_at_target() {
  int count = 0;
  for (int t = 0; t < parts_.frame.match_count() && count < settings_.max_observations; ++t) {
    const Match& match = parts_.frame.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier) continue;
    const Feature& f = parts_.map.features[match.feature];
    PixelMeasurement& o = parts_.update.observation(count);
    if (!f.is_target || !parts_.filter.predict_pixel(parts_.filter.lens(), f.slot, &o)) continue;
    o.measured = match.measured;
    o.set_noise(NoiseModel::search());
    ++count;
  }
  if (count == 0) return;
  parts_.filter.begin_update(parts_.update.observations(), count);
  parts_.filter.finish_update(parts_.update.observations(), count, nullptr, nullptr);
}

}  // namespace pf
