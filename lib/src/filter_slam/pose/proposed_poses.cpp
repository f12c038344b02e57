#include "filter_slam/pose/proposed_poses.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "frame/tuning.h"
#include "geometry/so3.h"

namespace pf {

using namespace tuning::relocaliser;

void ProposedPoses::begin_frame(std::int64_t dt_ns) {
  last_ = now_;
  now_ = PoseProposal();
  dt_ns_ = dt_ns;
}

Scalar ProposedPoses::propose(const Quat& q_WC, const Vec3& p_W, Scalar depth, Scalar before, Scalar evidence) {
  now_ = {true, 0, q_WC, p_W, depth};
  if (last_.is_set) before = depth > 0 && follows(now_) ? last_.log_odds : std::min(before, PoseBelief::anew());
  now_.log_odds = PoseBelief::updated(before, evidence);
  return now_.log_odds;
}

/// Whether the camera can have moved here from the last frame's proposal.
bool ProposedPoses::follows(const PoseProposal& next) const {
  const Scalar dt = static_cast<Scalar>(seconds(dt_ns_));
  const Body& body = filter_.state().body;
  Scalar max_rotation = kProposalRotation, max_shift = kProposalShift * next.depth;
  if (settings_.body.has(BodyPart::kVelocity)) {
    const int rate = settings_.body.row(settings_.inertial ? BodyPart::kGyroBias : BodyPart::kAngularVelocity);
    Scalar v = 0, w = 0;
    for (int i = 0; i < 3; ++i) {
      v += filter_.variance(settings_.body.row(BodyPart::kVelocity) + i);
      w += filter_.variance(rate + i);
    }
    max_rotation += (kMotionGate * std::min(std::sqrt(w), kMaxRateSigma) + body.w_C.norm()) * dt;
    max_shift += (kMotionGate * std::min(std::sqrt(v), kMaxSpeedSigma * next.depth) + body.v_W.norm()) * dt;
  } else {
    max_rotation += kMotionGate * settings_.motion_noise.angular * std::sqrt(3 * dt);
    max_shift += kMotionGate * settings_.motion_noise.linear * std::sqrt(3 * dt);
  }
  return log_so3(next.q_WC * last_.q_WC.conjugate()).norm() < max_rotation && (next.p_W - last_.p_W).norm() < max_shift;
}

}  // namespace pf
