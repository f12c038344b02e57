#include "filter_slam/planes/plane_trials.h"

#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "belief/plane_membership.h"
#include "belief/tuning.h"
#include "filter_slam/planes/plane_points.h"
#include "filter_slam/planes/tuning.h"
#include "frame/tuning.h"

namespace pf {

using namespace tuning::plane_trials;

Scalar PlaneTrials::log_odds(int entry, int plane_entry) const {
  Scalar s, v;
  Vec3 ray_W, n_W;
  Scalar d_W;
  if (!places_.depth(entry, &s, &v, &ray_W)) return Scalar(0);
  const int plane = map_.planes[plane_entry].slot;
  const Block& block = filter_.state().block[plane];
  plane_normal(filter_.state().frame_of(block), block.xyz(), &n_W, &d_W);
  const Scalar range = ray_W.norm(), slant = std::abs(n_W.dot(ray_W)) / range;
  if (!(slant > kMinSlant)) return Scalar(0);
  // The plane's variance has the drift of the whole world in it, which the feature shares: at most what its points may be off by.
  const Scalar limit = settings_.plane_distance * settings_.plane_distance;
  const Scalar of_plane = std::min(filter_.plane_variance(plane, filter_.point(map_.features[entry].slot)), limit);
  const Scalar roughness = settings_.fold.roughness;
  const Scalar t = std::sqrt(of_plane + roughness * roughness) / slant;
  return log_odds_on_plane(s, v * kPixel * kPixel, t, settings_.inverse_depth_relative_sigma * range);
}

void PlaneTrials::judge() {
  for (const int i : used_entries(map_.features)) {
    if (!map_.features[i].on_trial) continue;
    Feature& f = map_.features[i];
    const int entry = map_.planes.entry_at(filter_.state().plane_of(f.slot));
    const Scalar odds = entry < 0 ? Scalar(0) : log_odds(i, entry);
    const bool elsewhere = odds < -kDoubt;
    if (elsewhere) ++map_.planes[entry].outliers;
    if (f.rejections >= tuning::plane_keeper::kTrialRejections || elsewhere) {
      features_.drop(&i, 1);
    } else if (!f.was_missed && odds > tuning::plane_membership::kSure) {
      f.on_trial = false;
      if (map_.planes[entry].outliers > 0) map_.planes[entry].outliers = map_.planes[entry].outliers - 1;
      support(filter_, map_, entry, f.slot);
    }
  }
}

}  // namespace pf
