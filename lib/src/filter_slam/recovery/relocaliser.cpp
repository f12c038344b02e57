#include "filter_slam/recovery/relocaliser.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/limits.h"
#include "filter_slam/pose/triple_consensus.h"
#include "filter_slam/pose/zoom_evidence.h"
#include "filter_slam/recovery/pose_proposal.h"
#include "frame/ellipse.h"
#include "frame/tracking_state.h"
#include "frame/tuning.h"

namespace pf {

using namespace tuning::relocaliser;

namespace {

/// Jacobian by (theta, p), which are the first six columns of a pixel's rows.
Mat26 pose_columns(const PixelMeasurement& o) {
  const int columns = o.H.columns();
  Mat26 J;
  for (int a = 0; a < 2; ++a)
    for (int c = 0; c < 6; ++c) J(a, c) = o.H.h[a * columns + c];
  return J;
}

}  // namespace

bool Relocaliser::layout(Arena& arena, int max_observations, int max_kept_views, FilterMemory* memory) {
  memory_ = memory;
  const std::size_t count = static_cast<std::size_t>(max_observations);
  views_.layout(arena, max_kept_views);
  searched_px2_ = arena.take<Scalar>(count);
  point_W_ = arena.take<Vec3>(count);
  pixel_ = arena.take<Vec2>(count);
  return arena.ok();
}

void Relocaliser::init() {
  depth_ = 1;
  update_.proposals().init();
  if (memory_ != nullptr) memory_->rivals().init();
  views_.init();
}

void Relocaliser::remember_view(Scalar median_depth) {
  depth_ = median_depth;
  views_.keep_if_new(search_.tracker().pyramid(), filter_.state().body.q_WC, filter_.state().body.p_W);
}

UpdateOutcome Relocaliser::recover(const MeasureMode& mode, const UpdateOutcome& before) {
  SearchPose rival;
  const SearchPose about = choose_search_pose(&rival);
  const Scalar against = rival.given ? odds_against(rival, mode.parallax_lasts) : Scalar(0);
  const int found = search_about(about, mode.parallax_lasts);
  return measure_about(about, found, against, mode.update, before);
}

/// Returns how many features were found.
int Relocaliser::search_about(const SearchPose& about, bool parallax_lasts) {
  const Body estimate = filter_.state().body;
  frame_.forget_searches();
  set_pose(about.body);
  int count = search_.list_visible();
  search_.predict_pixels(0, count);
  count = keep_placed(about, count);
  const int found = search_.search(0, count, {false, parallax_lasts});
  set_pose(estimate);
  return found;
}

/// The prediction is good enough for a linear consensus.
bool Relocaliser::is_prediction_narrow() const {
  Scalar variance = 0;
  for (int i = 0; i < 3; ++i) variance += filter_.variance(Body::kTheta + i);
  return variance < kNearbySigma * kNearbySigma;
}

/// About the last frame's proposal, about a place that the image may show, or about a kept view that is like it; where there is none of
/// these, about the prediction. rival: the pose of the last frame's rival, or of the second best place.
Relocaliser::SearchPose Relocaliser::choose_search_pose(SearchPose* rival) {
  SearchPose about;
  about.body = filter_.state().body;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) about.P(i, j) = filter_.covariance()(std::max(i, j), std::min(i, j));
  const PoseProposal& last = update_.proposals().last();
  const Pyramid& image = search_.tracker().pyramid();
  PoseHypothesis elsewhere, other;
  bool has_other = false;
  if (memory_ != nullptr && !last.is_set && memory_->recall(search_.tracker(), &elsewhere, &other, &has_other)) {
    about.set(elsewhere);
  } else {
    if (find_elsewhere(last, views_, image, filter_.lens(), depth_, &elsewhere)) about.set(elsewhere);
    has_other = memory_ != nullptr && last.is_set && memory_->rivals().last().is_set &&
                find_elsewhere(memory_->rivals().last(), views_, image, filter_.lens(), depth_, &other);
  }
  if (has_other) {
    rival->body = about.body;
    rival->set(other);
  }
  return about;
}

