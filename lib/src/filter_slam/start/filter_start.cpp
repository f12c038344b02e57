#include "filter_slam/start/filter_start.h"

#include "base/elapsed.h"
#include "base/table_entries.h"
#include "filter_slam/start/walls_apart.h"
#include "frame/tuning.h"
#include "geometry/lens_deviation.h"
#include "inertial/tuning.h"

namespace pf {
namespace {

/// Whether the target's points fit into the capacities.
bool fits(const Settings& settings, const Filter& filter, const Target& target) {
  constexpr int kPointRows = 3;  // of a point
  return target.count <= settings.max_features && kPointRows * target.count <= filter.room();
}

}  // namespace

bool FilterStart::layout(Arena& arena, int width, int height) {
  target_.layout(arena, width, height);
  recorder_.layout(arena);
  return mounting_.layout(arena);
}

void FilterStart::init() {
  data_ = Data();
  target_.init();
  recorder_.init();
  mounting_.init();
  beginning_.init();
  beginning_.clear_filter();
}

void FilterStart::start_over() {
  beginning_.clear_filter();
  recorder_.init();
  beginning_.forget_known();
  data_.has_place = false;
  if (map_.target_withdrawn) target_.init();
}

Status FilterStart::use_map(const SavedMap& saved, FilterMemory* memory) {
  const bool is_chosen =
      beginning_.known().given || target_.target().kind != TargetKind::kNone || map_.planes.has_known();
  if (is_chosen || tracking_.has_pose()) return Status::kState;
  const Camera lens = lens_of_map(settings_.lens, settings_.camera, saved.lens(), tuning::tracking::kMaxLensDeviation);
  filter_.set_lens(lens, settings_.lens);  // before there is a block
  const Status status = memory->load(saved, tracking_.map_id());
  if (status != Status::kOk) filter_.set_lens(settings_.camera, settings_.lens);
  if (status != Status::kOk) return status;
  const KeptPlace& place = memory->table()[0];
  data_.knows_scale = true;
  beginning_.begin_anywhere(place.q_WK, place.p_WK, place.depth);
  tracking_.set_has_pose(frame_.report.t_ns, true);
  return Status::kOk;
}

Status FilterStart::use_target(const Target& target) {
  if (tracking_.has_pose()) return Status::kState;  // in a loaded map
  if (beginning_.known().given && target.kind == TargetKind::kRectangle) return Status::kState;
  if (!fits(settings_, filter_, target)) return Status::kRange;
  const bool has_place = target.kind == TargetKind::kPoints || target.has_place;
  if (!has_place && map_.planes.has_known()) return Status::kState;  // they would be in another W
  target_.set_target(target);
  data_.has_place = has_place || beginning_.known().given;
  return Status::kOk;
}

Status FilterStart::use_pose(const KnownBody& known) {
  if (takes_images_only() || tracking_.has_pose()) return Status::kState;
  beginning_.use(known);
  data_.has_place = true;
  return Status::kOk;
}

int FilterStart::target_rows() const {
  constexpr int kCorners = 4;
  const Target& target = target_.target();
  return 3 * (target.kind == TargetKind::kRectangle ? kCorners : target.count);
}

/// Depths come from a record of the first frames, unless walls or a known speed of the first pose fix them.
bool FilterStart::needs_record() const {
  if (!beginning_.known().given) return true;
  if (map_.planes.has_known() && !map_.planes.has_apart()) return false;
  return !beginning_.has_known_speed();
}

/// Gives the filter its first pose: at a target where there is one, and without.
void FilterStart::begin(const Target* target, bool fitted) {
  data_.knows_scale = target != nullptr || !needs_record();
  beginning_.begin(target, fitted);
}

void FilterStart::start_with_observations() {
  begin(target_.has_target() ? &target_.target() : nullptr, false);
  features_.add_target_points(target_.target());
  // Without samples a camera that is under way has a wrong explanation of its first frames as often as one of pictures.
  if (settings_.inertial && !filter_.uses_samples() && !data_.knows_scale && needs_record()) recorder_.begin_start();
}

bool FilterStart::start_in_image() {
  TargetSighting sighting;
  const bool expected = target_.is_expected();
  const bool seen = expected && target_.find(settings_.camera, search_.tracker(), &sighting);
  if (!seen && expected && !tracking_.may_skip_target()) return false;
  target_.note_begin();
  if (!seen) {
    begin_without_target();
    return true;
  }
  if (frame_.report.frames > 1) beginning_.forget_known();  // it was the pose of the first frame
  begin(&target_.target(), true);
  features_.add_target_points(target_.target());
  add_target_matches(sighting);
  if (!settings_.inertial && !map_.planes.has_known()) recorder_.begin_check();
  tracking_.set_from_target();
  settings_.hooks.say("map ", tracking_.map_id(), " starts at the target: ", frame_.report.inliers,
                      " of its points are found");
  return true;
}

/// Sets walls apart that a known pose does not see. A start at a target does not need this: the target is in view.
void FilterStart::begin_without_target() {
  const KnownBody& known = beginning_.known();
  const bool may_use_walls = !settings_.inertial && known.given && map_.planes.has_known();
  if (may_use_walls && !sees_walls(filter_, map_, known.body)) {
    set_walls_apart(&map_.planes);
    beginning_.clear_all_but_walls();
  }
  begin(nullptr, false);
  if (needs_record())
    recorder_.begin_start();
  else if (!settings_.inertial && map_.planes.has_known())
    recorder_.begin_check();
}

/// The target's points are matched in the frame that shows them first.
void FilterStart::add_target_matches(const TargetSighting& sighting) {
  FrameReport& report = frame_.report;
  for (const int i : used_entries(map_.features)) {
    if (!map_.features[i].is_target) continue;
    Feature& f = map_.features[i];
    const Vec2 z = sighting.pixel[f.external_id];
    search_.remember(i, z, {sighting.pose.q_WC, sighting.pose.p_WC});
    f.observations = f.attempts = 1;
    ++report.inliers;
    frame_.add({i, f.id, MatchStatus::kInlier, BlockKind::kPoint, false, false, z, Mat2::Zero(), z, Scalar(0)});
  }
  report.attempts = report.matches = report.inliers;
}

Scalar FilterStart::look_for_walls() {
  if (!map_.planes.has_apart() || recorder_.is_recording()) return Scalar(0);
  const Vec3 first_W = beginning_.known().body.p_W;
  const Scalar scale = find_scale_by_walls(filter_, map_, frame_.report.t_ns, first_W);
  if (!(scale > Scalar(0))) return Scalar(0);
  filter_.join_planes_apart(scale, first_W);
  scale_tables(scale, first_W, &map_);
  for (int k = 0; k < map_.planes.capacity(); ++k) map_.planes[k].apart = false;
  data_.knows_scale = true;
  const std::uint32_t before = tracking_.map_id();
  tracking_.rename_map();
  frame_.correction.add(Similarity::about(first_W, scale));
  frame_.correction.rename(before);
  map_.anchors.move(before, tracking_.map_id(), Similarity::about(first_W, scale));
  settings_.hooks.say("walls of the plan come into view: map ", before, " is scaled by ", fixed(scale, 3),
                      " and goes on as map ", tracking_.map_id(), " in metres");
  return scale;
}

double FilterStart::map_age() const { return seconds(elapsed_ns(beginning_.begin_ns(), frame_.report.t_ns)); }

bool FilterStart::is_young() const { return map_age() < static_cast<double>(tuning::inertial::kYoungMap); }

bool FilterStart::may_become_metric() const {
  return !filter_.is_metric() && !data_.knows_scale && !map_.planes.has_known();
}

/// A map may be discarded while it is new, or where the camera has not moved since its first frame.
bool FilterStart::begin_anew_at_rest(std::int64_t begin_ns) {
  const bool pending = recorder_.progress().pending(), moved_before = begin_ns > beginning_.begin_ns();
  if (map_.planes.has_known() || !(pending || !moved_before || is_young())) return false;
  mounting_.keep();
  recorder_.init();
  frame_.correction = MapCorrection();
  if (moved_before) {
    if (!pending) tracking_.begin_map();
    beginning_.forget_known();  // it was the pose of the first frame
  }
  map_.features.clear();
  frame_.forget_all();
  beginning_.clear_filter();
  begin(nullptr, false);
  return true;
}

}  // namespace pf
