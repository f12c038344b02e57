#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "geometry/symmetric_eigen.h"
#include "slam/consensus.h"
#include "slam/filter_slam.h"

/// The order of work for an image.

namespace pf {
namespace {

constexpr int kScouts = 12;                 ///< features that are searched first when little is known of the motion
constexpr Scalar kWideEllipse = Scalar(6);  ///< [px] semi-axis from which scouts go first
constexpr int kLeastAgreement = 5;          ///< matches that must agree before they are believed
constexpr int kCornerThreshold = 8;         ///< of the segment test [grey]
constexpr float kLeastCorner = 12.0f;       ///< smaller eigenvalue of the gradients [grey^2/px^2]
constexpr Scalar kReferenceSigma = Scalar(0.25);  ///< [px] of the first sight, which every later match is compared with
constexpr int kCellColumns = 8, kCellRows = 6;
constexpr int kFewNew = 4;  ///< new features come in groups that share an anchor

}  // namespace

Status FilterSlam::push_frame(const ImageView& image, std::int64_t t_ns) {
  if (!begin_frame(t_ns)) return Status::kTime;
  if (tracking_.gave_up()) return end_frame();
  bool usable;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPyramid]);
    usable = tracker_.begin_frame(image);
  }
  if (!usable) {
    const Status status = end_frame();
    return status == Status::kLost || status == Status::kStarting ? status : Status::kUnusable;
  }

  if (!tracking_.has_pose()) {
    if (!start_in_image()) return end_frame();
  } else {
    const int count = list_visible();
    {
      StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
      predict_pixels(0, count);
    }
    const int scouts = widest_ellipse(count) > kWideEllipse && count > kScouts ? kScouts : 0;
    if (scouts > 0) {
      measure(0, scouts);
      StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
      predict_pixels(scouts, count - scouts);
    }
    measure(scouts, count - scouts);
  }

  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kMap]);
    convert_what_is_linear();
    tend_planes();
    drop_what_fails();
    if (start_.recording) record_frame();
    if (tracking_.carried(frame_.report) || frame_.report.attempts == 0) begin_features_in_image();
    if (start_.recording && record_.features() == 0) begin_record();
  }
  return end_frame();
}

/// Features that should be in the image go into observation_ and entry_, the most reliable first. Returns how many.
int FilterSlam::list_visible() {
  int count = 0;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!map_.features.used(i)) continue;
    const Feature& f = map_.features[i];
    if (f.is_target && map_.target_withdrawn) continue;
    if (f.appearance < 0) continue;
    Observation o;
    if (!filter_.predict_pixel(settings_.camera, f.slot, &o)) continue;
    const Scalar margin = static_cast<Scalar>(settings_.border_px);
    if (o.predicted.x() < margin || o.predicted.y() < margin ||
        o.predicted.x() > static_cast<Scalar>(settings_.camera.width - 1) - margin ||
        o.predicted.y() > static_cast<Scalar>(settings_.camera.height - 1) - margin)
      continue;
    // Insertion by success rate, so that a full list keeps the best and the scouts are good ones.
    const auto rate = [&](int entry) {
      const Feature& g = map_.features[entry];
      const int rated = std::min(g.observations, 20);
      return static_cast<float>(rated) * static_cast<float>(g.observations + 1) / static_cast<float>(g.attempts + 1);
    };
    const float mine = rate(i);
    int at = count;
    if (count == settings_.max_observations) {
      if (rate(entry_[count - 1]) >= mine) continue;
      at = count - 1;
    } else {
      ++count;
    }
    for (; at > 0 && rate(entry_[at - 1]) < mine; --at) entry_[at] = entry_[at - 1];
    entry_[at] = i;
  }
  for (int i = 0; i < count; ++i) {
    const Feature& f = map_.features[entry_[i]];
    track_of_[i] = frame_.add({entry_[i], f.id, MatchStatus::kMissed, filter_.state().block[f.slot].kind, Vec2::Zero(),
                               Mat2::Zero(), Vec2::Zero(), Scalar(0)});
  }
  return count;
}

