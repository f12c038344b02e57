#pragma once

#include "bundle/bundle_adjuster.h"
#include "frame/noise_model.h"
#include "keyframe_slam/adjustment/held_target.h"
#include "keyframe_slam/adjustment/keyframe_bundle.h"
#include "keyframe_slam/adjustment/keyframe_choice.h"
#include "keyframe_slam/planes/planes.h"

/// Adjusts keyframes and the points that they see, with a few older keyframes that see the same points held fixed. Points on a plane are
/// held to it, and the plane is adjusted with them; so is the lens, where the settings have it as uncertain.

namespace pf {

class Archive;

/// What an adjustment took part in.
struct AdjustmentShape {
  int keyframes = 1;               ///< whose pixels count
  bool is_determined = false;      ///< there are covariances
  bool is_away = false;            ///< the map's first keyframe is not connected with the newest one
  Mat6 given_held = Mat6::Zero();  ///< covariance of the newest keyframe's (theta, p), given those that were held fixed
  Scalar span = 0;                 ///< largest distance of two of these, or of one and the newest
  int hangs_on = 0;                ///< number of the newest of the others; 0: none
};

/// What the map about the newest keyframe may have moved in W since the keyframe before.
struct MapDrift {
  bool any = false;
  Mat6 Q = Mat6::Zero();   ///< of (theta, p)
  Scalar sigma_scale = 0;  ///< the share by which its size may have changed
};

class KeyframeAdjustment {
 public:
  KeyframeAdjustment(const Settings& settings, KeyframeMap& map, KeyframePlanes& planes, const NoiseModel& noise)
      : settings_(settings), map_(map), planes_(planes), noise_(noise) {}

  bool layout(Arena& arena);
  void init() {
    map_covariance_.setZero();
    shape_ = AdjustmentShape();
    target_.init();
  }

  /// settled: the record of the start has ended. Adjusts all keyframes then, with the lens where the settings estimate it; during the
  /// record the newest ones, with the lens fixed. False: there is nothing to adjust yet.
  bool run(bool settled);
  /// Of the newest keyframe's (theta, p) in W, and with it of the map about it, given the map's first keyframe.
  const Mat6& map_covariance() const { return map_covariance_; }
  const AdjustmentShape& shape() const { return shape_; }
  /// Where no keyframe that was held is the map's first, the newest one may have moved against W by its share of what it may have moved
  /// against those that were held, and its size by that over their span with it.
  MapDrift drift() const;
  /// Variance of ln rho of a point, by the last adjustment and given the keyframes that it held: others are not taken as exact. Zero where
  /// the point had no part in it, or nothing was determined.
  Scalar log_rho_variance(int row) const;
  /// What the newest keyframe may be off in W in addition to what it may be off against those that were held.
  void set_place_covariance(const Mat6& of_held);
  /// The map may be off by more, until the next adjustment.
  void add_to_map(const Mat6& covariance) { map_covariance_ += covariance; }
  /// The camera has been found at a place of this covariance: what it sees is known no better, until the next adjustment.
  void begin_at(const Mat6& place) { map_covariance_ = place; }
  /// All of W is moved.
  void move(const Similarity& T) {
    map_covariance_ = T.of_pose_covariance(map_covariance_);
    shape_.given_held = T.of_pose_covariance(shape_.given_held);
    shape_.span *= T.s;
  }
  HeldTarget& target() { return target_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  Scalar sigma_px() const;
  void adjust(bool with_lens, const RhoPrior& prior, const BundleDistance* held);
  void note_covariance(const Mat6& given_held);
  void take_keyframes();
  void take_points();
  void reject_outliers(int i);

  const Settings& settings_;
  KeyframeMap& map_;
  KeyframePlanes& planes_;
  const NoiseModel& noise_;
  BundleAdjuster adjuster_;
  KeyframeChoice choice_{settings_, map_};
  HeldTarget target_;
  KeyframeBundle bundle_;
  Mat6 map_covariance_ = Mat6::Zero();
  AdjustmentShape shape_;
};

}  // namespace pf
