#include "filter_slam/features/feature_search.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "belief/pose_evidence.h"
#include "frame/ellipse.h"
#include "frame/feature_upkeep.h"
#include "frame/tuning.h"
#include "geometry/symmetric_eigen.h"
#include "model/camera_at.h"

namespace pf {

bool FeatureSearch::layout(Arena& arena, int max_observations) {
  scratch_ = arena.take<Scalar>(static_cast<std::size_t>(max_observations));
  return search_.layout(arena, settings_);
}

void FeatureSearch::init() {
  search_.init(settings_);
  followed_.init();
}

/// Whether a feature has an appearance and is predicted inside of the image, and where.
bool FeatureSearch::is_visible(int feature, Vec2* pixel) const {
  const Feature& f = map_.features[feature];
  if ((f.is_target && map_.target_withdrawn) || !f.has_appearance) return false;
  PixelMeasurement o;
  if (!filter_.predict_pixel(filter_.lens(), f.slot, &o)) return false;
  *pixel = o.predicted;
  return is_in_image(settings_.camera, o.predicted, static_cast<Scalar>(settings_.border_px));
}

bool FeatureSearch::note_fixed(bool has_pose) {
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  const KnownScene scene = {{camera.q_WC, camera.p_W}, this, [](const void* self, int feature) {
                              const FeatureSearch& of = *static_cast<const FeatureSearch*>(self);
                              return of.filter_.point(of.map_.features[feature].slot);
                            }};
  return search_.note_fixed(filter_.lens(), has_pose ? &scene : nullptr, &frame_, &map_.features);
}

/// How reliable a feature is; negative where this view cannot be compared with its first.
float FeatureSearch::rate(int feature, const Vec2& pixel) const {
  const Feature& f = map_.features[feature];
  const float rate = reliability(f);
  SearchTask task = task_of(feature);
  task.predicted = pixel;
  return search_.tracker().is_comparable(task) ? rate : rate - tuning::image_front_end::kIncomparable;
}

/// A full list keeps the best, and the scouts are the best. What cannot be compared comes last: it would fill the list in place of what
/// was added instead.
int FeatureSearch::list_visible() {
  Scalar* rates = scratch_;
  int count = 0;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    Vec2 pixel;
    if (!map_.features.used(i) || !is_visible(i, &pixel)) continue;
    const Scalar mine = static_cast<Scalar>(rate(i, pixel));
    int at = count;
    if (count == settings_.max_observations) {
      if (rates[count - 1] >= mine) continue;
      at = count - 1;
    } else {
      ++count;
    }
    for (; at > 0 && rates[at - 1] < mine; --at) {
      update_.candidate(at) = update_.candidate(at - 1);
      rates[at] = rates[at - 1];
    }
    update_.candidate(at).feature = i;
    rates[at] = mine;
  }
  for (int i = 0; i < count; ++i) {
    Candidate& candidate = update_.candidate(i);
    const Feature& f = map_.features[candidate.feature];
    candidate.match = frame_.add({candidate.feature, f.id, MatchStatus::kMissed, filter_.state().block[f.slot].kind,
                                  false, false, Vec2::Zero(), Mat2::Zero(), Vec2::Zero(), Scalar(0)});
  }
  return count;
}

