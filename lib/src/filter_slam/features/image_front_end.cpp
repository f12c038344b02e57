#include "filter_slam/features/image_front_end.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter_slam/pose/consensus.h"
#include "filter_slam/pose/triple_consensus.h"
#include "frame/tracking_state.h"
#include "frame/tuning.h"
#include "geometry/symmetric_eigen.h"
#include "model/camera_at.h"

namespace pf {
namespace {

using namespace tuning::image_front_end;

}  // namespace

bool ImageFrontEnd::layout(Arena& arena, int max_observations) {
  scratch_ = arena.take<Scalar>(static_cast<std::size_t>(max_observations));
  return search_.layout(arena, settings_);
}

void ImageFrontEnd::init() {
  search_.init(settings_);
  same_view_.init();
  followed_.init();
}

bool ImageFrontEnd::begin_frame(const ImageView& image) {
  is_measured_ = false;
  return search_.begin_frame(image);
}

void ImageFrontEnd::measure(ConsensusRule rule, Scalar median_depth, bool parallax_lasts) {
  parallax_lasts_ = parallax_lasts;
  is_learnt_ = rule != ConsensusRule::kStart && same_view_.is_learnt(filter_.state().body, median_depth,
                                                                     settings_.camera.fx, noise_.correlation_frames());
  filter_.estimate_motion_only(is_learnt_);
  measure_visible(rule, rule == ConsensusRule::kStart);
  const bool followed = is_following_;
  if (frame_.report.inliers == 0 && (followed || begin_following())) {
    is_following_ = !followed;
    measure_visible(rule, false);
  }
  is_following_ = false;
  filter_.estimate_motion_only(false);
}

/// Where no consensus came about and the prediction is vague, searches go once more, about the places where the picture as a whole has
/// gone. A match still has to pass the gate about its prediction: following says where to look, and the filter what to believe.
bool ImageFrontEnd::begin_following() {
  int wide = 0;
  for (int i = 0; i < listed_; ++i) wide += is_wide(frame_.match(update_.candidate(i).match).innovation) ? 1 : 0;
  if (wide == 0 || 2 * wide < listed_) return false;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  is_following_ = followed_.find(filter_.lens(), search_.tracker().pyramid());
  return is_following_;
}

/// If the pose is uncertain, a few candidates are measured first. If their consensus is too weak, all candidates are searched before
/// anything is used. follows: where few of those first ones are found, searches go about the places where the picture as a whole has gone.
void ImageFrontEnd::measure_visible(ConsensusRule rule, bool follows) {
  frame_.forget_searches();
  const int count = list_visible();
  listed_ = count;
  is_measured_ = true;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
    predict_pixels(0, count);
  }
  const int scouts = widest_ellipse(count) > kWideEllipse && count > kScouts ? kScouts : 0;
  int found = search(0, scouts > 0 ? scouts : count);
  if (follows && Scalar(found) < kFewFound * Scalar(frame_.report.attempts) && begin_following())
    return measure_visible(rule, false);
  if (scouts > 0) {
    const bool scouted = update_with_consensus(0, found, rule);
    if (scouted) {
      StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
      predict_pixels(scouts, count - scouts);
    }
    const int more = search(scouts, count - scouts);
    if (scouted) {
      update_with_consensus(scouts, more, rule);
      return;
    }
    for (int k = 0; k < more; ++k, ++found)
      if (found != scouts + k) update_.swap(found, scouts + k);
  }
  update_with_consensus(0, found, rule);
}

bool ImageFrontEnd::remember(int feature, const Vec2& pixel, const CameraView& view) {
  return search_.remember(&map_, feature, pixel, view);
}

void ImageFrontEnd::predict_pixels(int first, int count) {
  for (int i = first; i < first + count; ++i) {
    const Candidate& candidate = update_.candidate(i);
    PixelMeasurement& o = update_.observation(i);
    Match& match = frame_.match(candidate.match);
    update_.keep()[i] = 0;
    bool has_place = filter_.predict_pixel(filter_.lens(), map_.features[candidate.feature].slot, &o);
    if (has_place) {
      const Mat2 spread = update_.expected_innovation(&o);
      o.set_noise(NoiseModel::search() + o.second_order);
      match.feature = candidate.feature;  // it may have had no place before the scouts were measured
      match.predicted = o.predicted;
      match.innovation = spread + o.R_gate;
      has_place = is_covariance(match.innovation);
    }
    if (!has_place) {
      o.block = -1;
      match.feature = -1;
      match.predicted.setZero();
      match.innovation.setZero();
    }
  }
}

/// Largest semi-axis of the gates [px].
Scalar ImageFrontEnd::widest_ellipse(int count) const {
  Scalar widest = 0;
  for (int i = 0; i < count; ++i) {
    const Mat2& S = frame_.match(update_.candidate(i).match).innovation;
    widest = std::max(widest, std::sqrt(settings_.gate * symmetric_eigenvalues(S)(1)));
  }
  return widest;
}

/// Whether a search ellipse is several times as large as that about a followed pixel.
bool ImageFrontEnd::is_wide(const Mat2& innovation) const {
  return FollowedView::is_wide(filter_.lens(), innovation, settings_.gate);
}

/// Directs a search to where the followed view has the feature, unless its own ellipse says as much. False where that has no place for it.
bool ImageFrontEnd::aim(SearchTask* task) const {
  return !is_following_ || !is_wide(task->innovation) || followed_.aim(filter_.lens(), task->p_W, task);
}

