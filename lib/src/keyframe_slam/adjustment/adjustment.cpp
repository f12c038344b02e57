#include "keyframe_slam/adjustment/adjustment.h"

#include <algorithm>
#include <cmath>

#include "geometry/so3.h"
#include "keyframe_slam/adjustment/tuning.h"
#include "keyframe_slam/map/covisible.h"
#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {

using namespace tuning::keyframe_adjustment;

static_assert(tuning::keyframe_map::kKeyframes + 1 <= BundleAdjuster::kMaxPoses, "keyframes and the target's host");

bool KeyframeAdjustment::layout(Arena& arena) {
  const int keyframes = tuning::keyframe_map::kKeyframes;
  const int lens_rows = settings_.lens.rows.count;
  max_free_ = lens_rows > 0 ? keyframes : keyframes - kHeldKeyframes;
  const std::size_t points = static_cast<std::size_t>(settings_.max_features);
  const std::size_t poses = static_cast<std::size_t>(keyframes + 1);  // and the target's host
  is_connected_ = arena.take<bool>(static_cast<std::size_t>(keyframes));
  is_seen_ = arena.take<bool>(points);
  pose_ = arena.take<BundlePose>(poses);
  keyframe_ = arena.take<int>(poses);
  pixel_ = arena.take<BundlePixel>(static_cast<std::size_t>(keyframes) * points);
  ray_ = arena.take<Vec3>(points);
  host_ = arena.take<int>(points);
  rho_ = arena.take<Scalar>(points);
  rho_before_ = arena.take<Scalar>(points);
  prior_ = arena.take<RhoPrior>(points);
  row_ = arena.take<std::int16_t>(points);
  plane_ = arena.take<BundlePlane>(static_cast<std::size_t>(settings_.max_planes));
  plane_row_ = arena.take<int>(static_cast<std::size_t>(settings_.max_planes));
  plane_of_ = arena.take<int>(points);
  host_pixel_ = lens_rows > 0 ? arena.take<HostPixel>(points) : nullptr;
  return adjuster_.layout(arena, static_cast<int>(poses), max_free_, settings_.max_features, settings_.max_planes,
                          lens_rows);
}

/// Of the keyframes that hang together with the newest: of few, all but one, unless the target holds them; of more, all but the oldest
/// three, the oldest first. Where the lens is uncertain, all but one always: keyframes that are held fixed say as if they knew it what lens
/// they have been adjusted with. Away from the first keyframe, all but the oldest six, since one keyframe and a distance would force their
/// own errors on all others. While a record goes on, the newest of all. Returns how many.
int KeyframeAdjustment::choose_free(bool settled) {
  const KeyframeTable& keyframes = map_.keyframes;
  connected_ = settled ? connected_keyframes(map_, kMinShared, is_connected_, is_seen_) : 0;
  if (connected_ < kMinConnected) {
    for (int k = 0; k < keyframes.capacity(); ++k) is_connected_[k] = keyframes.used(k);
    connected_ = keyframes.count();
  }
  bool has_first = false;
  for (int k = 0; k < keyframes.capacity(); ++k)
    has_first = has_first || (is_connected_[k] && keyframes[k].number == 1);
  is_away_ = settled && !has_first;
  int others = 1;
  if (is_held_by_target())
    others = 0;
  else if (is_away_ && connected_ >= 2 * kHeldAway)
    others = kHeldAway;
  else if (settled && settings_.lens.rows.count == 0 && connected_ >= 2 * kHeldKeyframes)
    others = kHeldKeyframes;
  const int free = std::min(settled ? max_free_ : static_cast<int>(settings_.window_keyframes), connected_ - others);
  for (int c = 0; c < free; ++c) {
    // The (free - c)-th newest.
    int at = -1;
    for (int k = 0; k < keyframes.capacity(); ++k) {
      if (!is_connected_[k]) continue;
      int newer = 0;
      for (int other = 0; other < keyframes.capacity(); ++other)
        newer += is_connected_[other] && keyframes[other].number > keyframes[k].number ? 1 : 0;
      if (newer == free - 1 - c) at = k;
    }
    keyframe_[c] = at;
  }
  return free;
}

