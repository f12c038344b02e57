#pragma once

#include "geometry/lens.h"

/// The lens of the window: an estimate that all keyframes share, and its prior from the calibration.

namespace pf {

class Archive;

class KeyframeLens {
 public:
  static constexpr int kMaxEntries = kLensParameters * kLensParameters;  ///< of a matrix of its rows, row-major

  /// Begins at the calibration.
  void init(const Camera& calibration, const LensPrior& prior);

  const LensRows& rows() const { return rows_; }
  const Camera& camera() const { return camera_; }
  const Scalar* covariance() const { return covariance_; }

  /// What is known of it before its adjustments: the calibration and, of a readout that a start has measured, that.
  const Camera& prior_camera() const { return prior_camera_; }
  const LensPrior& prior() const { return prior_; }
  /// A start has measured the readout with this variance, that of the calibration included.
  void begin_readout(Scalar readout, Scalar variance);

  /// Of the readout [s^2]; 0 where it is exact.
  Scalar readout_variance() const {
    return rows_.has_readout() ? covariance_[rows_.count * rows_.count - 1] : Scalar(0);
  }
  /// The lens is where an adjustment has found it.
  void move(const Camera& camera) { camera_ = camera; }
  /// Covariance from an adjustment whose pixels were weighted `inflation` times too much.
  void set_covariance(const Scalar* covariance, Scalar inflation);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  LensRows rows_;
  Camera camera_, prior_camera_;
  LensPrior prior_;
  Scalar covariance_[kMaxEntries] = {};
};

}  // namespace pf