/// What the tracker needs to search for a feature, but for where it is predicted.
SearchTask ImageFrontEnd::task_of(int feature) const {
  const int slot = map_.features[feature].slot;
  const State& state = filter_.state();
  SearchTask task;
  task.appearance = &map_.appearance(feature);
  task.first_view = map_.first_view(feature);
  // Where a surface is in other images needs its depth. The target is matched as without masks (lib/docs/templates.md).
  if (map_.has_templates() && !map_.features[feature].is_target && state.block[slot].kind != BlockKind::kInverseDepth)
    ImageSearch::use_template(map_, feature, &task);
  task.gate = settings_.gate;
  task.p_W = filter_.point(slot);
  if (is_planar(state.block[slot].kind)) {
    const Block& plane = state.block[state.plane_of(slot)];
    Scalar d;
    plane_normal(state.frame_of(plane), plane.xyz(), &task.normal_W, &d);
  } else if (map_.features[feature].is_target) {
    task.normal_W = map_.target_normal_W;
  }
  const CameraAt camera = camera_at(state, Scalar(0));
  task.q_WC = camera.q_WC;
  task.c_W = camera.p_W;
  return task;
}

int ImageFrontEnd::search(int first, int count) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  int found = first;
  for (int i = first; i < first + count; ++i) {
    PixelMeasurement& o = update_.observation(i);
    if (o.block < 0) continue;
    Match& match = frame_.match(update_.candidate(i).match);
    SearchTask task = task_of(update_.candidate(i).feature);
    task.predicted = o.predicted;
    task.innovation = match.innovation;
    if (!aim(&task)) continue;
    const SearchOutcome outcome = search_.search(task);
    if (!outcome.comparable) continue;
    match.searched = true;
    ++frame_.report.attempts;
    if (!outcome.found || squared_distance(outcome.pixel - o.predicted, match.innovation) > settings_.gate) continue;
    ++frame_.report.matches;
    match.measured = outcome.pixel;
    match.status = MatchStatus::kOutlier;  // until the consensus says otherwise
    o.measured = outcome.pixel;
    const Mat2 noise = noise_.match(outcome.noise, outcome.level_scale);
    update_.candidate(i).noise = noise;
    o.set_noises(noise + o.second_order, update_noise(map_.features[update_.candidate(i).feature], o, noise));
    if (found != i) update_.swap(found, i);
    ++found;
  }
  return found - first;
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
  if (searched >= settings_.min_inliers) return 2 * agree >= searched;
  const int inliers = static_cast<int>(std::count(update_.keep() + first, update_.keep() + first + found, 1));
  return 2 * inliers >= frame_.report.attempts;
}

/// Whether chance would hardly let as many matches agree as keep says.
bool ImageFrontEnd::is_beyond_chance(int first, int found, ConsensusRule rule) {
  for (int i = 0; i < found; ++i) scratch_[i] = searched_area(first + i);
  const auto is_beyond = [&](int levels) {
    return find_triple_consensus(filter_, update_.observations() + first, scratch_, found, frame_.report.attempts,
                                 settings_.gate, tuning::tracking::kTriples, levels, update_.keep() + first, nullptr)
               .log_false < tuning::tracking::kMaxLogFalse;
  };
  return is_beyond(1) || (rule == ConsensusRule::kFollowed && is_beyond(tuning::chance::kLevels));
}

Scalar ImageFrontEnd::searched_area(int i) const {
  const Mat2& S = frame_.match(update_.candidate(i).match).innovation;
  Scalar most = static_cast<Scalar>(settings_.camera.width) * static_cast<Scalar>(settings_.camera.height);
  if (is_following_ && is_wide(S)) most = ellipse_area(FollowedView::covariance(filter_.lens()), settings_.gate);
  return std::min(most, ellipse_area(S, settings_.gate));
}

/// Whether a feature's matches add up to coordinates that are averaged over frames, so that errors which stay with the feature count. The
/// target's coordinates are given, and an inverse depth has been seen from about its first view only, which its matches are compared with.
bool ImageFrontEnd::is_averaged(const Feature& f) const {
  return !f.is_target && filter_.state().block[f.slot].kind != BlockKind::kInverseDepth;
}

/// R_update of a match with this noise, without bend. What the linearisation leaves out is new in each frame, but for the product of an
/// open depth and a baseline that is wrong for as long: where that lasts, it counts twice (lib/docs/lens.md).
Mat2 ImageFrontEnd::update_noise(const Feature& f, const PixelMeasurement& o, const Mat2& noise) const {
  Mat2 R = (is_averaged(f) ? noise_.correlation_frames() : Scalar(1)) * noise + o.second_order;
  if (parallax_lasts_ && filter_.state().block[f.slot].kind == BlockKind::kInverseDepth) R += o.second_order;
  return R;
}

void ImageFrontEnd::learn_noise() {
  if (is_learnt_) return;  // the same errors once more
  for (int i = 0; i < listed_; ++i) {
    const Candidate& candidate = update_.candidate(i);
    if (update_.keep()[i] == 0 || frame_.match(candidate.match).status != MatchStatus::kInlier) continue;
    Feature& f = map_.features[candidate.feature];
    PixelMeasurement now;
    if (f.observations < kSettled || !filter_.predict_pixel(filter_.lens(), f.slot, &now)) continue;
    const bool averaged = is_averaged(f);
    const Scalar correlation = averaged ? noise_.correlation_frames() : Scalar(1);
    const Scalar leverage = filter_.innovation(now).trace() / (correlation * candidate.noise.trace());
    noise_.learn(frame_.report.frames, update_.observation(i).measured - now.predicted, candidate.noise, leverage,
                 averaged ? &f.residuals : nullptr);
  }
  noise_.end_frame();
}

}  // namespace pf
