#pragma once

#include "keyframe_slam/loops/drift_chain.h"
#include "keyframe_slam/loops/place_measurement.h"
#include "keyframe_slam/tracking/motion.h"

/// Finds out where the window has drifted to, by older places that its camera comes back to (lib/docs/theory/places.md).

namespace pf {

class Archive;

class LoopFinder {
 public:
  LoopFinder(const Settings& settings, const KeyframeMap& map, const NoiseModel& noise, const ImageSearch& images,
             const PoseBelief& belief)
      : settings_(settings), map_(map), belief_(belief), places_(settings, map, noise, images) {}

  bool layout(Arena& arena) {
    if (settings_.kept.places > 0) data_ = arena.take<Data>(1);
    return places_.layout(arena);
  }
  void init() {
    places_.init();
    if (data_ != nullptr) *data_ = Data();
  }

  /// After a tracked frame that is no keyframe: compares its image with places about its view, where that differs from the last one that
  /// was compared. Two views that share little must say the same. Returns what they say, once.
  LoopClosure look(const KeyframeMotion& motion, Scalar depth, const DriftChain& chain);
  /// W or the map has moved: what earlier views say is of the map before.
  void forget() {
    if (data_ != nullptr) data_->views = 0;
  }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMinViews = 2;  ///< that say the same

  struct Data {
    CameraView asked;
    Scalar asked_depth = 0;  ///< 0: none was
    // What the last views say.
    int views = 0;
    int breaks = 0;                                           ///< of the chain then
    SimilarityError x = SimilarityError::Zero();              ///< about the origin
    SimilarityCovariance C = SimilarityCovariance::Zero();    ///< the same
    SimilarityCovariance sum = SimilarityCovariance::Zero();  ///< of the chain then
    Scalar log_odds = 0;                                      ///< against chance
    Scalar alike = 0;  ///< evidence against a place that looks alike, without the share of these and the drift
  };
  struct Near {
    int count = 0;
    int place[PlaceMeasurement::kMaxPlaces];  ///< entries, the nearest first
    Scalar d2[PlaceMeasurement::kMaxPlaces];
    void add(int entry, Scalar its_d2);
  };

  bool is_asked(const CameraView& view, Scalar depth) const;
  Near find_near(const CameraView& view, Scalar depth, const DriftChain& chain) const;
  LoopClosure compare(const KeyframeMotion& motion, const Near& near, const DriftChain& chain);
  Scalar log_drift(const CameraView& view, const Vec6& u, const Mat6& P) const;

  const Settings& settings_;
  const KeyframeMap& map_;
  const PoseBelief& belief_;
  PlaceMeasurement places_;
  Data* data_ = nullptr;  ///< null: there are no places
};

}  // namespace pf
