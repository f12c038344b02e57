#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/patches/initialisation/patch_obstacles.h"
#include "filter_slam/patches/patch_noise.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/patch_store.h"

namespace pf {

/// Removes a patch from the store and the filter. Its reference camera goes with the last patch that needs it.
void drop_patch(Filter& filter, PatchStore& store, int entry);

/// Initialises patches, and makes room for them.
class PatchInitialiser {
 public:
  static constexpr int kCameraRows = 6;  ///< of the state, for a reference camera

  PatchInitialiser(const Settings& settings, Filter& filter, const Map& map, const Frame& frame, PatchStore& store,
                   FeatureKeeper& features, PatchNoise& noise)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        store_(store),
        features_(features),
        noise_(noise) {}

  /// Initialises a patch at a square of the image, on a wall (-1: on none; it waits for its plane). *camera: the reference camera of this
  /// frame's patches; -1: there is none yet, and it is added. False without room.
  bool initialise(const ImageView& image, int wall, const PatchSquare& square, int* camera);
  /// Whether there is room for another camera.
  bool has_camera_left() const { return store_.cameras() < settings_.max_cameras; }

 private:
  /// Makes room for a patch, and a camera: in the store, among the cameras and in the state. False: there is none.
  bool make_room(int rows, bool for_camera);
  /// Drops all patches of the camera whose patches have been out of view for longest. False where each camera has one in view.
  bool drop_oldest_camera();
  /// With a rolling shutter, moves the corners of the reference to where the camera at the frame's own time sees the same places of the
  /// wall; at infinity where there is no wall.
  void correct_rows(int wall, StoredPatch* patch) const;

  const Settings& settings_;
  Filter& filter_;
  const Map& map_;
  const Frame& frame_;
  PatchStore& store_;
  FeatureKeeper& features_;
  PatchNoise& noise_;
};

}  // namespace pf
