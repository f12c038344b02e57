#pragma once

#include <cstdint>

#include "base/arena.h"
#include "frame/frame.h"
#include "geometry/camera.h"
#include "track/thumbnail.h"
#include "vision/image_mask.h"
#include "vision/pyramid.h"

namespace pf {

/// What stands still in the picture while the picture as a whole moves: the carrier's own body, a date that is written over it. It is no
/// part of the scene, and is masked from then on (lib/docs/belief.md).
///
/// Each feature has the log-odds that it is fixed to the picture. Once the picture has moved by kMinFlow since a reference frame, by m at
/// the feature (as if the camera had only rotated, track/image_rotation.h), a feature whose pixel has moved by d since then adds
///
///   ln N(d; 0, kStill^2 I) - ln N(d; m, (kParallax |m|)^2 I),   bounded by +-kMaxStep
///
/// where parallax may add to m or take from it. A point that the camera keeps in view, moving around it, stands still for a while too; a
/// hand does not hold it to half a pixel. No pose is needed, so it works before there is one, and where what is fixed is most of what is
/// seen.
///
/// src  sequential test of two hypotheses (Wald 1947)
class FixedFeatures {
 public:
  /// max_features: entries of the feature table.
  bool layout(Arena& arena, int width, int height, int max_features);
  /// Nothing is fixed. also: masked besides, by the caller; may be null.
  void init(const ImageMask* also);
  /// After a frame's searches. Masks the surroundings of features that are fixed. True where so many of the frame's inliers have turned out
  /// to be that pose and map come from them, and are wrong.
  bool note(const Camera& camera, const Pyramid& image, const Frame& frame);

  /// What is fixed, and what the caller has masked.
  const ImageMask* mask() const { return &mask_; }

 private:
  struct Entry {
    std::uint16_t id = 0;               ///< of the feature, its last digits
    std::uint16_t u = kNowhere, v = 0;  ///< where it was in the reference frame [1 / kPerPixel px]
    std::int16_t log_odds = 0;          ///< [1 / kPerOdds]
  };
  static constexpr std::uint16_t kNowhere = 0xffff;  ///< not in the reference frame
  static constexpr Scalar kPerPixel = 16, kPerOdds = 1000;
  static constexpr int kCell = 8;  ///< [px] of the mask

  Scalar prior() const;
  void keep_reference(const Thumbnail& now, const Frame& frame);
  int weigh(const Camera& camera, const Quat& q_before_now, const Frame& frame);

  Entry* entry_ = nullptr;
  int capacity_ = 0;
  ImageMask mask_;
  Thumbnail reference_;
  bool has_reference_ = false;
  int age_ = 0;                ///< [frames] of the reference
  int fixed_ = 0, scene_ = 0;  ///< features that were judged so far
};

}  // namespace pf
