#pragma once

#include <cmath>

#include "filter/motion.h"
#include "frame/tuning.h"

/// A hand does not keep its speed for long, and with a rotation sigma of half a radian every feature is searched for everywhere. Without
/// these limits one second without an image would predict the camera out of the room. The variance of three axes is that of the least known
/// one: one unknown axis is as bad as three.

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

/// Where position and rotation are fully unknown the speeds decay to kLeastSpeedSigma, without process noise; a variance that went on
/// halving in each frame would be denormal after some seconds. P: of (v, w).
///
/// rate: w, which is cut at the rate that leads to any rotation in dt [s]. The decay of a faster one would give the rotation a variance so
/// large that float has no digits left for what the next images measure.
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
