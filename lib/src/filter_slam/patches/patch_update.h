#pragma once

#include "filter/filter.h"
#include "filter_slam/patches/patch_noise.h"
#include "frame/frame.h"
#include "frame/tracking_state.h"
#include "map/map.h"
#include "track/patch_store.h"

namespace pf {

/// Measures one patch at a time: predicts its corners on a plane, gates them, and updates the filter with all eight rows or none. Planes
/// are entries of the table.
class PatchUpdate {
 public:
  static constexpr int kWorth = 8;  ///< inliers that a patch counts as

  /// has_gate: false accepts every patch that is found, for comparisons.
  PatchUpdate(Filter& filter, Map& map, Frame& frame, TrackingState& tracking, const PatchNoise& noise, bool has_gate)
      : filter_(filter), map_(map), frame_(frame), tracking_(tracking), noise_(noise), has_gate_(has_gate) {}

  /// Predicts the corners on a plane. False where one does not project.
  bool predict(const StoredPatch& patch, int entry);
  /// Sets the corners that were found, with their noise, as the measurement.
  void set_measured(const StoredPatch& patch);
  /// Both. False where a corner does not project.
  bool predict_measured(const StoredPatch& patch, int entry);
  /// The same for the estimate, linearised at the pose `near`.
  bool predict_measured_near(const StoredPatch& patch, int entry, const Body& near);
  /// Finds the pose that the prior and this patch's corners make most likely.
  bool find_pose(const StoredPatch& patch, int entry, Body* near);
  /// Of the patch that was predicted last.
  const PatchMeasurement& measurement() const { return z_; }

  /// Chi-square of the corners after predict_measured(): eight degrees of freedom, with the gate's noise. Negative where it is not defined.
  /// *near: the pose that they are linearised at.
  Scalar misfit(const StoredPatch& patch, int entry, Body* near);
  /// Bound of that chi-square, and of all others of corners.
  Scalar gate() const;
  /// Whether this frame's corners allow the patch to lie on this plane. Predicts it there.
  bool may_explain(const StoredPatch& patch, int entry);

  /// Updates the filter where the corners pass the gate, after predict_measured().
  void update(StoredPatch* patch, int entry);
  /// Makes the patch a member of this plane, on which it is measured from this frame on.
  void join(StoredPatch* patch, int entry);

 private:
  using Mat8 = PatchMeasurement::Matrix;
  using Vec8 = PatchMeasurement::Vector;

  /// Variance of the linearisation's error where the plane causes the innovation r. Corners move in proportion to the parallax p and to 1 /
  /// depth, so the depth is wrong by a share r / p, and the rows by the same share: (r r / p)^2. [px^2]
  Scalar nonlinearity(const StoredPatch& patch) const;
  /// For a plane that is far from its estimate. Updates with the part of the information that the linearisation's error allows, and
  /// predicts the corners again; z_ then has the rest of the information. With B = nonlinearity I
  ///
  ///   R^-1 = (R + B)^-1 + (R + R B^-1 R)^-1
  ///
  /// False where the rest does not pass the gate.
  bool update_in_parts(const StoredPatch& patch, int entry);
  /// Chi-square of the innovation with this noise; negative where it is not defined.
  Scalar chi_square(const Mat8& R) const;

  Filter& filter_;
  Map& map_;
  Frame& frame_;
  TrackingState& tracking_;
  const PatchNoise& noise_;
  const bool has_gate_;
  PatchMeasurement z_;
};

}  // namespace pf
