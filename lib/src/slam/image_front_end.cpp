#include "slam/image_front_end.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "geometry/symmetric_eigen.h"
#include "slam/consensus.h"

namespace pf {
namespace {

constexpr int kScouts = 12;                 ///< candidates that are measured first when the pose is uncertain
constexpr Scalar kWideEllipse = Scalar(6);  ///< [px] largest semi-axis above which scouts are measured first
constexpr int kMinConsensus = 5;            ///< inliers that a consensus needs

}  // namespace

bool ImageFrontEnd::layout(Arena& arena, int width, int height) { return tracker_.layout(arena, width, height); }

void ImageFrontEnd::measure() {
  const int count = list_visible();
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
    predict_pixels(0, count);
  }
  const int scouts = widest_ellipse(count) > kWideEllipse && count > kScouts ? kScouts : 0;
  if (scouts > 0) {
    measure_range(0, scouts);
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
    predict_pixels(scouts, count - scouts);
  }
  measure_range(scouts, count - scouts);
}

bool ImageFrontEnd::remember(int feature, const Vec2& pixel, const CameraView& view) {
  Feature& f = map_.features[feature];
  f.has_appearance = tracker_.remember(pixel, &map_.appearance(feature));
  map_.first_view(feature) = view;
  return f.has_appearance;
}

/// Whether a feature can be searched for and is predicted inside of the image.
bool ImageFrontEnd::is_visible(int feature) const {
  const Feature& f = map_.features[feature];
  if ((f.is_target && map_.target_withdrawn) || !f.has_appearance) return false;
  PixelMeasurement o;
  if (!filter_.predict_pixel(settings_.camera, f.slot, &o)) return false;
  const Scalar margin = static_cast<Scalar>(settings_.border_px);
  return !(o.predicted.x() < margin || o.predicted.y() < margin ||
           o.predicted.x() > static_cast<Scalar>(settings_.camera.width - 1) - margin ||
           o.predicted.y() > static_cast<Scalar>(settings_.camera.height - 1) - margin);
}

/// Lists visible features as candidates and matches, the most reliable first. Returns how many.
int ImageFrontEnd::list_visible() {
  const auto rate = [&](int feature) {
    const Feature& f = map_.features[feature];
    const int rated = std::min(f.observations, 20);
    return static_cast<float>(rated) * static_cast<float>(f.observations + 1) / static_cast<float>(f.attempts + 1);
  };
  int count = 0;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!map_.features.used(i) || !is_visible(i)) continue;
    // Sorted by success rate, so that a full list keeps the best and the scouts are the best.
    const float mine = rate(i);
    int at = count;
    if (count == settings_.max_observations) {
      if (rate(update_.candidate(count - 1).feature) >= mine) continue;
      at = count - 1;
    } else {
      ++count;
    }
    for (; at > 0 && rate(update_.candidate(at - 1).feature) < mine; --at)
      update_.candidate(at) = update_.candidate(at - 1);
    update_.candidate(at).feature = i;
  }
  for (int i = 0; i < count; ++i) {
    Candidate& candidate = update_.candidate(i);
    const Feature& f = map_.features[candidate.feature];
    candidate.match = frame_.add({candidate.feature, f.id, MatchStatus::kMissed, filter_.state().block[f.slot].kind,
                                  Vec2::Zero(), Mat2::Zero(), Vec2::Zero(), Scalar(0)});
  }
  return count;
}

/// Predicts pixel and search ellipse of candidates.
void ImageFrontEnd::predict_pixels(int first, int count) {
  for (int i = first; i < first + count; ++i) {
    const Candidate& candidate = update_.candidate(i);
    PixelMeasurement& o = update_.observation(i);
    Match& match = frame_.match(candidate.match);
    update_.keep()[i] = 0;
    bool has_place = filter_.predict_pixel(settings_.camera, map_.features[candidate.feature].slot, &o);
    if (has_place) {
      const Mat2 spread = update_.expected_innovation(&o);
      o.set_noise(Mat2::Identity() * (Tracker::kTypicalSigma * Tracker::kTypicalSigma) + o.second_order);
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

/// What the tracker needs to search for a candidate.
SearchTask ImageFrontEnd::task_of(int i) const {
  const Candidate& candidate = update_.candidate(i);
  const int slot = map_.features[candidate.feature].slot;
  const State& state = filter_.state();
  SearchTask task;
  task.appearance = &map_.appearance(candidate.feature);
  task.first_view = map_.first_view(candidate.feature);
  task.predicted = update_.observation(i).predicted;
  task.innovation = frame_.match(candidate.match).innovation;
  task.gate = settings_.gate;
  task.p_W = filter_.point(slot);
  if (is_planar(state.block[slot].kind)) {
    const Block& plane = state.block[state.plane_of(slot)];
    Scalar d;
    plane_normal(state.frame_of(plane), plane.xyz(), &task.normal_W, &d);
  }
  task.q_WC = state.body.q_WC;
  task.c_W = state.body.p_W;
  return task;
}

/// Searches for candidates, and moves those that are found to the front of their range. Returns how many.
int ImageFrontEnd::search(int first, int count) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  int found = first;
  for (int i = first; i < first + count; ++i) {
    PixelMeasurement& o = update_.observation(i);
    if (o.block < 0) continue;
    Feature& f = map_.features[update_.candidate(i).feature];
    Match& match = frame_.match(update_.candidate(i).match);
    const SearchOutcome outcome = tracker_.search(task_of(i));
    if (!outcome.comparable) continue;
    count_frame(&f.attempts);
    ++frame_.report.attempts;
    if (!outcome.found || squared_distance(outcome.pixel - o.predicted, match.innovation) > settings_.gate) {
      count_frame(&f.failures);
      continue;
    }
    ++frame_.report.matches;
    match.measured = outcome.pixel;
    match.status = MatchStatus::kOutlier;  // until the consensus says otherwise
    o.measured = outcome.pixel;
    const Scalar floor = settings_.sigma_px * outcome.level_scale;
    o.set_noise(Mat2::Identity() * (floor * floor) + outcome.noise + o.second_order);
    if (found != i) update_.move(i, found);
    ++found;
  }
  return found - first;
}

/// Searches for a range of candidates, finds their consensus, and updates the filter.
void ImageFrontEnd::measure_range(int first, int count) {
  const int found = search(first, count);
  if (found == 0) return;
  update_.begin(first, found);
  unsigned char* keep = update_.keep();
  int inliers;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
    inliers = find_inliers(filter_, update_.observations() + first, found, settings_.gate, keep + first);
  }
  // If an earlier range has given inliers, a smaller consensus is accepted.
  const bool accepted =
      frame_.report.inliers >= kMinConsensus || inliers >= std::min(kMinConsensus, map_.features.count());
  for (int i = first; i < first + found; ++i) {
    const PixelMeasurement& o = update_.observation(i);
    if (!accepted) keep[i] = 0;
    Match& match = frame_.match(update_.candidate(i).match);
    match.status = keep[i] != 0 ? MatchStatus::kInlier : MatchStatus::kOutlier;
    match.nis =
        squared_distance(match.measured - o.predicted, filter_.innovation_block(i - first, i - first) + o.R_gate);
    if (keep[i] == 0) {
      Feature& f = map_.features[update_.candidate(i).feature];
      count_frame(&f.failures);
      if (accepted) count_frame(&f.rejections);
    }
  }
  if (accepted) update_.apply(first, found);
}

}  // namespace pf