void FeatureSearch::predict_pixels(int first, int count) {
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

int FeatureSearch::search(int first, int count, const SearchMode& mode) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  int found = first;
  for (int i = first; i < first + count; ++i) {
    PixelMeasurement& o = update_.observation(i);
    if (o.block < 0) continue;
    Match& match = frame_.match(update_.candidate(i).match);
    SearchTask task = task_of(update_.candidate(i).feature);
    task.predicted = o.predicted;
    task.innovation = match.innovation;
    if (mode.follows && !aim(&task)) continue;
    const SearchOutcome outcome = search_.search(task);
    if (!outcome.comparable) continue;
    match.searched = true;
    ++frame_.report.attempts;
    if (!outcome.found || squared_distance(outcome.pixel - o.predicted, match.innovation) > settings_.gate) continue;
    ++frame_.report.matches;
    match.measured = outcome.pixel;
    match.status = MatchStatus::kOutlier;  // until the consensus has it as an inlier
    o.measured = outcome.pixel;
    const Scalar nis = squared_distance(outcome.pixel - task.predicted, task.innovation);
    update_.candidate(i).log_density = log_normal_density(nis, std::log(task.innovation.determinant()), 1);
    noise_.set(i, outcome, mode.parallax_lasts);
    if (found != i) update_.swap(found, i);
    ++found;
  }
  return found - first;
}

/// What the tracker needs to search for a feature, but for where it is predicted.
SearchTask FeatureSearch::task_of(int feature) const {
  const int slot = map_.features[feature].slot;
  const State& state = filter_.state();
  SearchTask task;
  task.appearance = &map_.appearance(feature);
  task.first_view = map_.first_view(feature);
  // Where a surface is in other images needs its depth. The target is matched as without masks (lib/docs/theory/templates.md).
  if (map_.has_templates() && !map_.features[feature].is_target && !state.has_inverse_depth(slot))
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

/// Directs a search to where the followed view has the feature, unless its own ellipse is as small. False where the followed view has no
/// place for it.
bool FeatureSearch::aim(SearchTask* task) const {
  return !is_wide(task->innovation) || followed_.aim(filter_.lens(), task->p_W, task);
}

/// Whether a search ellipse is several times as large as that about a followed pixel.
bool FeatureSearch::is_wide(const Mat2& innovation) const {
  return FollowedView::is_wide(filter_.lens(), innovation, settings_.gate);
}

Scalar FeatureSearch::widest_ellipse(int count) const {
  Scalar widest = 0;
  for (int i = 0; i < count; ++i) {
    const Mat2& S = frame_.match(update_.candidate(i).match).innovation;
    widest = std::max(widest, std::sqrt(settings_.gate * symmetric_eigenvalues(S)(1)));
  }
  return widest;
}

Scalar FeatureSearch::searched_area(int i, bool follows) const {
  const Mat2& S = frame_.match(update_.candidate(i).match).innovation;
  Scalar most = static_cast<Scalar>(settings_.camera.width) * static_cast<Scalar>(settings_.camera.height);
  if (follows && is_wide(S)) most = ellipse_area(FollowedView::covariance(filter_.lens()), settings_.gate);
  return std::min(most, ellipse_area(S, settings_.gate));
}

const Scalar* FeatureSearch::searched_areas(int first, int count, bool follows) {
  for (int i = 0; i < count; ++i) scratch_[i] = searched_area(first + i, follows);
  return scratch_;
}

bool FeatureSearch::find_followed(int count) {
  int wide = 0;
  for (int i = 0; i < count; ++i) wide += is_wide(frame_.match(update_.candidate(i).match).innovation) ? 1 : 0;
  if (wide == 0 || tuning::image_front_end::kMinWide * wide < count) return false;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  return followed_.find(filter_.lens(), search_.tracker().pyramid());
}

/// With the pose after the update, and where the features were found.
void FeatureSearch::learn_templates(int count) {
  if (!search_.has_templates()) return;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kTemplate]);
  for (int i = 0; i < count; ++i) {
    const Candidate& candidate = update_.candidate(i);
    const Match& match = frame_.match(candidate.match);
    if (match.status != MatchStatus::kInlier || match.feature < 0) continue;
    SearchTask task = task_of(candidate.feature);
    task.predicted = match.measured;
    if (!search_.learn(task, match.measured, &map_, candidate.feature)) continue;
    const PlanarTemplate& shape = map_.shape(candidate.feature);
    ++frame_.report.templates;
    frame_.report.template_area += shape.area / static_cast<float>(shape.side * shape.side);
  }
}

}  // namespace pf
