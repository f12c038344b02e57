#pragma once

#include "base/limits.h"
#include "filter/filter.h"
#include "filter_slam/patches/initialisation/patch_initialiser.h"
#include "filter_slam/patches/initialisation/patch_obstacles.h"
#include "filter_slam/patches/patch_refusals.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/patch_store.h"

namespace pf {

class Archive;

/// Decides when and where new patches begin: on the walls in view and, where the plan has none, beside them.
class PatchSelection {
 public:
  PatchSelection(const Settings& settings, const Filter& filter, const Map& map, const Frame& frame,
                 const PatchStore& store, const PatchRefusals& refusals, PatchInitialiser& initialiser)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        store_(store),
        refusals_(refusals),
        initialiser_(initialiser) {}

  void init();

  /// Initialises the patches that are wanted in this frame.
  void begin_patches(const Pyramid& image);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMaxSquares = 6;

  /// Initialises patches on one wall. Returns whether the wall has as many as wanted.
  bool begin_on_wall(const Pyramid& image, int wall, int wanted, int* camera);
  /// Initialises one patch where the plan has no wall; it waits for its plane. It never evicts another patch.
  void begin_beside_walls(const Pyramid& image, int* camera);
  bool may_begin_beside_walls(bool has_camera) const;
  /// How many patches should begin on a wall now. Those that will soon be too slanted or out of the image do not count, so that the next
  /// ones have frames in common with them.
  int wanted_on(int wall) const;
  /// Share of the next second for which a place stays in the image. Never 0, since a hand may reverse its motion.
  Scalar stay_in_view(const Vec3& middle_W) const;
  /// Lists the best squares of a lattice, the best first. Returns how many.
  int list_squares(const Pyramid& image, int wall, int side, const PatchObstacles& obstacles,
                   PatchSquare* square) const;
  /// Whether the wall (-1: no wall) is the nearest surface in all of a square; *cosine: of its slant in the middle.
  bool is_on_wall(int wall, const PatchSquare& square, Scalar* cosine, Vec3* middle_W) const;
  /// Whether no patch that is in view has its middle near the square's.
  bool is_free(const PatchSquare& square) const;

  const Settings& settings_;
  const Filter& filter_;
  const Map& map_;
  const Frame& frame_;
  const PatchStore& store_;
  const PatchRefusals& refusals_;
  PatchInitialiser& initialiser_;
  int in_vain_[kMaxPlanes] = {};  ///< frame in which each wall last had no place for another patch
  int in_vain_beside_ = 0;        ///< the same for places that no wall covers
};

}  // namespace pf
