#pragma once

#include "frame/followed_view.h"
#include "frame/image_search.h"
#include "frame/noise_model.h"
#include "keyframe_slam/planes/planes.h"
#include "keyframe_slam/tracking/expected_pixel.h"
#include "map/given_pixels.h"

/// Lists the points of the map that should be in view, and searches for them in the image, or takes the pixels that the caller has found.

namespace pf {

class Archive;

/// A point that is searched for in this frame.
struct SearchedPoint {
  int match;        ///< of the frame
  Mat2 noise;       ///< of its match
  Scalar searched;  ///< area [px^2]
};

/// The list has points with a depth first, and behind them those without. What a search finds moves to the front.
class PointSearch {
 public:
  PointSearch(const Settings& settings, KeyframeMap& map, const KeyframePlanes& planes, Frame& frame,
              const NoiseModel& noise, const GivenPixels& given)
      : settings_(settings), map_(map), planes_(planes), frame_(frame), noise_(noise), given_(given) {}

  bool layout(Arena& arena);
  void init();
  /// Prepares an image, with an empty list; null: the frame has given pixels. False if it shows nothing to track.
  bool begin_frame(const ImageView* image);

  /// Lists the points with a depth, the most reliable first, in place of all that was listed. Returns how many.
  int list_placed(const PosePrior& at);
  /// Lists points without a depth behind those with one that this frame has listed. Returns how many. depth: the median one.
  int list_unplaced(const PosePrior& at, Scalar depth);
  /// Listed points with a depth.
  int placed() const { return placed_; }
  /// Predicts points with a depth again, from a better pose.
  void predict_again(int first, int count, const PosePrior& at);
  /// Of the first `found` points, which were found, keeps those of is_kept at the front, in their order; the others are missed. Returns
  /// how many are kept.
  int forget_others(int found, const unsigned char* is_kept);
  /// Searches for a range of the list, and moves points that are found behind the first `found` ones, which were found before. Returns how
  /// many have been found in all.
  int search(int found, int first, int count, const PosePrior& at, Scalar depth);

  const SearchedPoint& point(int c) const { return point_[c]; }
  Match& match(int c) { return frame_.match(point_[c].match); }
  const Match& match(int c) const { return frame_.match(point_[c].match); }
  /// Largest variance of the first `count` points along any direction [px^2].
  Scalar widest(int count) const;

  /// Where most ellipses are wide: finds where the image as a whole has moved, for searches that follow it. False: they are not wide, or
  /// the image does not show its motion.
  bool find_followed();
  /// After a frame's searches: ImageSearch::note_fixed.
  bool note_fixed(const CameraView& view);
  /// At the end of a frame: by how much the map has moved.
  void follow(const Similarity& T) { images_.fixed().follow(T); }
  /// Keeps the view of a frame that supported its pose, from which the next one may be followed.
  void keep_view(const CameraView& view) {
    if (!given_.are_given()) followed_.keep(images_.tracker().pyramid(), view.q_WC, view.c_W);
  }
  /// The map is discarded, and with it all poses.
  void forget_view() {
    followed_.init();
    images_.fixed().forget_view();
  }

  /// Updates masks and normals of templates with this frame's inliers.
  void learn_templates(const PosePrior& at);

  const ImageSearch& images() const { return images_; }
  /// False where the caller gives this frame's pixels, which no second search changes.
  bool has_image() const { return !given_.are_given(); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  int list(const PosePrior& at, bool placed, Scalar depth);
  bool aim(int i, SearchTask* task) const;
  bool find(int c, const PosePrior& at, Scalar depth);
  SearchTask task_of(int i, const PosePrior& at, Scalar depth) const;

  const Settings& settings_;
  KeyframeMap& map_;
  const KeyframePlanes& planes_;
  Frame& frame_;
  const NoiseModel& noise_;
  const GivenPixels& given_;
  ImageSearch images_;
  FollowedView followed_;
  SearchedPoint* point_ = nullptr;  ///< one for each point of the map
  int placed_ = 0;
};

}  // namespace pf
