#pragma once

#include "base/arena.h"
#include "belief/pose_belief.h"
#include "filter/filter.h"
#include "filter_slam/features/corner_features.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/features/feature_search.h"
#include "filter_slam/features/match_noise.h"
#include "filter_slam/features/same_view.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/frame.h"
#include "frame/noise_model.h"
#include "frame/pose_hypotheses.h"
#include "frame/settings.h"
#include "map/map.h"

/// Measures an image: searches for the map's features, decides by their consensus, and updates the filter.

namespace pf {

class Archive;

/// How a frame is measured.
struct MeasureMode {
  bool starts = false;      ///< five inliers are enough: there is no map yet that a wrong pose could corrupt
  bool is_vague = false;    ///< the prediction is too vague: searches only where the image as a whole has moved
  Scalar median_depth = 1;  ///< of the last tracked frame's inliers
  /// The second-order error of baseline and open depth counts as one that stays with its feature.
  bool parallax_lasts = false;
  UpdateMode update;
};

class ImageFrontEnd {
 public:
  ImageFrontEnd(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
                PixelUpdate& update, PoseBelief& belief, NoiseModel& noise)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        update_(update),
        belief_(belief),
        hypotheses_(settings, belief),
        noise_(filter, map, frame, update, noise),
        search_(settings, filter, map, frame, update, noise_),
        corners_(settings, filter, map, frame, features, search_) {}

  bool layout(Arena& arena, int max_observations);
  void init();

  /// Prepares an image for the search. False if it shows nothing to track: black, white or blurred.
  bool begin_frame(const ImageView& image);
  /// Finds the map's features in the image, and updates the filter with them where the evidence is enough to accept the pose. Returns what
  /// the updates have found.
  UpdateOutcome measure(MeasureMode mode);
  /// Notes the view of a frame, and whether the frame updated the map (SameView).
  void note_view(bool taught, Scalar median_depth);
  /// Updates the noise model with the inliers' residuals after measure().
  void learn_noise();
  /// Updates masks and normals of templates with the inliers of measure().
  void learn_templates();

  FeatureSearch& search() { return search_; }
  CornerFeatures& corners() { return corners_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  int list_candidates();
  bool measure_listed(const MeasureMode& mode, bool follows, bool may_change);
  /// A run of listed candidates that were searched for together; those that were found come first.
  struct Range {
    int first, found, searched;
    bool is_last;  ///< all have been searched for
    bool follows;  ///< SearchMode
  };
  bool update_with_consensus(const Range& range, const MeasureMode& mode);
  PoseConsensus consensus_of(const Range& range, int inliers, const JointFit& fit);
  Scalar weigh(const Range& range, const PoseConsensus& consensus, const MeasureMode& mode);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  PixelUpdate& update_;
  PoseBelief& belief_;
  PoseHypotheses hypotheses_;
  MatchNoise noise_;
  FeatureSearch search_;
  CornerFeatures corners_;
  SameView same_view_;
  bool is_learnt_ = false;    ///< the map has been updated from this frame's view already
  bool is_measured_ = false;  ///< by measure(), so that candidates and matches are this frame's
  int listed_ = 0;            ///< candidates of the last frame that measure() has measured
  UpdateOutcome outcome_;     ///< of the updates that measure() has made so far
};

}  // namespace pf