/// Where to look, and the ellipse, for listed features.
void FilterSlam::predict_pixels(int first, int count) {
  for (int i = first; i < first + count; ++i) {
    Observation& o = observation_[i];
    Match& match = frame_.match(track_of_[i]);
    keep_[i] = 0;
    if (!filter_.predict_pixel(settings_.camera, map_.features[entry_[i]].slot, &o)) {
      o.slot = -1;
      match.feature = -1;  // stands nowhere in the image
      match.predicted.setZero();
      match.innovation.setZero();
      continue;
    }
    const Mat2 spread = expected_innovation(&o);
    o.noise = Mat2::Identity() * (Tracker::kTypicalSigma * Tracker::kTypicalSigma) + o.second_order;
    match.predicted = o.predicted;
    match.innovation = spread + o.noise;
  }
}

/// Largest semi-axis of the gates [px].
Scalar FilterSlam::widest_ellipse(int count) const {
  Scalar widest = 0;
  for (int i = 0; i < count; ++i) {
    const Mat2& S = frame_.match(track_of_[i]).innovation;
    widest = std::max(widest, std::sqrt(settings_.gate * symmetric_eigenvalues(S)(1)));
  }
  return widest;
}

/// Looks for listed features; those that are found move to the front of their range. Returns how many.
int FilterSlam::search(int first, int count) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  int found = first;
  const Body& body = filter_.state().body;
  for (int i = first; i < first + count; ++i) {
    if (observation_[i].slot < 0) continue;
    Feature& f = map_.features[entry_[i]];
    Match& match = frame_.match(track_of_[i]);
    SearchTask task;
    task.appearance = f.appearance;
    task.predicted = observation_[i].predicted;
    task.innovation = match.innovation;
    task.gate = settings_.gate;
    task.p_W = filter_.point(f.slot);
    if (is_planar(filter_.state().block[f.slot].kind)) {
      const State& state = filter_.state();
      const Block& plane = state.block[state.plane_of(f.slot)];
      Scalar d;
      plane_normal(state.frame_of(plane), plane.xyz(), &task.normal_W, &d);
    }
    task.q_WC = body.q_WC;
    task.c_W = body.p_W;
    const SearchOutcome outcome = tracker_.search(task);
    if (!outcome.comparable) continue;
    count_frame(&f.attempts);
    ++frame_.report.attempts;
    if (!outcome.found ||
        squared_distance(outcome.pixel - observation_[i].predicted, match.innovation) > settings_.gate) {
      count_frame(&f.failures);
      continue;
    }
    ++frame_.report.matches;
    match.measured = outcome.pixel;
    match.status = MatchStatus::kOutlier;  // until it agrees
    observation_[i].measured = outcome.pixel;
    const Scalar floor = settings_.sigma_px * outcome.level_scale;
    observation_[i].noise = Mat2::Identity() * (floor * floor) + outcome.noise + observation_[i].second_order;
    if (found != i) {
      std::swap(observation_[found], observation_[i]);
      std::swap(entry_[found], entry_[i]);
      std::swap(track_of_[found], track_of_[i]);
    }
    ++found;
  }
  return found - first;
}

/// Search, agreement and update of a range of listed features.
void FilterSlam::measure(int first, int count) {
  const int found = search(first, count);
  if (found == 0) return;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kUpdate]);
    filter_.begin_update(observation_ + first, found);
  }
  int agreed;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
    agreed = agree(filter_, observation_ + first, found, settings_.gate, keep_ + first);
  }
  // With inliers from an earlier range the gate alone is evidence enough.
  const bool believed =
      frame_.report.inliers >= kLeastAgreement || agreed >= std::min(kLeastAgreement, map_.features.count());
  for (int i = first; i < first + found; ++i) {
    if (!believed) keep_[i] = 0;
    Match& match = frame_.match(track_of_[i]);
    match.status = keep_[i] != 0 ? MatchStatus::kInlier : MatchStatus::kOutlier;
    match.nis = squared_distance(match.measured - observation_[i].predicted,
                                 filter_.innovation_block(i - first, i - first) + observation_[i].noise);
    if (keep_[i] == 0) {
      count_frame(&map_.features[entry_[i]].failures);
      if (believed) count_frame(&map_.features[entry_[i]].rejections);
    }
  }
  if (believed) take_in(first, found);
}

