#include "filter_slam/features/image_front_end.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter_slam/pose/consensus.h"
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

UpdateOutcome ImageFrontEnd::measure(MeasureMode mode) {
  is_learnt_ = !mode.starts && same_view_.is_learnt(filter_.state().body, mode.median_depth, settings_.camera.fx,
                                                    noise_.correlation_frames());
  mode.update.rows.map = !is_learnt_;
  is_measured_ = true;
  hypotheses_.begin();
  outcome_ = UpdateOutcome();
  listed_ = list_candidates();
  bool followed = mode.starts && !mode.is_vague && !settings_.inertial && search_.find_followed(listed_);
  if (!mode.is_vague) followed = measure_listed(mode, followed, mode.starts);
  if (frame_.report.inliers == 0 && (followed || search_.find_followed(listed_))) {
    if (!mode.is_vague) {
      hypotheses_.add();
      listed_ = list_candidates();
    }
    measure_listed(mode, !followed, false);
  }
  return outcome_;
}

/// Lists what should be in view, and predicts where.
int ImageFrontEnd::list_candidates() {
  frame_.forget_searches();
  const int count = search_.list_visible();
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
  search_.predict_pixels(0, count);
  return count;
}

/// If the pose is uncertain, a few candidates are measured first. If their consensus is too weak, all candidates are searched before
/// anything is used. follows: searches go about the places where the image as a whole has gone, which tells the rotation better than a
/// motion model does, and worse than a gyroscope. may_change: where few of those first ones are found, they go about the other. Returns
/// whether they followed.
bool ImageFrontEnd::measure_listed(const MeasureMode& mode, bool follows, bool may_change) {
  const SearchMode search = {follows, mode.parallax_lasts};
  const int count = listed_;
  const int scouts = search_.widest_ellipse(count) > kWideEllipse && count > kScouts ? kScouts : 0;
  int found = search_.search(0, scouts > 0 ? scouts : count, search);
  const int scouted = frame_.report.attempts;
  if (may_change && belief_.share().is_unlikely(scouted, found) && (follows || search_.find_followed(count))) {
    listed_ = list_candidates();
    return measure_listed(mode, !follows, false);
  }
  if (scouts > 0) {
    const bool used = update_with_consensus({0, found, scouted, false, follows}, mode);
    if (used) {
      StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
      search_.predict_pixels(scouts, count - scouts);
    }
    const int more = search_.search(scouts, count - scouts, search);
    if (used) {
      update_with_consensus({scouts, more, frame_.report.attempts - scouted, true, follows}, mode);
      return follows;
    }
    for (int k = 0; k < more; ++k, ++found)
      if (found != scouts + k) update_.swap(found, scouts + k);
  }
  update_with_consensus({0, found, frame_.report.attempts, true, follows}, mode);
  return follows;
}

/// Finds the consensus of the matches of a range, and updates the filter with it. False, with nothing used, where its evidence is not
/// enough to accept the pose.
bool ImageFrontEnd::update_with_consensus(const Range& range, const MeasureMode& mode) {
  const int first = range.first, found = range.found;
  const bool is_first = frame_.report.inliers == 0;
  update_.begin(first, found);
  unsigned char* keep = update_.keep();
  JointFit fit;
  PoseConsensus consensus;
  Scalar log_odds = 0;
  bool accepted;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
    find_inliers(filter_, update_.observations() + first, found, settings_.gate, keep + first);
    // A match that all the others contradict supports nothing.
    const int inliers = found > 0 ? update_.reject_contradicted(first, found, &fit) : 0;
    consensus = consensus_of(range, inliers, fit);
    if (is_first) {
      log_odds = weigh(range, consensus, mode);
      accepted = mode.starts ? inliers >= std::min(kMinConsensus, map_.features.count())
                             : hypotheses_.accepts(consensus, log_odds, range.is_last) &&
                                   !(mode.update.as_usual && belief_.share().is_unlikely(range.searched, inliers));
    } else {  // beside accepted matches any consensus is enough
      log_odds = PoseBelief::updated(belief_.log_odds(), belief_.evidence(consensus));
      accepted = inliers > 0;
    }
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
  if (accepted) outcome_ = update_.apply(first, found, mode.update, outcome_);
  if (!accepted || !outcome_.is_applied) return false;
  frame_.report.nis += static_cast<double>(fit.nis);
  belief_.use(log_odds, consensus);
  return true;
}

/// Where the searches followed the image as a whole, the hypothesis has each pixel there, and not at the prediction.
PoseConsensus ImageFrontEnd::consensus_of(const Range& range, int inliers, const JointFit& fit) {
  const int first = range.first, found = range.found;
  PoseConsensus consensus;
  consensus.searched = range.searched;
  consensus.inliers = inliers;
  consensus.log_density = log_normal_density(fit.nis, fit.log_det, inliers);
  if (range.follows) consensus.log_density = 0;
  const Scalar* const searched_px2 = search_.searched_areas(first, found, range.follows);
  frame_.forget_agreement();
  for (int i = 0; i < found; ++i) {
    if (update_.keep()[first + i] == 0) continue;
    frame_.match(update_.candidate(first + i).match).agrees = true;
    consensus.log_chance += log_chance_density(searched_px2[i]);
    if (range.follows) consensus.log_density += update_.candidate(first + i).log_density;
  }
  note_paired(frame_, belief_.share(), &consensus);
  note_zoom(fit.zoom, settings_, &consensus);
  return consensus;
}

/// Log-odds of the pose with the evidence of the frame's first consensus. A pose that is not accepted yet is proposed to the next frame,
/// once all features have been searched for.
Scalar ImageFrontEnd::weigh(const Range& range, const PoseConsensus& consensus, const MeasureMode& mode) {
  frame_.note_consensus(consensus.inliers);
  const Scalar evidence = hypotheses_.evidence(consensus);
  Scalar log_odds = hypotheses_.weigh(consensus);
  if (!mode.starts && !range.is_last && !PoseBelief::is_settled(log_odds)) return log_odds;
  const bool is_enough = PoseBelief::is_enough(log_odds);
  if (!range.is_last && !is_enough) return log_odds;
  if (consensus.inliers >= settings_.min_inliers && evidence > Scalar(0) &&
      (!is_enough || update_.proposals().last().is_set))
    log_odds =
        update_.propose(range.first, range.found, mode.update.rows, mode.median_depth, belief_.predicted(), evidence);
  belief_.note(log_odds);
  return log_odds;
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
