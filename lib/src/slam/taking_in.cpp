#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "slam/filter_slam.h"

/// What is expected of pixels, and what happens to the map when they are taken in.

namespace pf {
namespace {

constexpr int kMostRounds = 3;  ///< of one frame's pixels, where little was known of the pose

}  // namespace

/// Takes in the kept ones of observations first .. first+count-1, which begin_update holds. False when nothing was taken in.
bool FilterSlam::take_in(int first, int count) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kUpdate]);
  Scalar nis = 0;
  if (!filter_.finish_update(observation_ + first, count, keep_ + first, &nis)) {
    tracking_.count_update(false);
    for (int i = first; i < first + count; ++i) frame_.match(track_of_[i]).status = MatchStatus::kOutlier;
    return false;
  }
  tracking_.count_update(true);
  frame_.report.nis += static_cast<double>(nis);
  for (int i = first; i < first + count; ++i) {
    if (keep_[i] == 0) continue;
    frame_.report.nis_dof += 2;
    ++frame_.report.inliers;
    Feature& feature = map_.features[entry_[i]];
    count_frame(&feature.observations);
    feature.failures = 0;
    feature.rejections = 0;
    feature.last_seen_ns = frame_.report.t_ns;
  }
  take_in_again_where_bent(first, count);
  return true;
}

/// H P H^T of a predicted pixel. Adds to its second-order noise what the projection bends over the spread of the pose: with an
/// angle of s = sqrt(lambda / f^2) the tangent leaves out about f s^2, as noise f^2 s^4 / 2. The smaller eigenvalue counts: the
/// larger may be of the depth, in which an inverse-depth point is linear.
Mat2 FilterSlam::expected_innovation(Observation* o) const {
  const Mat2 S = filter_.innovation(*o);
  const Scalar half = (S(0, 0) - S(1, 1)) / 2;
  const Scalar lambda = (S(0, 0) + S(1, 1)) / 2 - std::sqrt(half * half + S(0, 1) * S(0, 1));
  const Scalar bend = lambda * lambda / (2 * settings_.camera.fx * settings_.camera.fy);
  o->second_order(0, 0) += bend;
  o->second_order(1, 1) += bend;
  o->bend = bend;
  return S;
}

/// Pixels that were taken in with much of that noise are taken in again at the pose that they led to, with the information that the noise
/// kept back:  R' = (R^-1 - (R + bend I)^-1)^-1 = R + R^2 / bend.
void FilterSlam::take_in_again_where_bent(int first, int count) {
  for (int round = 0; round < kMostRounds; ++round) {
    bool bent = false;
    for (int i = first; i < first + count; ++i)
      bent = bent || (keep_[i] != 0 && 2 * observation_[i].bend > observation_[i].noise(0, 0));
    if (!bent) return;
    for (int i = first; i < first + count; ++i) {
      if (keep_[i] == 0) continue;
      Observation& o = observation_[i];
      const Vec2 measured = o.measured;
      const Scalar bend = std::max(o.bend, Scalar(1e-6));
      const Mat2 R = o.noise - Mat2::Identity() * bend;
      keep_[i] = filter_.predict_pixel(settings_.camera, o.slot, &o) ? 1 : 0;
      if (keep_[i] == 0) continue;
      expected_innovation(&o);
      o.measured = measured;
      o.noise = R + R.lazyProduct(R) / bend + Mat2::Identity() * o.bend;
    }
    filter_.begin_update(observation_ + first, count);
    if (!filter_.finish_update(observation_ + first, count, keep_ + first, nullptr)) return;
  }
}

}  // namespace pf