/// Points with a depth that the free keyframes see, and another one. Returns how many.
int KeyframeAdjustment::choose_points(int free) {
  int points = 0;
  for (int i = 0; i < map_.capacity(); ++i) {
    if (!map_.used(i) || !map_.point(i).has_depth) continue;
    int in_free = 0, in_all = 0;
    for (int c = 0; c < free; ++c) in_free += map_.keyframes.pixels(keyframe_[c])[i].seen ? 1 : 0;
    for (int k = 0; k < map_.keyframes.capacity(); ++k)
      in_all += map_.keyframes.used(k) && map_.keyframes.pixels(k)[i].seen ? 1 : 0;
    if (in_free > 0 && in_all > 1) row_[points++] = static_cast<std::int16_t>(i);
  }
  return points;
}

/// The older keyframes that see most of these points. Returns how many there are with the free ones.
int KeyframeAdjustment::choose_fixed(int free, int points, bool settled) {
  int poses = free;
  const int most_fixed = settled ? kHeldAway : settings_.window_fixed;
  for (int f = 0; f < most_fixed; ++f) {
    int best = -1, most = kMinShared - 1;
    for (int k = 0; k < map_.keyframes.capacity(); ++k) {
      if (!map_.keyframes.used(k) || std::find(keyframe_, keyframe_ + poses, k) != keyframe_ + poses) continue;
      int seen = 0;
      for (int p = 0; p < points; ++p) seen += map_.keyframes.pixels(k)[row_[p]].seen ? 1 : 0;
      if (seen < most || (seen == most && (best < 0 || map_.keyframes[k].number < map_.keyframes[best].number)))
        continue;
      best = k;
      most = seen;
    }
    if (best < 0) break;
    keyframe_[poses++] = best;
  }
  return poses;
}

/// Pose of a keyframe in the bundle, which becomes a fixed one without pixels where it is in there no other way.
int KeyframeAdjustment::pose_of(int keyframe, int* poses) {
  const int at = static_cast<int>(std::find(keyframe_, keyframe_ + *poses, keyframe) - keyframe_);
  if (at < *poses) return at;
  const Keyframe& k = map_.keyframes[keyframe];
  keyframe_[*poses] = keyframe;
  pose_[*poses] = {k.q_WC, k.p_W, false, nullptr};
  return (*poses)++;
}

void KeyframeAdjustment::fill(int seen_in, int points, int* poses) {
  for (int p = 0; p < points; ++p) {
    const KeyframePoint& point = map_.point(row_[p]);
    for (int c = 0; c < seen_in; ++c)
      pixel_[c * settings_.max_features + p] = map_.keyframes.pixels(keyframe_[c])[row_[p]];
    ray_[p] = point.ray_K;
    host_[p] = pose_of(point.host, poses);
    rho_[p] = rho_before_[p] = point.rho;
  }
}

bool KeyframeAdjustment::run(bool settled) {
  const bool with_lens = settled && map_.lens().rows().count > 0;
  const int free = choose_free(settled);
  if (free < 1) return false;
  const int seen = choose_points(free);
  if (seen < kMinPoints) return false;
  const int seen_in = choose_fixed(free, seen, settled);
  int poses = seen_in;
  for (int c = 0; c < seen_in; ++c) {
    const Keyframe& k = map_.keyframes[keyframe_[c]];
    pose_[c] = {k.q_WC, k.p_W, c < free, pixel_ + c * settings_.max_features};
  }
  BundleDistance held;
  const bool holds_distance = settled && hold_distance(free, seen_in, &held);
  const bool has_scale = holds_distance || seen_in - free >= kMinScaleKeyframes || is_held_by_target();
  const int points = has_scale ? add_plane_points(seen) : seen;
  fill(seen_in, points, &poses);

  // A weak prior that leaves the scale where it is: it holds what nothing else does.
  Scalar sum = 0, squares = 0;
  for (int p = 0; p < points; ++p) {
    sum += rho_[p];
    squares += rho_[p] * rho_[p];
  }
  const Scalar mean = squares / sum;
  std::fill(prior_, prior_ + points, RhoPrior{mean, kPriorSigma * mean});
  hold_by_pixels(seen, points);
  add_target(points, &poses);
  const int planes = has_scale ? add_planes(points) : 0;
  const int rounds = map_.keyframes.count() <= settings_.window_keyframes ? kFirstRounds : kRounds;
  const AdjustOptions options = {std::max(noise_.sigma_gate(), kMinSigma),
                                 kHuber,
                                 mean,
                                 kPriorSigma * mean,
                                 kBehindWeight,
                                 kNoPixelPenalty,
                                 rounds};
  const Scalar inflation = noise_.correlation_frames();
  Camera camera = map_.camera();
  Scalar information[KeyframeLens::kMaxEntries];
  lens_information(settings_.lens, inflation, information);
  const BundleLens lens = {map_.lens().rows(), information, settings_.camera, &camera, host_pixel_, ray_};
  for (int p = 0; p < points && with_lens; ++p) host_pixel_[p] = map_.host_pixel(row_[p]);
  const Bundle bundle = {pose_,
                         poses,
                         ray_,
                         host_,
                         rho_,
                         points,
                         prior_,
                         plane_,
                         planes,
                         planes > 0 ? plane_of_ : nullptr,
                         rho_before_,
                         with_lens ? &lens : nullptr,
                         holds_distance ? &held : nullptr};
  adjuster_.adjust(map_.camera(), options, bundle);
  // The last free pose is the newest keyframe's.
  Mat6 P;
  const bool determined = adjuster_.last_pose_covariance(map_.camera(), options, bundle, &P);
  if (determined) note_covariance(inflation * (P + P.transpose()) / 2, free, seen_in);
  if (with_lens) {
    map_.move_lens(camera);
    Scalar covariance[KeyframeLens::kMaxEntries];
    if (determined) {
      adjuster_.lens_covariance(covariance);
      map_.lens().set_covariance(covariance, inflation);
    }
  }
  take_back(free, points);
  take_planes_back(planes, determined);
  return true;
}

