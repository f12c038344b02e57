#include "keyframe_slam/tracking/relocaliser.h"

#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "belief/tuning.h"
#include "frame/tuning.h"
#include "geometry/so3.h"
#include "memory/tuning.h"

namespace pf {

using namespace tuning::relocaliser;

bool KeyframeRelocaliser::is_prediction_narrow(Scalar median_depth) const {
  const Mat6 P = motion_.pose_covariance();
  const Scalar position = kNearbySigma * median_depth;
  return P(0, 0) + P(1, 1) + P(2, 2) < kNearbySigma * kNearbySigma && P(3, 3) + P(4, 4) + P(5, 5) < position * position;
}

const Mat6* KeyframeRelocaliser::found_covariance() const {
  const int place = map_.places.entry_of(recalled_);
  return place >= 0 ? &map_.places[place].covariance : nullptr;
}

/// One frame describes its image, and the next one compares: neither has much more to do than a keyframe. With places of other maps it asks
/// more often, whether it sees one of these.
void KeyframeRelocaliser::note_view(Scalar median_depth) {
  if (settings_.kept.places == 0) return;
  if (asked_.last.is_described) return compare_view();
  const CameraView view = motion_.view();
  const auto is_apart = [&](const Asked& from, Scalar bound) {
    return !(from.depth > Scalar(0)) || view_distance2(view.q_WC, view.c_W, median_depth, from.view.q_WC, from.view.c_W,
                                                       from.depth) >= bound * bound;
  };
  const bool is_new = is_apart(asked_.judged, tuning::place::kNear);
  if (!is_new && !(map_.places.has_other() && is_apart(asked_.last, tuning::place::kApart))) return;
  asked_.last = {view, median_depth, true};
  if (is_new) asked_.judged = asked_.last;
  recall_.describe_image(tracker_);
}

void KeyframeRelocaliser::compare_view() {
  asked_.last.is_described = false;
  if (asked_.judged.is_described) belief_.note_view(recall_.is_alike(asked_.last.view, asked_.last.depth));
  asked_.judged.is_described = false;
  // Where parts of this map look alike, so may parts of two maps.
  const bool is_sure = belief_.most_elsewhere() > tuning::pose_belief::kTracked;
  if (is_sure) joins_.look(asked_.last.view, asked_.last.depth);
}

/// Brings the place back that the image may show, and its rival, so that they can be searched for.
bool KeyframeRelocaliser::recall(PoseHypothesis* place, PoseHypothesis* rival, bool* has_rival) {
  recalled_ = 0;
  asked_.last.is_described = asked_.judged.is_described = false;
  if (recalled_in_vain_) return recalled_in_vain_ = false;  // now the kept views are tried
  Recalled best, other;
  if (!recall_.find(tracker_, &best, &other) || !keeper_.bring_back(best.place)) return false;
  *has_rival = other.inliers > 0 && keeper_.bring_back(other.place);
  keeper_.bring_near({best.pose.q_WC, best.pose.p_WC}, best.depth, tuning::place::kMaxReturns);
  recalled_ = best.place;
  *place = PoseHypothesis::of(best.pose);
  *rival = PoseHypothesis::of(other.pose);
  return true;
}

KeyframeRelocaliser::Tried KeyframeRelocaliser::try_pose(const PoseHypothesis& about, const PoseProposal& before,
                                                         Scalar median_depth) {
  Tried out;
  const PosePrior prior = {about.q_WC, about.p_W, about.P};
  out.found = measuring_.measure_about(prior, &out.pose, &out.information, &out.consensus) >= settings_.min_inliers;
  out.consensus.is_elsewhere = true;
  const bool follows = before.is_set && log_so3(out.pose.q_WC * before.q_WC.conjugate()).norm() < kAboutView &&
                       (out.pose.p_WC - before.p_W).norm() < kAboutView * median_depth;
  out.log_odds =
      PoseBelief::updated(follows ? before.log_odds : PoseBelief::elsewhere(), belief_.evidence(out.consensus));
  return out;
}

/// The rival is one of the other places where the camera may be, with odds of its own:
///
///   L = min(L_1, -ln s) - ln(1 + exp(L_2)),   s: share of views that look like another part of the map
void KeyframeRelocaliser::recover(Scalar median_depth) {
  const PoseProposal before = proposal_, rival_before = rival_;
  const std::uint32_t recalled = recalled_;
  PoseHypothesis elsewhere, other;
  bool has_other = false;
  clear_proposal();
  bool chosen = !before.is_set && recall(&elsewhere, &other, &has_other);
  if (!chosen) {
    recalled_ = recalled;
    chosen = find_elsewhere(before, views_, tracker_.pyramid(), map_.camera(), median_depth, &elsewhere);
    has_other = rival_before.is_set &&
                find_elsewhere(rival_before, views_, tracker_.pyramid(), map_.camera(), median_depth, &other);
  }
  if (!chosen) return;
  Scalar against = 0;
  if (has_other) {
    const Tried rival = try_pose(other, rival_before, median_depth);
    rival_ = rival.proposal(median_depth);
    if (rival.found) against = std::log(1 + std::exp(rival.log_odds));
    measuring_.forget_searches();
  }
  const Tried tried = try_pose(elsewhere, before, median_depth);
  recalled_in_vain_ = recalled_ != 0 && !tried.found;
  proposal_ = tried.proposal(median_depth);
  const Scalar log_odds = std::min(tried.log_odds, belief_.most_elsewhere()) - against;
  if (!tried.found || !belief_.may_use(log_odds, tried.consensus)) return;
  const KeyframeMotion coasting = motion_;
  motion_.set_pose_covariance(elsewhere.P);
  if (!measuring_.correct(tried.pose, tried.information)) {
    motion_.set_prediction(coasting.body(), coasting.covariance());
    return;
  }
  belief_.use(log_odds, tried.consensus);
  proposal_ = rival_ = PoseProposal();
}

void KeyframeRelocaliser::leave_map(std::uint32_t map_id) {
  if (settings_.kept.places == 0) return;
  for (const int k : used_entries(map_.keyframes)) keeper_.keep(k);
  map_.places.leave(map_id);
}

void KeyframeRelocaliser::move(const Similarity& T) {
  views_.move(T);
  move_asked(T);
}

void KeyframeRelocaliser::move_asked(const Similarity& T) {
  asked_.last.view = {(T.q * asked_.last.view.q_WC).normalized(), T.of(asked_.last.view.c_W)};
  asked_.last.depth *= T.s;
  asked_.judged.view = {(T.q * asked_.judged.view.q_WC).normalized(), T.of(asked_.judged.view.c_W)};
  asked_.judged.depth *= T.s;
  joins_.init();
  clear_proposal();
}

}  // namespace pf
