#pragma once

#include "base/arena.h"
#include "filter/filter.h"
#include "filter_slam/features/match_noise.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/followed_view.h"
#include "frame/frame.h"
#include "frame/image_search.h"
#include "frame/settings.h"
#include "map/map.h"

/// Finds the map's features in an image: lists those in view, predicts where they are, and searches there.

namespace pf {

class Archive;

/// Where features are searched for, and how their matches are treated.
struct SearchMode {
  /// Searches where the image as a whole has moved, where the prediction is vague. A match still has to pass the gate about its prediction.
  bool follows = false;
  bool parallax_lasts = false;  ///< MatchNoise::set
};

class FeatureSearch {
 public:
  FeatureSearch(const Settings& settings, Filter& filter, Map& map, Frame& frame, PixelUpdate& update,
                const MatchNoise& noise)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), update_(update), noise_(noise) {}

  bool layout(Arena& arena, int max_observations);
  void init();

  /// Prepares an image for the search. False if it shows nothing to track: black, white or blurred.
  bool begin_frame(const ImageView& image) { return search_.begin_frame(image); }

  /// Lists visible features as candidates and matches, the most reliable first. Returns how many.
  int list_visible();
  /// Predicts pixel and search ellipse of candidates.
  void predict_pixels(int first, int count);
  /// Searches for candidates, and moves those that are found to the front of their range. Returns how many.
  int search(int first, int count, const SearchMode& mode);
  /// Largest semi-axis of the gates of the first `count` candidates [px].
  Scalar widest_ellipse(int count) const;
  /// Area that was searched for a candidate [px^2], at most that of the image.
  Scalar searched_area(int i, bool follows) const;
  /// The same of a range of candidates; valid until the next call and the next list.
  const Scalar* searched_areas(int first, int count, bool follows);

  /// Where the prediction of the `count` listed candidates is vague: finds where the image as a whole has moved, for searches that follow
  /// it. False where the prediction is not vague, or the image does not show its motion.
  bool find_followed(int count);
  /// After a frame's searches: ImageSearch::note_fixed.
  bool note_fixed(bool has_pose);
  /// At the end of a frame: by how much the map has moved.
  void follow(const Similarity& T) { search_.fixed().follow(T); }
  /// Keeps the view of a frame that used matches, from which the next one may be followed.
  void keep_view() { followed_.keep(search_.tracker().pyramid(), filter_.state().body.q_WC, filter_.state().body.p_W); }
  /// The map is discarded, and with it all poses.
  void forget_view() {
    followed_.init();
    search_.fixed().forget_view();
  }

  /// Stores the pixels around this pixel as the feature's appearance. False if the pixel is too near to the border.
  bool remember(int feature, const Vec2& pixel, const CameraView& view) {
    return search_.remember(&map_, feature, pixel, view);
  }
  /// Updates masks and normals of templates with the inliers among the first `count` candidates, after the update.
  void learn_templates(int count);

  const Tracker& tracker() const { return search_.tracker(); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  bool is_visible(int feature, Vec2* pixel) const;
  float rate(int feature, const Vec2& pixel) const;
  bool is_wide(const Mat2& innovation) const;
  bool aim(SearchTask* task) const;
  SearchTask task_of(int feature) const;

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  PixelUpdate& update_;
  const MatchNoise& noise_;
  ImageSearch search_;
  FollowedView followed_;
  Scalar* scratch_ = nullptr;  ///< max_observations: rates of candidates, then the areas that were searched
};

}  // namespace pf
