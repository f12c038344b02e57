#pragma once

#include "filter/inertial_motion.h"

/// What the operations of inertial_motion.h fill F and Q by.

namespace pf::inertial_rows {

/// Rows of the layout.
struct PartRows {
  explicit PartRows(const BodyLayout& layout)
      : dim(layout.dynamic_rows()),
        velocity(layout.row(BodyPart::kVelocity)),
        gyro(layout.row(BodyPart::kGyroBias)),
        accel(layout.row(BodyPart::kAccelBias)),
        gravity(layout.row(BodyPart::kGravity)),
        turn(layout.row(BodyPart::kMountRotation)),
        place(layout.row(BodyPart::kMountPlace)),
        delay(layout.row(BodyPart::kDelay)),
        intrinsics(layout.row(BodyPart::kIntrinsics)) {}
  int dim, velocity, gyro, accel, gravity;
  int turn, place, delay;  ///< of the mounting; negative where it is not estimated
  int intrinsics;          ///< the same
};

inline void clear(Transition* t, const Body& body, int dim) {
  t->mean = body;
  t->dim = dim;
  for (int i = 0; i < dim * dim; ++i) t->F[i] = t->Q[i] = Scalar(0);
  for (int i = 0; i < dim; ++i) t->F[i * dim + i] = Scalar(1);
  t->has_intrinsics = false;
}

/// Some rows by the errors of the unit's intrinsics, beginning with the one of these errors that is `column`.
template <int kRows, int kColumns>
inline void set_by_intrinsics(Transition* t, int row, int column, const Eigen::Matrix<Scalar, kRows, kColumns>& value) {
  if (!t->has_intrinsics)
    for (int i = 0; i < t->dim * Intrinsics::kRows; ++i) t->by_intrinsics[i] = Scalar(0);
  t->has_intrinsics = true;
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < kColumns; ++j) t->by_intrinsics[(row + i) * Intrinsics::kRows + column + j] = value(i, j);
}

template <int kColumns>
inline void set_block(Scalar* matrix, int dim, int row, int column, const Eigen::Matrix<Scalar, 3, kColumns>& value) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < kColumns; ++j) matrix[(row + i) * dim + column + j] = value(i, j);
}

inline void add_variance(Transition* transition, int first, int rows, Scalar sigma) {
  for (int i = first; i < first + rows; ++i) transition->Q[i * transition->dim + i] += sigma * sigma;
}

inline void forget_rows(Transition* transition, int first, int rows) {
  for (int i = first; i < first + rows; ++i)
    for (int j = 0; j < transition->dim; ++j) transition->F[i * transition->dim + j] = Scalar(0);
}

/// Gravity's rows by those of the rotation, where its direction was read off with that; by_unit: in axes of the unit.
inline Eigen::Matrix<Scalar, 2, 3> set_gravity_by_rotation(const PartRows& rows, bool by_unit, Transition* transition) {
  const Eigen::Matrix<Scalar, 2, 3> E_t = transition->mean.q_WG.toRotationMatrix().leftCols<2>().transpose();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j) transition->F[(rows.gravity + j) * rows.dim + Body::kTheta + i] = E_t(j, i);
  if (by_unit && rows.turn >= 0) {
    const Eigen::Matrix<Scalar, 2, 3> by_turn = E_t * transition->mean.q_WC.toRotationMatrix();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 2; ++j) transition->F[(rows.gravity + j) * rows.dim + rows.turn + i] = by_turn(j, i);
  }
  return E_t;
}

}  // namespace pf::inertial_rows
