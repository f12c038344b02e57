#include "keyframe_slam/tracking/point_search.h"

#include <algorithm>

#include "base/elapsed.h"
#include "frame/ellipse.h"
#include "frame/feature_upkeep.h"
#include "geometry/symmetric_eigen.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {

using namespace tuning::keyframe_tracking;

namespace {

Mat2 innovation_of(const ExpectedPixel& expected) {
  return expected.spread + Mat2::Identity() * (kMapSigma * kMapSigma);
}

}  // namespace

bool PointSearch::layout(Arena& arena) {
  point_ = arena.take<SearchedPoint>(static_cast<std::size_t>(settings_.max_features));
  return images_.layout(arena, settings_);
}

void PointSearch::init() {
  images_.init(settings_);
  followed_.init();
  placed_ = 0;
}

bool PointSearch::begin_frame(const ImageView* image) {
  placed_ = 0;
  return image == nullptr || images_.begin_frame(*image);
}

bool PointSearch::note_fixed(const CameraView& view) {
  if (given_.are_given()) return false;
  const KnownScene scene = {view, &map_,
                            [](const void* map, int i) { return static_cast<const KeyframeMap*>(map)->position(i); }};
  return images_.note_fixed(map_.camera(), frame_.report.inliers > 0 ? &scene : nullptr, &frame_,
                            &map_.tables().features);
}

int PointSearch::list_placed(const PosePrior& at) {
  placed_ = 0;
  return placed_ = list(at, true, Scalar(1));
}

int PointSearch::list_unplaced(const PosePrior& at, Scalar depth) { return list(at, false, depth); }

int PointSearch::list(const PosePrior& at, bool placed, Scalar depth) {
  const int first = placed_;
  int count = 0;
  for (int i = 0; i < map_.capacity() && first + count < map_.capacity() && !frame_.full(); ++i) {
    if (!map_.used(i) || map_.point(i).has_depth != placed) continue;
    const Feature& f = map_.feature(i);
    ExpectedPixel expected;
    const bool can_be_found = given_.are_given() ? given_.of(i) != nullptr : f.has_appearance;
    if (!can_be_found || (f.is_target && map_.tables().target_withdrawn)) continue;
    if (!(placed ? expect_placed(map_, i, at, &expected) : expect_unplaced(map_, i, at, depth, &expected))) continue;
    const Mat2 innovation = innovation_of(expected);
    const bool is_inside = is_in_image(settings_.camera, expected.pixel, static_cast<Scalar>(settings_.border_px));
    if (!is_inside || !is_covariance(innovation)) continue;
    const int match = frame_.add({i, f.id, MatchStatus::kMissed, map_.kind(i), false, false, expected.pixel, innovation,
                                  Vec2::Zero(), Scalar(0)});
    point_[first + count++] = {match, Mat2::Identity(), Scalar(0)};
  }
  std::sort(point_ + first, point_ + first + count, [&](const SearchedPoint& a, const SearchedPoint& b) {
    const Match &m = frame_.match(a.match), &n = frame_.match(b.match);
    const float of_a = reliability(map_.feature(m.feature)), of_b = reliability(map_.feature(n.feature));
    return of_a != of_b ? of_a > of_b : m.feature < n.feature;
  });
  return count;
}

void PointSearch::predict_again(int first, int count, const PosePrior& at) {
  for (int c = first; c < first + count; ++c) {
    ExpectedPixel expected;
    if (!expect_placed(map_, match(c).feature, at, &expected)) continue;
    const Mat2 innovation = innovation_of(expected);
    if (!is_covariance(innovation)) continue;
    match(c).predicted = expected.pixel;
    match(c).innovation = innovation;
  }
}

Scalar PointSearch::widest(int count) const {
  Scalar widest = 0;
  for (int c = 0; c < count; ++c) widest = std::max(widest, symmetric_eigenvalues(match(c).innovation)(1));
  return widest;
}

SearchTask PointSearch::task_of(int i, const PosePrior& at, Scalar depth) const {
  const KeyframePoint& point = map_.point(i);
  const Map& tables = map_.tables();
  const Keyframe& host = map_.keyframes[point.host];
  SearchTask task;
  task.appearance = &tables.appearance(i);
  task.first_view = point.faces_host ? host.view() : tables.first_view(i);
  if (tables.has_templates() && !tables.features[i].is_target && point.has_depth)
    ImageSearch::use_template(tables, i, &task);
  task.gate = settings_.gate;
  task.p_W = host.p_W + map_.ray_W(i) * (point.has_depth ? 1 / point.rho : depth);
  if (tables.features[i].is_target)
    task.normal_W = tables.target_normal_W;
  else if (point.has_depth && point.plane >= 0)
    task.normal_W = planes_.plane(point.plane).frame.R_WP.col(2);
  task.q_WC = at.q_WC;
  task.c_W = at.p_W;
  return task;
}