/// New features in the emptiest cells of the image, until enough are in view.
void FilterSlam::begin_features_in_image() {
  int in_cell[kCellRows][kCellColumns] = {};
  const int width = settings_.camera.width, height = settings_.camera.height;
  const auto cell_of = [](Scalar at, int size, int cells) {
    const Scalar inside = std::clamp(at, Scalar(0), static_cast<Scalar>(size - 1));
    return static_cast<int>(inside) * cells / size;
  };
  const auto column_of = [&](Scalar x) { return cell_of(x, width, kCellColumns); };
  const auto row_of = [&](Scalar y) { return cell_of(y, height, kCellRows); };
  int in_view = 0;
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0) continue;
    ++in_cell[row_of(match.predicted.y())][column_of(match.predicted.x())];
    if (match.status == MatchStatus::kInlier) ++in_view;
  }
  const int wanted = settings_.features_in_view - in_view;
  if (wanted < kFewNew) return;

  const Scalar apart = static_cast<Scalar>(std::max(8, width / 40));
  const int border = std::max(settings_.border_px, 10);
  int anchor = -1, begun = 0;
  // Emptiest cells first; each pass admits cells with one feature more.
  for (int most = 0; most < 3 && begun < wanted; ++most) {
    for (int cell = 0; cell < kCellRows * kCellColumns && begun < wanted; ++cell) {
      // Steps through the cells so that neighbours do not follow each other.
      const int k = (cell * 19 + frame_.report.frames) % (kCellRows * kCellColumns);
      const int row = k / kCellColumns, column = k % kCellColumns;
      if (in_cell[row][column] != most) continue;
      Rect rect;
      rect.x = std::max(column * width / kCellColumns, border);
      rect.y = std::max(row * height / kCellRows, border);
      rect.width = std::min((column + 1) * width / kCellColumns, width - border) - rect.x;
      rect.height = std::min((row + 1) * height / kCellRows, height - border) - rect.y;
      constexpr int kCandidates = 8;
      Corner corner[kCandidates];
      const int corners = tracker_.corners(rect, kCornerThreshold, corner, kCandidates);
      for (int c = 0; c < corners; ++c) {
        if (corner[c].score < kLeastCorner) break;
        const Vec2 pixel(static_cast<Scalar>(corner[c].x), static_cast<Scalar>(corner[c].y));
        bool free = true;
        for (int t = 0; t < frame_.match_count() && free; ++t)
          free = frame_.match(t).feature < 0 || (frame_.match(t).predicted - pixel).squaredNorm() > apart * apart;
        if (!free) continue;
        if (frame_.full()) return;
        if (!make_room_at(&anchor)) break;
        const int entry = begin_feature(anchor, pixel, Mat2::Identity() * (kReferenceSigma * kReferenceSigma));
        if (entry < 0) continue;
        Feature& f = map_.features[entry];
        f.appearance = tracker_.remember(pixel, filter_.state().body.q_WC, filter_.state().body.p_W);
        if (f.appearance < 0) {
          drop(&entry, 1);
          continue;
        }
        frame_.add({entry, f.id, MatchStatus::kNew, BlockKind::kInverseDepth, pixel, Mat2::Zero(), pixel, Scalar(0)});
        ++in_cell[row][column];
        ++begun;
        break;
      }
    }
  }
  if (anchor >= 0) filter_.remove(nullptr, 0);  // an anchor that got no child
}

}  // namespace pf
