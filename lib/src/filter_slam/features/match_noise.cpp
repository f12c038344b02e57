#include "filter_slam/features/match_noise.h"

#include "frame/tuning.h"

namespace pf {

void MatchNoise::set(int i, const SearchOutcome& found, bool parallax_lasts) const {
  const Mat2 noise = model_.match(found.noise, found.level_scale);
  Candidate& candidate = update_.candidate(i);
  PixelMeasurement& o = update_.observation(i);
  candidate.noise = noise;
  o.set_noises(noise + o.second_order, update_noise(map_.features[candidate.feature], o, noise, parallax_lasts));
}

/// Whether a feature's matches add up to coordinates that are averaged over frames, so that errors which stay with the feature count. The
/// target's coordinates are given, and an inverse depth has been seen from about its first view only, which its matches are compared with.
bool MatchNoise::is_averaged(const Feature& f) const {
  return !f.is_target && !filter_.state().has_inverse_depth(f.slot);
}

/// R_update of a match with this noise, without bend. What the linearisation leaves out is new in each frame, but for the product of an
/// open depth and a baseline that is wrong for as long: where that lasts, it counts twice (lib/docs/theory/lens.md).
Mat2 MatchNoise::update_noise(const Feature& f, const PixelMeasurement& o, const Mat2& noise,
                              bool parallax_lasts) const {
  Mat2 R = (is_averaged(f) ? model_.correlation_frames() : Scalar(1)) * noise + o.second_order;
  if (parallax_lasts && filter_.state().has_inverse_depth(f.slot)) R += o.second_order;
  return R;
}

void MatchNoise::learn(int count) {
  using tuning::image_front_end::kSettled;
  for (int i = 0; i < count; ++i) {
    const Candidate& candidate = update_.candidate(i);
    if (update_.keep()[i] == 0 || frame_.match(candidate.match).status != MatchStatus::kInlier) continue;
    Feature& f = map_.features[candidate.feature];
    PixelMeasurement now;
    if (f.observations < kSettled || !filter_.predict_pixel(filter_.lens(), f.slot, &now)) continue;
    const bool averaged = is_averaged(f);
    const Scalar correlation = averaged ? model_.correlation_frames() : Scalar(1);
    const Scalar leverage = filter_.innovation(now).trace() / (correlation * candidate.noise.trace());
    model_.learn(frame_.report.frames, update_.observation(i).measured - now.predicted, candidate.noise, leverage,
                 averaged ? &f.residuals : nullptr);
  }
  model_.end_frame();
}

}  // namespace pf
