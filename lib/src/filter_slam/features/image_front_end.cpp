#include "filter_slam/features/image_front_end.h"

#include <algorithm>

#include "base/elapsed.h"
#include "filter_slam/pose/consensus.h"
#include "filter_slam/pose/triple_consensus.h"
#include "frame/tracking_state.h"
#include "frame/tuning.h"

namespace pf {
namespace {

using namespace tuning::image_front_end;

}  // namespace

bool ImageFrontEnd::layout(Arena& arena, int max_observations) { return search_.layout(arena, max_observations); }

void ImageFrontEnd::init() {
  search_.init();
  same_view_.init();
}

bool ImageFrontEnd::begin_frame(const ImageView& image) {
  is_measured_ = false;
  return search_.begin_frame(image);
}

void ImageFrontEnd::measure(ConsensusRule rule, Scalar median_depth, bool parallax_lasts) {
  noise_.set_parallax_lasts(parallax_lasts);
  is_learnt_ = rule != ConsensusRule::kStart && same_view_.is_learnt(filter_.state().body, median_depth,
                                                                     settings_.camera.fx, noise_.correlation_frames());
  filter_.estimate_motion_only(is_learnt_);
  measure_visible(rule, rule == ConsensusRule::kStart);
  const bool followed = search_.is_following();
  if (frame_.report.inliers == 0 && (followed || search_.begin_following(listed_))) {
    search_.set_following(!followed);
    measure_visible(rule, false);
  }
  search_.set_following(false);
  filter_.estimate_motion_only(false);
}

/// If the pose is uncertain, a few candidates are measured first. If their consensus is too weak, all candidates are searched before
/// anything is used. follows: where few of those first ones are found, searches go about the places where the picture as a whole has gone.
void ImageFrontEnd::measure_visible(ConsensusRule rule, bool follows) {
  frame_.forget_searches();
  const int count = search_.list_visible();
  listed_ = count;
  is_measured_ = true;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
    search_.predict_pixels(0, count);
  }
  const int scouts = search_.widest_ellipse(count) > kWideEllipse && count > kScouts ? kScouts : 0;
  int found = search_.search(0, scouts > 0 ? scouts : count);
  if (follows && Scalar(found) < kFewFound * Scalar(frame_.report.attempts) && search_.begin_following(listed_))
    return measure_visible(rule, false);
  if (scouts > 0) {
    const bool scouted = update_with_consensus(0, found, rule);
    if (scouted) {
      StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
      search_.predict_pixels(scouts, count - scouts);
    }
    const int more = search_.search(scouts, count - scouts);
    if (scouted) {
      update_with_consensus(scouts, more, rule);
      return;
    }
    for (int k = 0; k < more; ++k, ++found)
      if (found != scouts + k) update_.swap(found, scouts + k);
  }
  update_with_consensus(0, found, rule);
}

/// Finds the consensus of matches and updates the filter with it. False if it may be chance; nothing is used then.
bool ImageFrontEnd::update_with_consensus(int first, int found, ConsensusRule rule) {
  if (found == 0) return false;
  update_.begin(first, found);
  unsigned char* keep = update_.keep();
  bool accepted;
  double nis = 0;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
    const PixelMeasurement* observations = update_.observations() + first;
    const int inliers = find_inliers(filter_, observations, found, settings_.gate, keep + first);
    int least = 1;  // if an earlier range has given inliers, any consensus is accepted
    accepted = inliers > 0;
    if (frame_.report.inliers == 0 && rule == ConsensusRule::kStart) {
      least = std::min(kMinConsensus, map_.features.count());
    } else if (frame_.report.inliers == 0) {
      least = settings_.min_inliers;
      accepted = inliers >= least && ((rule == ConsensusRule::kMostAgree && most_agree(first, found)) ||
                                      is_beyond_chance(first, found, rule));
    }
    // A match that all the others contradict supports nothing.
    if (accepted) accepted = update_.reject_contradicted(first, found, &nis) >= least;
  }
  for (int i = first; i < first + found; ++i) {
    const PixelMeasurement& o = update_.observation(i);
    if (!accepted) keep[i] = 0;
    Match& match = frame_.match(update_.candidate(i).match);
    match.status = keep[i] != 0 ? MatchStatus::kInlier : MatchStatus::kOutlier;
    match.nis =
        squared_distance(match.measured - o.predicted, filter_.innovation_block(i - first, i - first) + o.R_gate);
  }
  // Jointly, with the noise of the gate: that of the update allows for errors that come again in later frames.
  if (!accepted || !update_.apply(first, found, nullptr)) return false;
  frame_.report.nis += nis;
  return true;
}

/// Whether at least half of what was searched for is among the inliers. Half of all corners are never found again, so the new ones say
/// little by being missed, and do not count where enough others were searched for.
bool ImageFrontEnd::most_agree(int first, int found) const {
  int searched = 0, agree = 0;
  for (int i = 0; i < listed_; ++i) {
    const Candidate& candidate = update_.candidate(i);
    if (map_.features[candidate.feature].observations < 2 || !frame_.match(candidate.match).searched) continue;
    ++searched;
    agree += i >= first && i < first + found && update_.keep()[i] != 0 ? 1 : 0;
  }
  if (searched >= settings_.min_inliers) return kMinAgreeing * agree >= searched;
  const int inliers = static_cast<int>(std::count(update_.keep() + first, update_.keep() + first + found, 1));
  return kMinAgreeing * inliers >= frame_.report.attempts;
}

/// Whether chance would hardly let as many matches agree as keep says.
bool ImageFrontEnd::is_beyond_chance(int first, int found, ConsensusRule rule) {
  const Scalar* const searched_px2 = search_.searched_areas(first, found);
  const auto is_beyond = [&](int levels) {
    return find_triple_consensus(filter_, update_.observations() + first, searched_px2, found, frame_.report.attempts,
                                 settings_.gate, tuning::tracking::kTriples, levels, update_.keep() + first, nullptr)
               .log_false < tuning::tracking::kMaxLogFalse;
  };
  return is_beyond(1) || (rule == ConsensusRule::kFollowed && is_beyond(tuning::chance::kLevels));
}

void ImageFrontEnd::note_view(bool taught, Scalar median_depth) {
  if (taught)
    same_view_.note(filter_.state().body, median_depth, settings_.camera.fx);
  else
    same_view_.forget();
}

void ImageFrontEnd::learn_noise() {
  if (!is_learnt_) noise_.learn(listed_);  // else they are the same errors once more
}

void ImageFrontEnd::learn_templates() {
  if (is_measured_) search_.learn_templates(listed_);
}

}  // namespace pf
