#pragma once

#include <cstdint>

#include "base/eigen.h"
#include "model/intrinsics.h"

/// The leading block of the state: the body that carries the camera, made of optional parts.

namespace pf {

/// In the order of their rows: what moves first, since F and Q of a motion model cover only that; constants behind it.
enum class BodyPart : std::uint8_t {
  kPose,             ///< theta, p
  kVelocity,         ///< v; of the inertial unit where there is one
  kAngularVelocity,  ///< w
  kAcceleration,     ///< a
  kGyroBias,         ///< of the inertial unit, in its axes
  kAccelBias,        ///< the same
  kGravity,          ///< its direction in W, two rows
  kMountRotation,    ///< of the inertial unit's axes against the camera's, where they are estimated
  kMountPlace,       ///< of its origin, the same
  kDelay,            ///< of its clock, one row
  kIntrinsics,       ///< of its sensors: constants without F and Q of their own, on which the motion depends
  kLens              ///< numbers of the calibration (geometry/lens.h)
};

/// Which parts a body has, and where their rows lie. The pose is always there, and first.
class BodyLayout {
 public:
  static constexpr int kMaxDynamicRows = 24;
  static constexpr int kMaxUnitRows = kMaxDynamicRows + Intrinsics::kRows;  ///< and the unit's constants behind them
  static constexpr int kVelocityRows =
      12;  ///< pose, velocity and angular velocity: the most that a caller knows at the start

  static BodyLayout with_constant_position() { return BodyLayout(); }
  static BodyLayout with_constant_velocity() {
    BodyLayout layout;
    layout.add(BodyPart::kVelocity, 3);
    layout.add(BodyPart::kAngularVelocity, 3);
    return layout;
  }

  static BodyLayout with_constant_acceleration() {
    BodyLayout layout = with_constant_velocity();
    layout.add(BodyPart::kAcceleration, 3);
    return layout;
  }

  /// The angular velocity is no state: it is that of the samples less their bias (lib/docs/theory/inertial.md).
  static BodyLayout with_inertial_unit() {
    BodyLayout layout;
    layout.add(BodyPart::kVelocity, 3);
    layout.add(BodyPart::kGyroBias, 3);
    layout.add(BodyPart::kAccelBias, 3);
    layout.add(BodyPart::kGravity, 2);
    return layout;
  }
  /// Mounting and delay of the unit: constants on which its samples depend, so F has columns for them.
  void add_mounting(bool rotation, bool place, bool delay) {
    if (rotation) add(BodyPart::kMountRotation, 3);
    if (place) add(BodyPart::kMountPlace, 3);
    if (delay) add(BodyPart::kDelay, 1);
  }
  /// Behind these and before all other constants.
  void add_intrinsics() { add_constant(BodyPart::kIntrinsics, Intrinsics::kRows, false); }
  /// What a map hands on to the next.
  bool estimates_unit() const {
    return has(BodyPart::kMountRotation) || has(BodyPart::kMountPlace) || has(BodyPart::kDelay) ||
           has(BodyPart::kIntrinsics);
  }

  /// Adds a part that does not move. Considered: it keeps its covariance and is not estimated (Schmidt); such parts come last, so that
  /// all considered rows of the state lie together.
  void add_constant(BodyPart part, int rows, bool considered) {
    row_[index(part)] = static_cast<std::int8_t>(this->rows());
    constant_rows_ = static_cast<std::int8_t>(constant_rows_ + rows);
    if (considered) considered_rows_ = static_cast<std::int8_t>(considered_rows_ + rows);
  }

  bool has(BodyPart part) const { return row_[index(part)] >= 0; }
  /// First row of a part that it has.
  int row(BodyPart part) const { return row_[index(part)]; }
  /// Rows of the parts that move.
  int dynamic_rows() const { return dynamic_rows_; }
  /// The same, with the unit's constants behind them.
  int unit_rows() const { return dynamic_rows_ + (has(BodyPart::kIntrinsics) ? Intrinsics::kRows : 0); }
  /// Rows of what a caller can know at the start: pose, velocity and angular velocity.
  int known_rows() const { return dynamic_rows_ < kVelocityRows ? dynamic_rows_ : kVelocityRows; }
  int rows() const { return dynamic_rows_ + constant_rows_; }
  /// Of them, the last ones.
  int considered_rows() const { return considered_rows_; }

 private:
  static constexpr int kParts = 12;
  static constexpr int index(BodyPart part) { return static_cast<int>(part); }

  void add(BodyPart part, int rows) {
    row_[index(part)] = static_cast<std::int8_t>(dynamic_rows_);
    dynamic_rows_ = static_cast<std::int8_t>(dynamic_rows_ + rows);
  }

  std::int8_t row_[kParts] = {0, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  std::int8_t dynamic_rows_ = 6, constant_rows_ = 0, considered_rows_ = 0;
};

/// Pose and velocities of the camera. Error: of the pose theta (3), p (3); of velocity and angular velocity v (3) and w (3).
///
///   R_true = Exp(theta) R_WC,   p_true = p + e_p,   v_true = v + e_v,   w_true = w + e_w
///
/// With constant acceleration: a_true = a + e_a (3).
///
/// With an inertial unit: biases b_true = b + e_b, and gravity's direction R_WG e_z,
///
///   R_WG_true = Exp(R_WG (d_1, d_2, 0)) R_WG
///
/// and v is the velocity of the unit's origin. Parts that its layout lacks are zero and stay so.
struct Body {
  static constexpr int kTheta = 0, kPosition = 3, kPoseDim = 6;  ///< rows of the pose

  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();         ///< [m]
  Vec3 v_W = Vec3::Zero();         ///< [m/s]
  Vec3 a_C = Vec3::Zero();         ///< [m/s^2] how the velocity's coordinates in C change
  Vec3 w_C = Vec3::Zero();         ///< [rad/s]; with an inertial unit no state, but the frame's sample less the bias
  Vec3 gyro_bias = Vec3::Zero();   ///< [rad/s], in the unit's axes
  Vec3 accel_bias = Vec3::Zero();  ///< [m/s^2], in the unit's axes
  Quat q_WG = Quat::Identity();    ///< z is where gravity points
  Vec3 gravity_W() const;
};

/// Accelerations of the camera about the frame's time, from its samples, for rows that are read out earlier and later. No state.
struct Bend {
  Vec3 alpha_C = Vec3::Zero();  ///< [rad/s^2]; zero without samples
  Vec3 a_C = Vec3::Zero();      ///< [m/s^2]; zero too where lengths have no unit
};

/// Where the inertial unit B is on the camera, and how its clock runs. Error, where it is estimated: R_CB_true = Exp(mu) R_CB, the others
/// additive.
struct Mounting {
  Mat3 R_CB = Mat3::Identity();
  Vec3 p_C = Vec3::Zero();  ///< its origin in C [m]
  Scalar delay = 0;         ///< t_frame = t_sample + delay, beside the delay of the config [s]
  bool in_metres = true;    ///< false: p_C is zero and no part of the motion, since lengths have no unit yet
  Intrinsics intrinsics = {};

  /// The camera's rate by what the gyroscope reads beside its bias.
  Mat3 rate_by_reading() const { return R_CB * intrinsics.D_w; }
  Vec3 rate_C(const Vec3& reading) const { return R_CB * (intrinsics.D_w * reading); }
  /// What the gyroscope reads beside its bias.
  Vec3 reading_of(const Vec3& rate_C) const { return intrinsics.D_w.inverse() * (R_CB.transpose() * rate_C); }
};

}  // namespace pf
