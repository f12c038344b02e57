#include "filter_slam/planes/plane_keeper.h"

#include "base/table_entries.h"
#include "filter_slam/planes/plane_folding.h"
#include "filter_slam/planes/plane_lifecycle.h"
#include "filter_slam/planes/plane_merger.h"
#include "filter_slam/planes/plane_revision.h"
#include "filter_slam/planes/plane_trials.h"
#include "filter_slam/planes/walls/wall_doubt.h"
#include "frame/tuning.h"

namespace pf {

PlaneKeeper::PlaneKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features)
    : settings_(settings),
      filter_(filter),
      map_(map),
      frame_(frame),
      features_(features),
      places_(filter, map, frame),
      certain_(settings, filter, map),
      discovery_(settings, filter, map, certain_, places_),
      walls_(settings, filter, map, certain_),
      verticals_(filter, map) {}

bool PlaneKeeper::layout(Arena& arena, int max_features) {
  discovery_.layout(arena, max_features);
  if (settings_.inertial) verticals_.layout(arena);
  return places_.layout(arena, max_features);
}

void PlaneKeeper::init() {
  discovery_.init();
  walls_.init();
  places_.init();
  verticals_.init();
}

void PlaneKeeper::maintain(bool may_doubt) {
  places_.update();
  PlaneTrials(settings_, filter_, map_, features_, places_).judge();
  unfold_outliers(settings_, filter_, map_);
  certain_.update_scale();
  const int planes = map_.planes.capacity(), turn = frame_.report.frames % planes;
  for (int k = 0, maintained = 0; k < planes; ++k) {
    const int i = (turn + k) % planes;
    if (!map_.planes.used(i) || map_.planes[i].apart) continue;
    ++map_.planes[i].age;
    // A wall that patches contradict is judged at once, since what begins on it is wrong.
    if (may_doubt && map_.planes[i].is_refused_by_patches() && !map_.planes[i].doubted) judge_wall(i);
    if (maintained++ == 0) maintain_plane(i, may_doubt);
  }
  dissolve_weak(settings_, filter_, map_, features_);
  places_.end_with_planes();
  const bool is_due = frame_.report.frames % tuning::plane_keeper::kDiscoverEvery == 0;
  if (!is_due && !discovery_.has_lost()) return;
  certain_.update_scale();  // its points may be gone or planar since
  discovery_.resume();
  if (is_due) discovery_.discover();
}

void PlaneKeeper::maintain_plane(int entry, bool may_doubt) {
  PlaneRevision(settings_, filter_, map_, frame_, places_).revise(entry);
  fold_into(settings_, filter_, map_, certain_, entry);
  if (map_.planes[entry].known) {
    certain_.update_scale();  // its points may be planar since
    walls_.fold_by_consensus(entry);
    certain_.update_scale();
    if (may_doubt) judge_wall(entry);
  }
  settle_frame(filter_, map_, entry);
  PlaneOutline now;
  outline_plane(filter_, map_, entry, &now);
  map_.planes[entry].seen = now;
  if (settings_.fix_sigma > Scalar(0)) fix_on(settings_, filter_, map_, entry);
  PlaneMerger(settings_, filter_, map_, features_, verticals_).merge_into(entry);
}

void PlaneKeeper::judge_wall(int entry) {
  WallDoubt(settings_, filter_, map_, frame_, features_, certain_).judge(entry);
}

Status PlaneKeeper::add_wall(const PlanePrior& prior, int reserved_rows, bool may_evict, std::int64_t not_since_ns,
                             std::uint32_t* id) {
  constexpr int kRows = 3;
  if (filter_.state().planes >= filter_.state().max_planes) return Status::kFull;
  if (filter_.room() < kRows + reserved_rows &&
      !(may_evict && features_.make_rows(kRows + reserved_rows, not_since_ns)))
    return Status::kFull;
  const Mat3 J = plane_error_jacobian();
  const Mat3 covariance = J.lazyProduct(prior.covariance).lazyProduct(J.transpose());
  const Scalar roughness = prior.roughness > Scalar(0) ? prior.roughness : settings_.fold.roughness;
  const int slot = filter_.add_known_plane(prior.frame, covariance, roughness);
  if (slot < 0) return Status::kFull;
  const int entry = map_.planes.add(slot);  // the table has as many rows as the filter has planes
  filter_.set_owner(slot, entry);
  PlaneEntry& wall = map_.planes[entry];
  wall.known = true;
  for (int i = 0, k = 0; i < kRows; ++i)
    for (int j = 0; j <= i; ++j) wall.prior[k++] = covariance(i, j);
  wall.two_sided = prior.two_sided;
  wall.roughness = roughness;
  wall.plan = wall.seen = wall.support = prior.outline;
  *id = wall.id;
  return Status::kOk;
}

void PlaneKeeper::meet_walls() {
  walls_.note_late_walls();
  for (const int i : used_entries(map_.planes))
    if (!map_.planes[i].known) dissolve_plane(filter_, map_, features_, settings_.fold.roughness, i);
  for (const int i : used_entries(map_.planes)) {
    certain_.update_scale();
    walls_.fold_by_consensus(i);
  }
  places_.end_with_planes();
}

}  // namespace pf
