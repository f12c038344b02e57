#pragma once

#include <cmath>

#include "filter/motion.h"
#include "frame/tuning.h"

/// A hand does not keep its speed for long, and half a radian of rotation uncertainty already means searching everywhere. Without these
/// limits, one second without an image would predict the camera out of the room. A variance of three axes is that of the least known one:
/// a camera that turns about one axis alone is as lost as one that turns about all.

namespace pf {

/// The noise of a motion model, without what would make wide covariances wider. linear_variance: of the velocity, or of the position
/// where there is none.
inline MotionNoise limited_noise(MotionNoise noise, bool has_velocity, Scalar rotation_variance,
                                 Scalar linear_variance) {
  using namespace tuning::body_motion;
  if (rotation_variance > kMaxRotationSigma * kMaxRotationSigma) noise.angular = Scalar(0);
  const Scalar most = has_velocity ? kMaxSpeedSigma : kAnyPosition;
  if (linear_variance > most * most) noise.linear = Scalar(0);
  return noise;
}

/// Factor by which a speed that is not measured decays in dt [s].
inline Scalar speed_decay(Scalar dt) { return std::exp(-dt / tuning::body_motion::kSpeedDecay); }

/// Beyond any position and any rotation the speeds decay to kLeastSpeedSigma, without noise that keeps them up: a variance that halves in
/// each frame would be no normal number after some seconds. P: of (v, w).
///
/// rate: w, which counts up to what leads to any rotation in dt [s], and for nothing beyond that. What decays of a faster one would give
/// the rotation a variance beside which float cannot hold what the next images tell.
inline void limit_speed(Scalar dt, Scalar rotation_variance, Scalar position_variance, Vec3* rate, Mat6* P) {
  using namespace tuning::body_motion;
  const bool any_rotation = rotation_variance > kAnyRotation * kAnyRotation;
  const bool any_position = position_variance > kAnyPosition * kAnyPosition;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      if ((any_position && (i < 3 || j < 3)) || (any_rotation && (i >= 3 || j >= 3)))
        (*P)(i, j) = i == j ? kLeastSpeedSigma * kLeastSpeedSigma : Scalar(0);
  const Scalar way = rate->norm() * dt;
  if (any_rotation)
    rate->setZero();
  else if (way > kAnyRotation)
    *rate *= kAnyRotation / way;
}

}  // namespace pf