/// The newest keyframe's covariance given those that are held fixed, and away from the first keyframe with it that of the newest of these,
/// H, which moves everything:
///
///   theta = theta_H + dtheta,  p = p_H + R_H dp:   P = P_dd + A P_H Aᵀ,   A = [I 0; -[p - p_H]x I]
void KeyframeAdjustment::note_covariance(const Mat6& given_held, int free, int seen_in) {
  map_covariance_ = given_held;
  int held = -1;
  for (int c = free; c < seen_in && is_away_; ++c)
    if (held < 0 || map_.keyframes[keyframe_[c]].number > map_.keyframes[held].number) held = keyframe_[c];
  if (held >= 0) {
    Mat6 A = Mat6::Identity();
    A.bottomLeftCorner<3, 3>() = -hat(Vec3(pose_[free - 1].p_W - map_.keyframes[held].p_W));
    map_covariance_ += A * map_.keyframes[held].covariance * A.transpose();
  }
  map_.keyframes[keyframe_[free - 1]].covariance = map_covariance_;
}

void KeyframeAdjustment::take_back(int free, int points) {
  for (int c = 0; c < free; ++c) {
    Keyframe& k = map_.keyframes[keyframe_[c]];
    k.q_WC = pose_[c].q_WC;
    k.p_W = pose_[c].p_W;
  }
  put_target_back();
  for (int p = 0; p < points; ++p) {
    KeyframePoint& point = map_.point(row_[p]);
    if (!map_.feature(row_[p]).is_target) {
      point.rho = rho_[p];
      point.variance = depth_by_pixels(map_, row_[p], noise_.sigma_info()).variance;
    }
    reject_outliers(row_[p]);
    if (point.faces_host) {
      const Keyframe& host = map_.keyframes[point.host];
      map_.tables().first_view(row_[p]) = {host.q_WC, host.p_W};
    }
  }
}

/// Forgets pixels of a point that are not where it is.
void KeyframeAdjustment::reject_outliers(int i) {
  const KeyframePoint& point = map_.point(i);
  const Keyframe& host = map_.keyframes[point.host];
  const Vec3 ray_W = map_.ray_W(i);
  const Scalar bound = kOutlierSigmas * std::max(noise_.sigma_gate(), kMinSigma);
  for (int k = 0; k < map_.keyframes.capacity(); ++k) {
    BundlePixel& pixel = map_.keyframes.pixels(k)[i];
    if (k == point.host || !map_.keyframes.used(k) || !pixel.seen) continue;
    const Keyframe& keyframe = map_.keyframes[k];
    Vec2 z;
    if (!project_bearing(map_.camera(), keyframe.q_WC.toRotationMatrix(), ray_W, host.p_W - keyframe.p_W, point.rho,
                         &z) ||
        (pixel.pixel() - z).squaredNorm() > bound * bound)
      pixel.seen = false;
  }
}

}  // namespace pf
