#pragma once

#include <utility>

#include "filter/filter.h"
#include "filter_slam/pose/leave_one_out.h"
#include "filter_slam/pose/proposed_poses.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"

/// Updates the filter with a frame's pixels: expected innovations, the update, and its relinearisation.

namespace pf {

/// A feature that this frame measures. The observation of the same index holds its prediction and its pixel.
struct Candidate {
  int feature;                ///< entry of the feature table
  int match;                  ///< index in the frame's matches
  Mat2 noise = Mat2::Zero();  ///< of a match in an image by itself, NoiseModel::match
  Scalar log_density = 0;     ///< of the found pixel about where the image has moved [ln px^-2]
};

/// What an update with a frame's pixels does.
struct UpdateMode {
  EstimatedRows rows;
  /// While most measured depths are open, pixels update the map, and the pose is considered (lib/docs/theory/inertial.md, "Depths first").
  bool depths_first = false;
  Scalar max_pose_nis = 0;  ///< the first update of a frame is rejected where its pose NIS is above this; 0: no bound
  bool as_usual = false;    ///< and where fewer points are found than usual (FindShare): there is another prediction
};

/// What the updates of a frame have found.
struct UpdateOutcome {
  bool is_applied = false;       ///< the last of them
  double nis = 0;                ///< normalised innovation squared of the last one
  bool is_contradicted = false;  ///< one was rejected by max_pose_nis; no later one is made
  bool is_pose_open = false;     ///< pixels contradict the pose that depths_first considers; depths_first ends
};

class PixelUpdate {
 public:
  PixelUpdate(const Settings& settings, Filter& filter, Map& map, Frame& frame, TrackingState& tracking)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), tracking_(tracking) {}

  bool layout(Arena& arena, int max_observations);

  /// max_observations each. The update uses those with keep != 0.
  Candidate& candidate(int i) { return candidate_[i]; }
  const Candidate& candidate(int i) const { return candidate_[i]; }
  PixelMeasurement& observation(int i) { return observation_[i]; }
  const PixelMeasurement* observations() const { return observation_; }
  unsigned char* keep() { return keep_; }

  /// Exchanges two candidates and their observations.
  void swap(int a, int b) {
    std::swap(candidate_[a], candidate_[b]);
    std::swap(observation_[a], observation_[b]);
  }

  /// H P H^T of a predicted pixel. Sets `bend`, the projection's second-order error over the pose uncertainty.
  Mat2 expected_innovation(PixelMeasurement* o) const;
  /// Computes H P H^T of `count` observations from `first` on.
  void begin(int first, int count);
  /// Rejects matches of begin()'s range that all the other kept ones contradict. Returns how many stay. fit: of these, with R_gate.
  int reject_contradicted(int first, int count, JointFit* fit);
  ProposedPoses& proposals() { return proposals_; }
  const ProposedPoses& proposals() const { return proposals_; }
  /// Proposes the pose that an update of these rows with the kept matches of begin()'s range would give; evidence: for this pose; depth:
  /// median, of the measured points. Returns its log-odds; `before` where the update cannot be made.
  Scalar propose(int first, int count, EstimatedRows rows, Scalar depth, Scalar before, Scalar evidence);
  /// Updates with the kept matches of begin()'s range. Where the update is not applied, nothing changes. before: outcome of the frame's
  /// earlier updates. Returns the outcome of all.
  UpdateOutcome apply(int first, int count, const UpdateMode& mode, const UpdateOutcome& before = UpdateOutcome());

 private:
  PartlyConsidered undecided_walls(int first, int count, int* walls);
  void reject(int first, int count);
  void count_inliers(int first, int count);
  bool are_depths_open(int first, int count) const;
  void relinearise_update(int first, int count, EstimatedRows rows);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  TrackingState& tracking_;
  Candidate* candidate_ = nullptr;
  PixelMeasurement* observation_ = nullptr;
  unsigned char* keep_ = nullptr;
  /// Scratch behind keep_, of each match: frames in which its feature was measured, up to 255; whether it updates walls.
  unsigned char* scratch_ = nullptr;
  LeaveOneOut others_;
  ProposedPoses proposals_{settings_, filter_};
};

}  // namespace pf
