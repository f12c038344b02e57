#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/features/image_front_end.h"
#include "filter_slam/pose/pixel_update.h"
#include "filter_slam/recovery/relocaliser.h"
#include "frame/fit_warnings.h"
#include "frame/frame.h"
#include "frame/noise_model.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"

/// Tracks the camera in images: measures them, finds the map again, and learns from what was found.

namespace pf {

class Archive;

class ImageTracking {
 public:
  ImageTracking(const Settings& settings, Filter& filter, Map& map, Frame& frame, TrackingState& tracking,
                FeatureKeeper& features, PixelUpdate& update)
      : settings_(settings),
        filter_(filter),
        frame_(frame),
        tracking_(tracking),
        front_end_(settings, filter, map, frame, features, update, tracking.belief(), noise_),
        relocaliser_(settings, filter, map, frame, front_end_.search(), update, tracking.belief()) {}

  /// memory: may be null.
  bool layout(Arena& arena, FilterMemory* memory);
  void init();
  /// The map is discarded, and with it all poses.
  void forget_map();

  /// Measures the frame, ImageFrontEnd::measure. is_lost: the last frame did not support its pose; the map is then searched for about other
  /// poses too where the prediction is vague.
  UpdateOutcome recover_or_measure(const MeasureMode& mode, bool is_lost);
  /// True where the map has come from features that stand still in the image (FixedFeatures).
  bool is_map_fixed() const { return is_map_fixed_; }
  /// Learns the noise of matches from the inliers' residuals, and warns where they fit badly.
  void learn_noise();
  /// After a frame of any kind. image_usable: it is an image that shows something to track.
  void keep_view(bool image_usable, const StartProgress& start, Scalar median_depth);

  ImageFrontEnd& front_end() { return front_end_; }
  Relocaliser& relocaliser() { return relocaliser_; }
  const Relocaliser& relocaliser() const { return relocaliser_; }
  const NoiseModel& noise() const { return noise_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  const Settings& settings_;
  Filter& filter_;
  Frame& frame_;
  TrackingState& tracking_;
  NoiseModel noise_;
  FitWarnings warnings_;  ///< kept between frames
  bool is_map_fixed_ = false;
  ImageFrontEnd front_end_;
  Relocaliser relocaliser_;
};

}  // namespace pf
