#include <algorithm>

#include "base/elapsed.h"
#include "filter/observe/row.h"
#include "geometry/so3.h"
#include "slam/filter_slam.h"

/// A start with nothing known: the filter tracks (so that the search knows where to look) while the pixels of the first frames
/// are recorded; when a bundle adjustment can explain them in one way only, the filter begins again from that explanation.

namespace pf {

/// The features that this frame has begun become the record's.
void FilterSlam::begin_record() {
  record_.init();
  bundle_.init();
  base_q_WC_ = filter_.state().body.q_WC;
  base_p_W_ = filter_.state().body.p_W;
  record_begin_ns_ = frame_.report.t_ns;
  for (int t = 0; t < frame_.match_count(); ++t) {
    if (frame_.match(t).status != MatchStatus::kNew || frame_.match(t).feature < 0) continue;
    Vec3 ray_C;
    if (!unproject(settings_.camera, frame_.match(t).measured, &ray_C)) continue;
    map_.features[frame_.match(t).feature].start_index = record_.add_feature(ray_C);
  }
}

/// A measured pixel without what the rows' readout at other times than the frame's did to it. That is how fast the image moves
/// there, which is known well before depths and speeds are.
Vec2 FilterSlam::at_frame_time(int slot, const Vec2& measured) const {
  Camera at_once = settings_.camera;
  at_once.readout = Scalar(0);
  Observation by_rows, still;
  if (settings_.camera.readout == Scalar(0) || !filter_.predict_pixel(settings_.camera, slot, &by_rows) ||
      !filter_.predict_pixel(at_once, slot, &still))
    return measured;
  return measured - (by_rows.predicted - still.predicted);
}

/// The same for the rays of the record's frame 0, of which nothing was known, by what moved until now.
void FilterSlam::move_rays_to_frame_time() {
  if (settings_.camera.readout == Scalar(0)) return;
  const Scalar dt = static_cast<Scalar>(static_cast<double>(elapsed_ns(record_begin_ns_, frame_.report.t_ns)) * 1e-9);
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier) continue;
    const int index = map_.features[match.feature].start_index;
    Vec2 first;
    Vec3 ray_C;
    if (index < 0 || !project(settings_.camera, record_.ray(index), &first)) continue;
    const Vec2 moved = (at_frame_time(map_.features[match.feature].slot, match.measured) - first) / dt;
    if (unproject(settings_.camera, first - row_time(settings_.camera, first.y()) * moved, &ray_C))
      record_.set_ray(index, ray_C);
  }
}

void FilterSlam::record_frame() {
  if (record_.features() == 0 || frame_.report.inliers < TrackingState::kMinInliers) return;
  const Body& body = filter_.state().body;
  const Quat q_KW = base_q_WC_.conjugate();
  if (record_.frames() == 0) move_rays_to_frame_time();
  const int k = record_.add_frame(frame_.report.t_ns, q_KW * body.q_WC, q_KW * (body.p_W - base_p_W_));
  for (int t = 0; t < frame_.match_count(); ++t) {
    const int entry = frame_.match(t).feature;
    if (entry < 0 || frame_.match(t).status != MatchStatus::kInlier || map_.features[entry].start_index < 0) continue;
    record_.add_pixel(k, map_.features[entry].start_index,
                      at_frame_time(map_.features[entry].slot, frame_.match(t).measured));
  }
  const StartOutcome outcome = bundle_.solve(settings_.camera, record_, Tracker::kTypicalSigma, settings_.start_depth);
  switch (outcome) {
    case StartOutcome::kWait:
      break;
    case StartOutcome::kSolved:
    case StartOutcome::kSettled:
      restart_from_record();
      if (!start_.depth_known) settings_.hooks.say("started without a target: the first depths are known");
      start_.depth_known = true;
      start_.recording = outcome != StartOutcome::kSettled;
      break;
    case StartOutcome::kTooFew:
      start_.recording = !start_.depth_known;
      if (start_.depth_known) break;
      // Nothing but rotation so far, or too little in view: the world stays, the first frame is now this one.
      for (int i = 0; i < map_.features.capacity(); ++i)
        if (map_.features.used(i)) scratch_[0] = i, drop(scratch_, 1);
      record_.init();
      break;
  }
}

