#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/features/same_view.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/corner_cells.h"
#include "frame/followed_view.h"
#include "frame/frame.h"
#include "frame/image_search.h"
#include "frame/noise_model.h"
#include "frame/settings.h"
#include "map/map.h"

/// Measures an image: predicts which features are in it and where, finds them, updates the filter, and adds features at corners.

namespace pf {

/// When a frame's consensus is believed.
enum class ConsensusRule {
  kStart,         ///< five agree: there is no map yet that could be spoilt
  kMostAgree,     ///< as below, or at least eight and half of what was searched for: the map is too young to show more
  kBeyondChance,  ///< at least eight, far more than chance would give
  kFollowed,      ///< likewise, where what agrees closely says more: of a camera that was tracked up to here
};

class ImageFrontEnd {
 public:
  ImageFrontEnd(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
                PixelUpdate& update, NoiseModel& noise)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        features_(features),
        update_(update),
        noise_(noise) {}

  bool layout(Arena& arena, int max_observations);
  void init();

  /// Prepares an image for the search. False if it shows nothing to track: black, white or blurred.
  bool begin_frame(const ImageView& image);
  /// Finds the map's features in the image and updates the filter with them.
  /// median_depth: of the last tracked frame's inliers. parallax_lasts: what baseline and open depth make wrong together counts as an error
  /// that stays with its feature.
  void measure(ConsensusRule rule, Scalar median_depth, bool parallax_lasts);
  /// Where the camera is after a frame, and whether that taught the map. SameView
  void note_view(bool taught, Scalar median_depth) {
    if (taught)
      same_view_.note(filter_.state().body, median_depth, settings_.camera.fx);
    else
      same_view_.forget();
  }
  /// After a frame that used matches: the next one may be followed from it.
  void keep_view() { followed_.keep(search_.tracker().pyramid(), filter_.state().body.q_WC, filter_.state().body.p_W); }
  /// The map is given up, and with it all poses.
  void forget_map() { followed_.init(); }
  /// Updates the noise model with the inliers' residuals after measure().
  void learn_noise();
  /// Updates masks and normals of templates with this frame's inliers.
  void learn_templates();
  /// Adds features in the emptiest cells of the image until enough are in view.
  void add_features();
  /// Adds features at these pixels, which are those of others that have just left the map.
  void add_features_at(const Vec2* pixel, int count);
  /// Stores how a feature looks at this pixel of the image. False if the pixel is too near to the border.
  bool remember(int feature, const Vec2& pixel, const CameraView& view);

  const Tracker& tracker() const { return search_.tracker(); }

  // --- steps of a search
  /// Lists visible features as candidates and matches, the most reliable first. Returns how many.
  int list_visible();
  /// Predicts pixel and search ellipse of candidates.
  void predict_pixels(int first, int count);
  /// Searches for candidates, and moves those that are found to the front of their range. Returns how many.
  int search(int first, int count);
  bool most_agree(int first, int found) const;
  bool is_beyond_chance(int first, int found, ConsensusRule rule);
  /// Area that was searched for a candidate [px^2], at most that of the image.
  Scalar searched_area(int i) const;

 private:
  void measure_visible(ConsensusRule rule, bool follows);
  bool begin_following();
  // image_candidates.cpp
  bool is_visible(int feature, Vec2* pixel) const;
  float rate(int feature, const Vec2& pixel) const;

  // image_front_end.cpp
  Scalar widest_ellipse(int count) const;
  bool is_wide(const Mat2& innovation) const;
  bool aim(SearchTask* task) const;
  SearchTask task_of(int feature) const;
  bool update_with_consensus(int first, int found, ConsensusRule rule);
  bool is_averaged(const Feature& f) const;
  Mat2 update_noise(const Feature& f, const PixelMeasurement& o, const Mat2& noise) const;

  // image_corners.cpp
  bool add_in(const Rect& rect, const CornerStrength& least, int* anchor);
  CornerUse add_at(const Vec2& pixel, int* anchor);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  PixelUpdate& update_;
  NoiseModel& noise_;
  SameView same_view_;
  FollowedView followed_;
  bool is_following_ = false;    ///< searches go about the followed view's pixels
  bool parallax_lasts_ = false;  ///< in this frame, as measure() was told
  bool is_learnt_ = false;       ///< the map has learnt from this frame's view already
  bool is_measured_ = false;     ///< by measure(), so that candidates and matches are this frame's
  int listed_ = 0;               ///< candidates of this frame
  ImageSearch search_;
  Scalar* scratch_ = nullptr;  ///< max_observations: rates of candidates, then the areas that were searched
};

}  // namespace pf
