#pragma once

#include "model/rows.h"

/// A measurement for the filter: a few rows with measured and predicted values and their noise.

namespace pf {

/// One measurement of any height: 1 for a distance, 2 for a pixel, 8 for a homography. A view of storage of its own height.
struct Measurement {
  int block = -1;  ///< that it is of, so that it can be predicted again
  Rows H;
  const Scalar* measured = nullptr;   ///< H.rows entries
  const Scalar* predicted = nullptr;  ///< the same
  const Scalar* R_gate = nullptr;     ///< H.rows x H.rows; what it is gated with
  const Scalar* R_update = nullptr;   ///< the same; noise of the update

  int rows() const { return H.rows; }
};

/// Storage of a measurement.
template <int kRows, int kMaxColumns, int kMaxParts>
struct MeasurementOf {
  static constexpr int kHeight = kRows;
  using Vector = Eigen::Matrix<Scalar, kRows, 1>;
  using Matrix = Eigen::Matrix<Scalar, kRows, kRows>;

  int block = -1;  ///< that it is of
  RowsOf<kRows, kMaxColumns, kMaxParts> H;
  Vector predicted = Vector::Zero();
  Vector measured = Vector::Zero();
  Matrix R_gate = Matrix::Identity();
  Matrix R_update = Matrix::Identity();

  void set_noise(const Matrix& R) { R_gate = R_update = R; }
  Measurement view() const { return {block, H, measured.data(), predicted.data(), R_gate.data(), R_update.data()}; }
};

/// A feature's pixel [px], over body, lens, plane, point group and feature at most.
struct PixelMeasurement : MeasurementOf<2, 31, 5> {
  Scalar bend = 0;  ///< what the linearisation leaves out where the pose is wide: bend I [px^2], part of both noises
  Mat2 second_order =
      Mat2::Zero();  ///< what else it leaves out, and a surface's roughness [px^2]; belongs into the noise
  Mat2 R_straight = Mat2::Identity();  ///< R_update without bend; as a difference of both, float might not have it

  /// Noises without bend, which is added.
  void set_noises(const Matrix& gate, const Matrix& update) {
    R_straight = update;
    R_gate = gate + bend * Matrix::Identity();
    R_update = update + bend * Matrix::Identity();
  }
  void set_noise(const Matrix& R) { set_noises(R, R); }
  /// An update takes it in with so much more noise; what gates it stays.
  void hold_back(Scalar noise) {
    bend = noise;
    R_update = R_straight + noise * Matrix::Identity();
  }
};

/// Corners of a patch on a plane [px], x and y of each, over body, reference camera, plane, patch and lens: a homography.
using PatchMeasurement = MeasurementOf<8, 39, 5>;

/// Distance of a feature from a plane [m], over plane, feature and the row of the scale.
using DistanceMeasurement = MeasurementOf<1, 24, 8>;

/// What a unit at rest reads: gyro [rad/s] and accelerometer [m/s^2], over rotation, biases, gravity, and of the unit its axes and
/// the accelerometer's intrinsics.
using StillMeasurement = MeasurementOf<6, 23, 4>;

}  // namespace pf
