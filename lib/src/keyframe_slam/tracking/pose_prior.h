#pragma once

#include "keyframe_slam/tracking/motion.h"

namespace pf {

/// A pose with its covariance and, for rows, velocities.
struct PosePrior {
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Mat6 covariance = Mat6::Zero();  ///< of (theta, p)
  /// Velocities, which matter to the rows of a rolling shutter alone; covariance of (theta, p, v, w), null: velocities taken as exact.
  Vec3 v_W = Vec3::Zero(), w_C = Vec3::Zero();
  const Eigen::Matrix<Scalar, 12, 12>* with_velocities = nullptr;
  /// Wide searches go about the places where the image as a whole has moved (PointSearch::find_followed).
  bool follows = false;

  Body body() const {
    Body body;
    body.q_WC = q_WC;
    body.p_W = p_W;
    body.v_W = v_W;
    body.w_C = w_C;
    return body;
  }
};

/// The present body: before a frame's matches the prediction, after them the estimate. Refers to its covariance.
inline PosePrior prior_of(const KeyframeMotion& motion) {
  const Body& body = motion.body();
  return {body.q_WC, body.p_W, motion.pose_covariance(), body.v_W, body.w_C, &motion.covariance()};
}

}  // namespace pf
