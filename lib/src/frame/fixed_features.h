#pragma once

#include <cstdint>

#include "base/arena.h"
#include "frame/frame.h"
#include "geometry/camera.h"
#include "geometry/similarity.h"
#include "map/feature_table.h"
#include "vision/appearance.h"
#include "vision/image_mask.h"

namespace pf {

class Archive;

/// The pose of a frame, and the places of features as the back end knows them.
struct KnownScene {
  CameraView view;
  const void* map;
  Vec3 (*place)(const void* map, int feature);  ///< in W; of a feature whose depth is known
};

/// Finds features that stand still in the image while the rest moves: the carrier's own body, a date that is written over the image. They
/// are no part of the scene, and their surroundings are masked from then on (lib/docs/theory/belief.md).
///
/// Since a reference frame most features have moved by kMinFlow or more. A point of the scene would have moved by m, and a feature whose
/// pixel has moved by d adds
///
///   ln N(d; 0, kStill^2 I) - ln N(d; m, (kStill^2 + (kParallax |m|)^2) I),   bounded by +-kMaxStep
///
/// to the evidence that it is fixed to the image.
///
/// Where most of what has moved are inliers of this frame's pose, m is by the poses of both frames: of a feature with a known place its
/// own flow, of another one that of the depth which suits all of its shifts best; that it has just this depth adds evidence, once in its
/// life. So what is far away may stand still beside a near wall. Else, and for features that are as old as the map's first such pose, the
/// features that have moved have done so as if the camera had rotated, and m is by that rotation; parallax may add to it or subtract from
/// it. (A young map may have come from what is fixed, and explains both.)
///
/// A feature's log-odds are this evidence plus those of the share of fixed features, which is estimated from the features' own
/// probabilities, so that one among many is recognised soon.
///
/// src  sequential test of two hypotheses (Wald 1947); share as in expectation maximisation (Dempster 1977)
class FixedFeatures {
 public:
  /// max_features: entries of the feature table.
  bool layout(Arena& arena, int width, int height, int max_features);
  /// Begins without fixed features. also: the caller's mask; may be null.
  void init(const ImageMask* also);
  /// After a frame's searches: masks the surroundings of features that are fixed, and counts these as no points of the scene. scene: null
  /// without a pose. True where so many of the frame's inliers are fixed that pose and map have come from them.
  bool note(const Camera& camera, const KnownScene* scene, Frame* frame, FeatureTable* features);
  /// At the end of a frame: the map has moved.
  void follow(const Similarity& T);
  /// The map is discarded, and with it all poses.
  void forget_view() {
    has_view_ = false;
    last_young_ = 0;
  }

  /// Mask of what is fixed, and of what the caller has masked.
  const ImageMask* mask() const { return &mask_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Entry {
    std::uint16_t id = 0;               ///< of the feature, its last digits
    std::uint16_t u = kNowhere, v = 0;  ///< where it was in the reference frame [1 / kPerPixel px]
    std::int16_t evidence = 0;          ///< [1 / kPerOdds]
    float rho = 0, weight = 0;          ///< of a feature without a known place: inverse depth by its shifts
  };
  static constexpr std::uint16_t kNowhere = 0xffff;  ///< not in the reference frame
  static constexpr Scalar kPerPixel = 16, kPerOdds = 1000;
  static constexpr int kCell = 8;  ///< [px] of the mask

  Scalar log_odds(const Entry& entry) const { return prior_ + static_cast<Scalar>(entry.evidence) / kPerOdds; }
  bool has_reference(const Frame& frame) const;
  bool before(const Match& match, Vec2* pixel) const;
  bool is_explained(const KnownScene& scene, const Frame& frame, Scalar* rho2);
  bool find_turn(const Camera& camera, const Frame& frame, Quat* q_before_now) const;
  void keep_reference(const KnownScene* scene, const Frame& frame);
  bool flow_of_scene(const Camera& camera, const KnownScene& scene, Scalar rho2, const Match& match, const Vec2& before,
                     Vec2* flow, Scalar* open);
  void weigh(const Match& match, Scalar log_ratio);
  void estimate_share();
  int mask_fixed(const Frame& frame, FeatureTable* features);

  Entry* entry_ = nullptr;
  int capacity_ = 0;
  ImageMask mask_;
  CameraView view_;  ///< of the reference
  bool has_view_ = false;
  std::uint32_t last_young_ =
      0;         ///< id of the newest feature when a pose of the map first explained what has moved; 0: none has yet
  int age_ = 0;  ///< [frames] of the reference; 0: there is none
  Scalar prior_ = 0;  ///< log-odds of a feature without evidence
};

}  // namespace pf
