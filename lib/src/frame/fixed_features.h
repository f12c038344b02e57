#pragma once

#include <cstdint>

#include "base/arena.h"
#include "frame/frame.h"
#include "geometry/camera.h"
#include "map/feature_table.h"
#include "vision/image_mask.h"

namespace pf {

class Archive;

/// Finds features that stand still in the image while the rest moves: the carrier's own body, a date that is written over the image. They
/// are no part of the scene, and their surroundings are masked from then on (lib/docs/theory/belief.md).
///
/// Since a reference frame most features have moved by kMinFlow or more, as if the camera had rotated; this rotation moves the image at a
/// feature by m. A feature whose pixel has moved by d then adds
///
///   ln N(d; 0, kStill^2 I) - ln N(d; m, (kParallax |m|)^2 I),   bounded by +-kMaxStep
///
/// to the evidence that it is fixed to the image; parallax may add to m or subtract from it. While the camera translates past what is near,
/// the far stands still as what is fixed does: an inlier of the pose adds nothing where most of what has moved are inliers too. Its log-odds are this evidence plus those of
/// the share of fixed features, which is estimated from the features' own probabilities, so that one among many is recognised soon. A point
/// around which the camera moves stands still for a while, too, but a hand does not hold it to half a pixel. No pose is needed where there is none.
///
/// src  sequential test of two hypotheses (Wald 1947); share as in expectation maximisation (Dempster 1977)
class FixedFeatures {
 public:
  /// max_features: entries of the feature table.
  bool layout(Arena& arena, int width, int height, int max_features);
  /// Begins without fixed features. also: the caller's mask; may be null.
  void init(const ImageMask* also);
  /// After a frame's searches: masks the surroundings of features that are fixed, and counts these as no points of the scene. True where so
  /// many of the frame's inliers are fixed that pose and map have come from them.
  bool note(const Camera& camera, const Frame& frame, FeatureTable* features);

  /// Mask of what is fixed, and of what the caller has masked.
  const ImageMask* mask() const { return &mask_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Entry {
    std::uint16_t id = 0;               ///< of the feature, its last digits
    std::uint16_t u = kNowhere, v = 0;  ///< where it was in the reference frame [1 / kPerPixel px]
    std::int16_t evidence = 0;          ///< [1 / kPerOdds]
  };
  static constexpr std::uint16_t kNowhere = 0xffff;  ///< not in the reference frame
  static constexpr Scalar kPerPixel = 16, kPerOdds = 1000;
  static constexpr int kCell = 8;  ///< [px] of the mask

  Scalar log_odds(const Entry& entry) const { return prior_ + static_cast<Scalar>(entry.evidence) / kPerOdds; }
  bool has_reference(const Frame& frame) const;
  bool before(const Match& match, Vec2* pixel) const;
  bool find_turn(const Camera& camera, const Frame& frame, Quat* q_before_now) const;
  void keep_reference(const Frame& frame);
  bool is_explained(const Frame& frame) const;
  void weigh(const Camera& camera, const Quat& q_before_now, const Frame& frame);
  void estimate_share();
  int mask_fixed(const Frame& frame, FeatureTable* features);

  Entry* entry_ = nullptr;
  int capacity_ = 0;
  ImageMask mask_;
  int age_ = 0;       ///< [frames] of the reference; 0: there is none
  Scalar prior_ = 0;  ///< log-odds of a feature without evidence
};

}  // namespace pf