void Relocaliser::set_pose(const Body& pose) {
  Body body = filter_.state().body;
  body.q_WC = pose.q_WC;
  body.p_W = pose.p_W;
  filter_.set_mean(body);
}

/// Proposes a pose from the matches of a search about another pose, and tests it in the filter's own covariance. False: too few agree.
bool Relocaliser::try_pose(const SearchPose& about, int found, Tried* out) {
  if (found < settings_.min_inliers) return false;
  for (int i = 0; i < found; ++i) {
    point_W_[i] = filter_.point(map_.features[update_.candidate(i).feature].slot);
    pixel_[i] = update_.observation(i).measured;
    searched_px2_[i] = search_.searched_area(i, false);
  }
  out->pose = about.body;
  const Scalar sigma = std::max(Scalar(1), kProposalPixels * static_cast<Scalar>(settings_.camera.width));
  if (propose_pose(filter_.lens(), about.P, point_W_, pixel_, found, sigma, &out->pose) < settings_.min_inliers)
    return false;
  // Where nothing has been measured of a loaded map yet, the camera may as well be there.
  if (memory_ != nullptr && memory_->is_loaded() && !memory_->is_found()) set_pose(out->pose);
  out->found = found = linearise_at(out->pose, found);
  if (found < settings_.min_inliers) return false;
  update_.begin(0, found);
  out->consensus = find_triple_consensus(filter_, update_.observations(), searched_px2_, found, frame_.report.attempts,
                                         belief_.share(), settings_.gate, kTriples, update_.keep());
  if (memory_ != nullptr && out->consensus.inliers >= settings_.min_inliers) {
    JointFit fit;
    update_.reject_contradicted(0, found, &fit);
    weigh_jointly(filter_, update_.observations(), searched_px2_, found, kTriples, update_.keep(), fit,
                  &out->consensus);
  }
  frame_.forget_agreement();
  for (int i = 0; i < found; ++i) frame_.match(update_.candidate(i).match).agrees = update_.keep()[i] != 0;
  note_paired(frame_, belief_.share(), &out->consensus);
  frame_.note_consensus(out->consensus.inliers);
  return out->consensus.inliers >= settings_.min_inliers;
}

/// What the rival, another place where the camera may be, takes from the log-odds:
///
///   L = L_1 - ln(1 + exp(L_2))
Scalar Relocaliser::odds_against(const SearchPose& rival, bool parallax_lasts) {
  Tried tried;
  if (!try_pose(rival, search_about(rival, parallax_lasts), &tried)) return 0;
  const Scalar log_odds =
      memory_->rivals().propose(tried.pose.q_WC, tried.pose.p_W, median_depth(tried.pose, tried.found),
                                PoseBelief::elsewhere(), belief_.evidence(tried.consensus));
  return std::log(1 + std::exp(log_odds));
}

UpdateOutcome Relocaliser::measure_about(const SearchPose& about, int found, Scalar against, const UpdateMode& mode,
                                         const UpdateOutcome& before) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  Tried tried;
  const bool is_found = try_pose(about, found, &tried);
  if (memory_ != nullptr) memory_->note_tried(is_found);
  if (!is_found) return before;
  found = tried.found;
  const Body& pose = tried.pose;
  PoseConsensus& consensus = tried.consensus;
  const Scalar log_odds = update_.proposals().propose(pose.q_WC, pose.p_W, median_depth(pose, found),
                                                      PoseBelief::elsewhere(), belief_.evidence(consensus)) -
                          against;
  if (!PoseBelief::is_enough(log_odds)) return before;
  weigh_lens(settings_, filter_, update_.observations(), update_.keep(), found, pose, &consensus);
  if (!belief_.may_use(log_odds, consensus)) return before;
  mark_matches(found);
  hold_back(found);
  const UpdateOutcome outcome = update_.apply(0, found, mode, before);
  if (outcome.is_applied) belief_.use(log_odds, consensus);
  frame_.report.nis += outcome.nis;
  return outcome;
}