/// Whether a point of the list is found. A pixel that the caller gives is the point's wherever it is.
bool PointSearch::find(int c, const PosePrior& at, Scalar depth) {
  Match& match = frame_.match(point_[c].match);
  if (given_.are_given()) {
    const PixelObservation& pixel = *given_.of(match.feature);
    ++frame_.report.attempts;
    match.measured = pixel.pixel;
    point_[c].noise = Mat2::Identity() * (pixel.sigma_px * pixel.sigma_px);
    point_[c].searched = ellipse_area(match.innovation, settings_.gate);
    return true;
  }
  SearchTask task = task_of(match.feature, at, depth);
  task.predicted = match.predicted;
  task.innovation = match.innovation;
  if (settings_.gate * symmetric_eigenvalues(match.innovation)(1) > kTemplateEllipse * kTemplateEllipse)
    task.shape = nullptr;
  if (at.follows && !aim(match.feature, &task)) return false;
  const SearchOutcome outcome = images_.search(task);
  if (!outcome.comparable) return false;
  if (!match.searched) ++frame_.report.attempts;
  match.searched = true;
  if (!outcome.found || squared_distance(outcome.pixel - match.predicted, match.innovation) > settings_.gate)
    return false;
  match.measured = outcome.pixel;
  point_[c].noise = noise_.match(outcome.noise, outcome.level_scale);
  point_[c].searched = ellipse_area(task.innovation, settings_.gate);
  return true;
}

int PointSearch::forget_others(int found, const unsigned char* is_kept) {
  int kept = 0;
  for (int c = 0; c < found; ++c) {
    if (is_kept[c] != 0) {
      std::swap(point_[kept++], point_[c]);
      continue;
    }
    match(c).status = MatchStatus::kMissed;
    --frame_.report.matches;
  }
  return kept;
}

int PointSearch::search(int found, int first, int count, const PosePrior& at, Scalar depth) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  const Scalar image = static_cast<Scalar>(settings_.camera.width) * static_cast<Scalar>(settings_.camera.height);
  for (int c = first; c < first + count; ++c) {
    if (!find(c, at, depth)) continue;
    Match& match = frame_.match(point_[c].match);
    ++frame_.report.matches;
    match.status = MatchStatus::kOutlier;  // until the consensus has it as an inlier
    point_[c].searched = std::min(image, point_[c].searched);
    std::swap(point_[found++], point_[c]);
  }
  return found;
}

bool PointSearch::find_followed() {
  if (given_.are_given()) return false;
  int wide = 0;
  for (int t = 0; t < frame_.match_count(); ++t)
    wide += FollowedView::is_wide(map_.camera(), frame_.match(t).innovation, settings_.gate) ? 1 : 0;
  if (wide == 0 || tuning::image_front_end::kMinWide * wide < frame_.match_count()) return false;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  return followed_.find(map_.camera(), images_.tracker().pyramid());
}

/// Directs a search to where the followed view has the point, unless its own ellipse is as small. False where the followed view has no
/// place for it.
bool PointSearch::aim(int i, SearchTask* task) const {
  if (!FollowedView::is_wide(map_.camera(), task->innovation, settings_.gate)) return true;
  const KeyframePoint& point = map_.point(i);
  Vec3 at_W = task->p_W;
  if (!point.has_depth) {
    Vec3 ray_C;
    if (!unproject(map_.camera(), point.pixel, &ray_C)) return false;
    at_W = followed_.p_W() + point.seen_from.q_WC * ray_C;
  }
  return followed_.aim(map_.camera(), at_W, task);
}

void PointSearch::learn_templates(const PosePrior& at) {
  if (!images_.has_templates() || given_.are_given()) return;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kTemplate]);
  for (int c = 0; c < placed_; ++c) {
    const Match& match = frame_.match(point_[c].match);
    if (match.status != MatchStatus::kInlier || match.feature < 0) continue;
    SearchTask task = task_of(match.feature, at, Scalar(1));
    task.predicted = match.measured;
    if (!images_.learn(task, match.measured, &map_.tables(), match.feature)) continue;
    const PlanarTemplate& shape = map_.tables().shape(match.feature);
    ++frame_.report.templates;
    frame_.report.template_area += shape.area / static_cast<float>(shape.side * shape.side);
  }
}

}  // namespace pf
