#pragma once

#include "filter/filter.h"
#include "filter_slam/patches/membership/patch_founding.h"
#include "filter_slam/patches/patch_finder.h"
#include "filter_slam/patches/patch_refusals.h"
#include "filter_slam/patches/patch_sight.h"
#include "filter_slam/patches/patch_update.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/patch_store.h"

namespace pf {

class Archive;

/// Decides which plane a patch lies on. Until that is decided the patch is followed and does not update the filter
/// (lib/docs/theory/walls.md). Servant 2008, section 2.5
class PatchMembership {
 public:
  PatchMembership(const Settings& settings, Filter& filter, const Map& map, const Frame& frame, const PatchStore& store,
                  PatchFinder& finder, PatchUpdate& update, PatchRefusals& refusals, PatchFounding& founding)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        store_(store),
        finder_(finder),
        update_(update),
        refusals_(refusals),
        founding_(founding) {}

  /// Follows a waiting patch, and decides whether its plane is known. Where nothing else supports the pose, the nearest plane that passes
  /// counts at once, without evidence against the others. is_young: as PatchKeeper::measure. is_contested: nothing is decided in this
  /// frame.
  void measure(const Pyramid& image, bool is_young, bool is_contested, StoredPatch* patch);
  /// Keeps the pose of the frame in which the corners were found.
  void end_frame() { q_last_ = filter_.state().body.q_WC; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// Predicts a waiting patch: by the plane that explained the last frame, or else at its last place, rotated with the camera.
  bool expect(const StoredPatch& patch, PatchSight* sight) const;
  /// False where the patch is not found.
  bool follow(const Pyramid& image, bool supported, StoredPatch* patch);
  /// Adds the rows of a patch that is found for the first time: only then the reference's noise of its corners is known.
  bool add_block(StoredPatch* patch, const PatchMeasurement::Matrix& covariance);
  /// Tries the planes that the patch may lie on, at most kMaxTrials. counts: this frame's results count for the decision. Returns the
  /// nearest plane that passes, or -1.
  int try_planes(StoredPatch* patch, bool counts);
  void decide(StoredPatch* patch);
  /// Joins the plane with this id, unless other measurements show that the patch is before it.
  void join(StoredPatch* patch, std::uint32_t id);
  /// Notes that the wall which was seen there when the patch began does not explain it.
  void refuse(StoredPatch* patch);

  const Settings& settings_;
  Filter& filter_;
  const Map& map_;
  const Frame& frame_;
  const PatchStore& store_;
  PatchFinder& finder_;
  PatchUpdate& update_;
  PatchRefusals& refusals_;
  PatchFounding& founding_;
  Quat q_last_ = Quat::Identity();  ///< q_WC of the last frame, where the corners were
};

}  // namespace pf