/// Keeps the candidates that constrain the pose, and sets their search ellipses about a given pose. Returns how many.
int Relocaliser::keep_placed(const SearchPose& about, int count) {
  int placed = 0;
  for (int i = 0; i < count; ++i) {
    if (update_.observation(i).block < 0) continue;
    const int slot = map_.features[update_.candidate(i).feature].slot;
    const Block& block = filter_.state().block[slot];
    if (block.kind == BlockKind::kInverseDepth) {
      const Scalar rho = block.inverse_depth().rho;
      if (!(rho > 0) || filter_.block_variance(slot, 2) > kMaxDepthSigma * kMaxDepthSigma * rho * rho) continue;
    }
    if (i != placed) update_.swap(placed, i);
    if (about.given) {
      const Mat26 J = pose_columns(update_.observation(placed));
      frame_.match(update_.candidate(placed).match).innovation =
          J.lazyProduct(about.P).lazyProduct(J.transpose()) + Mat2::Identity() * (kMapSigma * kMapSigma);
    }
    ++placed;
  }
  return placed;
}

/// Predictions and Jacobians of the matches at a pose far from the estimate, for an update of the estimate:
///
///   z = h(x_0) + H (x [-] x_0),   so that the prediction at the estimate is h(x_0) + H (x^ [-] x_0)
///
/// Moves the matches that can be seen from there to the front and returns how many they are.
int Relocaliser::linearise_at(const Body& pose, int found) {
  const Body estimate = filter_.state().body;
  Vec6 e;
  e << log_so3(estimate.q_WC * pose.q_WC.conjugate()), estimate.p_W - pose.p_W;
  set_pose(pose);
  int seen = 0;
  for (int i = 0; i < found; ++i) {
    PixelMeasurement& o = update_.observation(i);
    const Vec2 measured = o.measured;
    const Mat2 R = update_.candidate(i).noise;
    const int slot = o.block;
    if (!filter_.predict_pixel(filter_.lens(), slot, &o)) continue;
    o.predicted += pose_columns(o).lazyProduct(e);
    o.measured = measured;
    // The product of an uncertain baseline and an uncertain depth is gone where the baseline is proposed.
    o.set_noise(is_planar(filter_.state().block[slot].kind) ? Mat2(R + o.second_order) : R);
    if (seen != i) {
      update_.swap(seen, i);
      std::swap(searched_px2_[seen], searched_px2_[i]);
    }
    ++seen;
  }
  set_pose(estimate);
  return seen;
}

/// Of the inliers, seen from a pose; 0 without any.
Scalar Relocaliser::median_depth(const Body& pose, int found) const {
  Scalar depth[kMaxObservations];
  int count = 0;
  const Vec3 forward = pose.q_WC.toRotationMatrix().col(2);
  for (int i = 0; i < found && count < kMaxObservations; ++i)
    if (update_.keep()[i] != 0)
      depth[count++] = forward.dot(filter_.point(map_.features[update_.candidate(i).feature].slot) - pose.p_W);
  if (count == 0) return 0;
  std::nth_element(depth, depth + count / 2, depth + count);
  return depth[count / 2];
}

/// An update that knows a pose 1e7 times better leaves rounding of its covariance. Half of the digits now, at the proposal; the rest is
/// taken in with the pixels linearised again (PixelUpdate::apply; lib/docs/theory/float.md).
void Relocaliser::hold_back(int found) {
  const Scalar share = std::sqrt(std::numeric_limits<Scalar>::epsilon());
  Scalar largest = 0;
  for (int i = 0; i < found; ++i)
    if (update_.keep()[i] != 0) largest = std::max(largest, filter_.innovation_block(i, i).trace());
  for (int i = 0; i < found; ++i) update_.observation(i).hold_back(share * largest);
}

void Relocaliser::mark_matches(int found) {
  for (int i = 0; i < found; ++i) {
    Match& match = frame_.match(update_.candidate(i).match);
    match.status = update_.keep()[i] != 0 ? MatchStatus::kInlier : MatchStatus::kOutlier;
    match.nis = squared_distance(match.measured - update_.observation(i).predicted,
                                 filter_.innovation_block(i, i) + update_.observation(i).R_gate);
  }
}

}  // namespace pf
