#include "base/table_entries.h"
#include "filter/baseline.h"
#include "filter_slam/start/record_replay.h"
#include "filter_slam/start/start_recorder.h"
#include "filter_slam/start/tuning.h"
#include "frame/start/tuning.h"
#include "frame/tuning.h"
#include "model/camera_at.h"

/// StartRecorder: what the filter takes from the record, and how it begins again from it.

namespace pf {

/// The body of the record's first frame.
Body StartRecorder::base() const {
  Body body;
  body.q_WC = record_.base_q_WC();
  body.p_W = record_.base_p_W();
  return body;
}

/// Restarts the filter at the record's first frame with the bundle's depths as wide priors, and repeats the recorded frames. The target's
/// pixels in the last frame correct the mean. unit: W's lengths per length of the record.
void StartRecorder::restart(Scalar unit) {
  beginning_.clear_all_but_walls();
  if (record_.bundle().lens() != nullptr) filter_.set_lens(*record_.bundle().lens(), settings_.lens);
  const bool fitted = progress().checking && !beginning_.known().given;
  beginning_.begin_at(base(), fitted ? &target_.target() : nullptr);
  RecordReplay replay(settings_, motion_, map_, record_, unit, filter_, update_);
  // Residuals of zero do not measure the lens: the bundle's solution holds for the lens with which the filter begins.
  filter_.consider_lens(true);
  restart_features(
      [&](int index) { return record_.bundle().good(index) ? record_.bundle().rho(index) / unit : Scalar(0); },
      tuning::filter_start::kWideDepth);
  replay.run();
  filter_.consider_lens(false);
  if (settings_.body.has(BodyPart::kVelocity)) replay.set_velocities();
  if (map_.planes.has_apart()) {
    // The record's unit of length is a guess, which is as good as any.
    const Scalar kSigma = tuning::start_before_walls::kOpenScale;
    filter_.open_scale(kSigma * kSigma, beginning_.known().body.p_W);
  }
  if (progress().checking) update_with_target();
}

/// The same where poses have been given out that were by known depths. By how much this frame's pose moves, so have they.
void StartRecorder::restart_known(Scalar unit) {
  const CameraAt before = camera_at(filter_.state(), Scalar(0));
  restart(unit);
  const CameraAt now = camera_at(filter_.state(), Scalar(0));
  frame_.correction.add(Similarity::between(before.q_WC, before.p_W, now.q_WC, now.p_W));
}

/// As long as depths are open, no pixel's linearisation constrains the baseline (Filter::parallax_noise). Its variance would grow with the
/// unknown speed, and search ellipses with it. That a rotation explains all pixels does constrain it.
void StartRecorder::bound_baseline() {
  Mat3 covariance;
  if (!record_.baseline_covariance(settings_.camera, tuning::noise::kSearchSigma, settings_.start_depth, &covariance))
    return;
  for (const int i : used_entries(map_.features)) {
    if (record_.index_of(map_.features[i].id) < 0) continue;
    const Block& block = filter_.state().block[map_.features[i].slot];
    if (block.kind != BlockKind::kInverseDepth) continue;
    take_baseline(filter_, block.parent, covariance);
    return;
  }
}

/// What moves before a camera that stands still has drawn its pose along, since no depth is known: it is again that of the record's first
/// frame, and of the map what has not moved stays.
void StartRecorder::stay_at_base() {
  beginning_.clear_all_but_walls();
  beginning_.begin_at(base(), nullptr);
  const Scalar rho = Scalar(1) / settings_.start_depth;
  restart_features([&](int index) { return record_.stays(settings_.camera, index) ? rho : Scalar(0); },
                   settings_.inverse_depth_relative_sigma);
}

/// Adds the target's points and the record's features to the filter; removes all others. rho_of(index): inverse depth of a feature of the
/// record; 0: none.
template <typename Rho>
void StartRecorder::restart_features(Rho&& rho_of, Scalar relative_sigma) {
  const int anchor = filter_.add_anchor();
  for (const int i : used_entries(map_.features)) {
    Feature& f = map_.features[i];
    if (f.is_target) {
      f.slot = features_.add_target_point(target_.target(), static_cast<int>(f.external_id));
    } else {
      const int index = record_.index_of(f.id);
      f.slot = add_recorded(anchor, index, index < 0 ? Scalar(0) : rho_of(index), relative_sigma);
    }
    if (f.slot < 0)
      features_.release(i);
    else
      filter_.set_owner(f.slot, i);
  }
}

/// Adds feature `index` of the record to the filter. Returns its slot, or -1: it has no depth, or there is no room.
int StartRecorder::add_recorded(int anchor, int index, Scalar rho, Scalar relative_sigma) {
  Vec3 ray_C;
  Mat32 J_ray_pixel;
  Vec2 pixel;
  if (!(rho > Scalar(0)) || !project(filter_.lens(), record_.record().ray(index), &pixel) ||
      !unproject(filter_.lens(), pixel, &ray_C, &J_ray_pixel))
    return -1;
  return filter_.add_inverse_depth(anchor, ray_C, J_ray_pixel, NoiseModel::search(), rho, relative_sigma * rho);
}

/// Updates with the target's pixels in this frame.
void StartRecorder::update_with_target() {
  int count = 0;
  for (int t = 0; t < frame_.match_count() && count < settings_.max_observations; ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier) continue;
    const Feature& f = map_.features[match.feature];
    PixelMeasurement& o = update_.observation(count);
    if (!f.is_target || !filter_.predict_pixel(filter_.lens(), f.slot, &o)) continue;
    o.measured = match.measured;
    o.set_noise(NoiseModel::search());
    ++count;
  }
  if (count == 0) return;
  filter_.begin_update(update_.observations(), count);
  filter_.finish_update(update_.observations(), count, nullptr, nullptr);
}

}  // namespace pf