/// A table entry goes, and its appearance; its block in the filter is gone already.
void FilterSlam::release(int entry) {
  tracker_.forget(map_.features[entry].appearance);
  frame_.forget(entry);
  map_.features.remove(entry);
}

/// The filter begins again at the record's frame 0 with the bundle's depths as prior means, wide, and goes through the recorded
/// frames with every linearisation at the bundle's poses and with residuals of zero: that moves no mean, and leaves the
/// covariance that the recorded pixels support.
void FilterSlam::restart_from_record() {
  const int frames = record_.frames();
  Body body;
  body.q_WC = base_q_WC_;
  body.p_W = base_p_W_;
  begin_filter();
  begin_at(body, start_covariance_);
  const int anchor = filter_.add_anchor();

  constexpr Scalar kWide = Scalar(0.5);
  const Mat2 noise = Mat2::Identity() * (Tracker::kTypicalSigma * Tracker::kTypicalSigma);
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!map_.features.used(i)) continue;
    Feature& f = map_.features[i];
    Vec3 ray_C;
    Mat32 J_ray_pixel;
    Vec2 pixel;
    if (f.start_index < 0 || !bundle_.good(f.start_index) ||
        !project(settings_.camera, record_.ray(f.start_index), &pixel) ||
        !unproject(settings_.camera, pixel, &ray_C, &J_ray_pixel)) {
      release(i);
      continue;
    }
    const Scalar rho = bundle_.rho(f.start_index);
    f.slot = filter_.add_inverse_depth(anchor, ray_C, J_ray_pixel, noise, rho, kWide * rho);
    if (f.slot < 0)
      release(i);
    else
      filter_.set_owner(f.slot, i);
  }

  std::int64_t t_ns = record_begin_ns_;
  for (int k = 0; k < frames; ++k) {
    const StartRecord::Frame& frame = record_.frame(k);
    const Scalar dt = static_cast<Scalar>(
        static_cast<double>(std::min(elapsed_ns(t_ns, frame.t_ns), BodyMotion::kLongestGap)) * 1e-9);
    t_ns = frame.t_ns;
    Body& now = filter_.body();
    const Quat q_WC = base_q_WC_ * frame.q_WC;
    const Vec3 p_W = base_p_W_ + base_q_WC_ * frame.p_W;
    now.v_W = (p_W - now.p_W) / dt;
    now.w_C = log_so3(now.q_WC.conjugate() * q_WC) / dt;
    Transition transition;
    motion_.predict(now, dt, settings_.motion_noise, &transition);
    now.q_WC = q_WC;
    now.p_W = p_W;
    filter_.predict(transition);
    int count = 0;
    for (int i = 0; i < map_.features.capacity() && count < settings_.max_observations; ++i) {
      if (!map_.features.used(i) || !record_.seen(k, map_.features[i].start_index)) continue;
      Observation& o = observation_[count];
      if (!filter_.predict_pixel(settings_.camera, map_.features[i].slot, &o)) continue;
      o.measured = o.predicted;
      o.noise = noise;
      ++count;
    }
    if (count == 0) continue;
    filter_.begin_update(observation_, count);
    filter_.finish_update(observation_, count, nullptr, nullptr);
  }
  if (!settings_.constant_velocity) return;
  // Velocities over the last few frames, against the noise of single poses.
  const int from = frames > 4 ? frames - 4 : 0;
  const StartRecord::Frame& a = record_.frame(from);
  const StartRecord::Frame& b = record_.frame(frames - 1);
  if (b.t_ns <= a.t_ns) return;
  const Scalar dt = static_cast<Scalar>(static_cast<double>(elapsed_ns(a.t_ns, b.t_ns)) * 1e-9);
  filter_.body().v_W = base_q_WC_ * (b.p_W - a.p_W) / dt;
  filter_.body().w_C = log_so3(a.q_WC.conjugate() * b.q_WC) / dt;
}

}  // namespace pf
