#include <algorithm>

#include "keyframe_slam/adjustment/adjustment.h"
#include "keyframe_slam/adjustment/tuning.h"

/// What holds the scale of KeyframeAdjustment, where fixed keyframes do not: the target's points, or a distance.

namespace pf {

using namespace tuning::keyframe_adjustment;

/// Whether two keyframes at least, of those that hang together, see points of the target, which then holds the map where it is.
bool KeyframeAdjustment::is_held_by_target() const {
  int keyframes = 0;
  for (int k = 0; k < map_.keyframes.capacity(); ++k) {
    if (!is_connected_[k]) continue;
    int seen = 0;
    for (int i = 0; i < map_.capacity(); ++i)
      seen += map_.used(i) && map_.feature(i).is_target && map_.keyframes.pixels(k)[i].seen ? 1 : 0;
    keyframes += seen >= kMinTargetPoints ? 1 : 0;
  }
  return keyframes > 1;
}

/// The target's points have a fixed pose as host, and their inverse depths are known.
///
///   sigma_rho = sigma_m rho²
void KeyframeAdjustment::add_target(int points, int* poses) {
  const int host = *poses;
  for (int p = 0; p < points; ++p) {
    const Feature& f = map_.feature(row_[p]);
    if (!f.is_target) continue;
    const Vec3 at = target_view_.q_WC.conjugate() * (target_.point_W[f.external_id] - target_view_.c_W);
    ray_[p] = at.normalized();
    host_[p] = host;
    rho_[p] = 1 / at.norm();
    prior_[p] = {rho_[p], std::max(target_.sigma_m * rho_[p], kTargetSigma) * rho_[p]};
    pose_[host] = {target_view_.q_WC, target_view_.c_W, false, nullptr};
    keyframe_[host] = -1;
    *poses = host + 1;
  }
}

/// Of many keyframes of which but one is fixed: the distance from that one of the farthest of the older half of the others. False where
/// other keyframes, or the target, hold the scale.
bool KeyframeAdjustment::hold_distance(int free, int seen_in, BundleDistance* held) const {
  if (seen_in != free + 1 || is_held_by_target() || connected_ < 2 * kHeldKeyframes) return false;
  held->pose = -1;
  held->from_W = pose_[free].p_W;
  held->distance = Scalar(0);
  for (int c = 0; 2 * c < free; ++c) {
    const Scalar distance = (pose_[c].p_W - held->from_W).norm();
    if (distance <= held->distance) continue;
    held->pose = c;
    held->distance = distance;
  }
  held->sigma = kHeldDistance * held->distance;
  return held->pose >= 0;
}

/// The keyframe that hosts the target's points has moved; they have not.
void KeyframeAdjustment::put_target_back() {
  for (int i = 0; i < map_.capacity(); ++i)
    if (map_.used(i) && map_.feature(i).is_target) map_.place(i, target_.point_W[map_.feature(i).external_id]);
}

}  // namespace pf
