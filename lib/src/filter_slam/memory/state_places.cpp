#include "filter_slam/memory/state_places.h"

#include <algorithm>

#include "base/table_entries.h"
#include "memory/returning_feature.h"
#include "memory/tuning.h"

namespace pf {
namespace {

using namespace tuning::place;

static_assert(KeptPlace::kMaxPoints <= 32, "a bit for each point");

constexpr int kCameraRows = 6 + 3, kPointRows = 3;  // with an anchor

/// 1 / w_n
Scalar inverse_weight(int n) { return static_cast<Scalar>(n) * static_cast<Scalar>(n + 1); }

}  // namespace

bool StatePlaces::layout(Arena& arena) {
  table_.layout(arena, settings_.kept.places);
  link_ = arena.take<Link>(static_cast<std::size_t>(settings_.kept.places));
  return arena.ok();
}

void StatePlaces::init() {
  table_.init();
  clear();
}

void StatePlaces::clear() {
  table_.clear();
  generation_ = filter_.generation();
  for (int p = 0; p < table_.capacity(); ++p) link_[p] = Link();
  entered_ = settled_ = 0;
  share_ = 1;
  last_loaded_ = 0;
}

/// A state that has begun again knows nothing of what entered the one before.
void StatePlaces::meet_state() {
  if (generation_ == filter_.generation()) return;
  generation_ = filter_.generation();
  for (int p = 0; p < table_.capacity(); ++p) {
    link_[p] = Link();
    table_[p].is_back = false;
  }
  entered_ = settled_ = 0;
}

bool StatePlaces::try_place(int place, const CameraView& view) {
  meet_state();
  Link& link = link_[place];
  if (link.camera < 0) {
    if (!enter(place)) return false;
  } else if (!link.is_on_trial) {  // its points are in the state, or have left it
    link.passed = link.brought = 0;
    ++link.uses;
  }
  bring(place, view, true);
  return true;
}

void StatePlaces::try_near(const CameraView& view, Scalar depth) {
  for (int n = 0; n < kMaxReturns; ++n) {
    const int place = nearest(view, depth, UINT32_MAX);
    if (place < 0 || filter_.room() < kCameraRows + kMinPoints * kPointRows || !enter(place)) return;
    bring(place, view, false);
  }
}

void StatePlaces::end_trial() {
  meet_state();
  for (const int p : used_entries(table_))
    if (link_[p].camera >= 0 && link_[p].is_on_trial) take_out(p);
}

void StatePlaces::follow(const CameraView& view, Scalar depth) {
  meet_state();
  for (const int p : used_entries(table_)) {
    Link& link = link_[p];
    if (link.camera < 0) continue;
    const Scalar d2 = distance2(p, view, depth);
    const bool is_near = d2 < kNear * kNear;
    if (link.is_on_trial && !is_near) {
      take_out(p);
    } else if (link.is_on_trial) {
      link.is_on_trial = false;
      settled_ = std::max(settled_, link.entry);
    } else if (!filter_.block_is_sound(link.camera) || d2 > kGone * kGone || (!is_near && !has_points(p))) {
      leave(p);
    }
  }
  const int next = nearest(view, depth, last_loaded_);
  if (next >= 0 && enter(next)) {
    link_[next].is_on_trial = false;
    settled_ = std::max(settled_, link_[next].entry);
  }
  for (const int p : used_entries(table_))
    if (link_[p].camera >= 0 && !bring(p, view, true)) return;
}

/// Room is made by evicting features that this frame has not seen.
bool StatePlaces::enter(int p) {
  if (filter_.room() < kCameraRows && !features_.make_rows(kCameraRows, frame_.report.t_ns)) return false;
  const KeptPlace& place = table_[p];
  Link& link = link_[p];
  const int camera =
      filter_.add_known_camera(place.q_WK, place.p_WK, share_ * inverse_weight(entered_ + 1) * place.covariance);
  if (camera < 0) return false;
  filter_.pin(camera);
  const int origin = filter_.add_anchor(camera);
  if (origin < 0) {
    filter_.unpin(camera);
    return false;
  }
  filter_.pin(origin);
  link.camera = camera;
  link.anchor = origin;
  link.entry = ++entered_;
  link.passed = link.brought = 0;
  ++link.uses;
  link.is_on_trial = true;
  table_.note_return(p);
  for (const int i : used_entries(map_.anchors)) {
    Anchor& anchor = map_.anchors[i];
    if (anchor.place != place.id || anchor.camera >= 0) continue;
    anchor.camera = camera;
    filter_.pin(camera);
  }
  return true;
}

/// Its points stay in the state. Anchors that it holds stay where they are until it enters again.
void StatePlaces::leave(int p) {
  Link& link = link_[p];
  for (const int i : used_entries(map_.anchors)) {
    Anchor& anchor = map_.anchors[i];
    if (anchor.place != table_[p].id || anchor.camera != link.camera) continue;
    anchor.camera = Anchor::kNoCamera;
    filter_.unpin(link.camera);
  }
  filter_.unpin(link.anchor);
  filter_.unpin(link.camera);
  link.camera = link.anchor = -1;
  table_[p].is_back = false;
}

/// As if it had not entered: nothing in the state depends on it.
void StatePlaces::take_out(int p) {
  Link& link = link_[p];
  int gone[KeptPlace::kMaxPoints], count = 0;
  for (int i = 0; i < table_[p].count; ++i) {
    const int entry = (link.brought >> i & 1u) != 0 ? map_.features.entry_of(table_[p].point[i].id) : -1;
    if (entry >= 0) gone[count++] = entry;
  }
  features_.drop(gone, count);
  leave(p);
  --link.uses;
  entered_ = settled_;
  for (const int other : used_entries(table_))
    if (link_[other].camera >= 0) entered_ = std::max(entered_, link_[other].entry);
}

bool StatePlaces::has_points(int p) const {
  for (int i = 0; i < table_[p].count; ++i)
    if (map_.features.entry_of(table_[p].point[i].id) >= 0) return true;
  return false;
}

/// Points that come into view for the first time since the place has entered. False: there is no room for more.
bool StatePlaces::bring(int p, const CameraView& view, bool may_evict) {
  const KeptPlace& place = table_[p];
  Link& link = link_[p];
  for (int i = 0; i < place.count; ++i) {
    const std::uint32_t bit = 1u << i;
    Vec2 pixel;
    if ((link.passed & bit) != 0 ||
        !project(filter_.lens(), view.q_WC.conjugate() * (place.position_W(i) - view.c_W), &pixel) ||
        !is_in_image(settings_.camera, pixel, static_cast<Scalar>(settings_.border_px)))
      continue;
    if (map_.features.entry_of(place.point[i].id) < 0) {
      const bool has_room = filter_.room() >= kPointRows && map_.features.count() < map_.features.capacity();
      if (!has_room && !(may_evict && features_.make_room_for_point())) return false;
      if (bring_point(place, place.point[i], link) < 0) return false;
      link.brought |= bit;
    }
    link.passed |= bit;
  }
  return true;
}

/// Returns its entry, or -1.
int StatePlaces::bring_point(const KeptPlace& place, const PlacePoint& from, const Link& link) {
  const int slot = filter_.add_point_of(link.camera, link.anchor, from.position_K(),
                                        share_ * inverse_weight(link.uses) * from.covariance_K());
  const int entry = slot < 0 ? -1 : map_.features.add(slot);
  if (entry < 0) {
    if (slot >= 0) filter_.remove(&slot, 1);
    return -1;
  }
  filter_.set_owner(slot, entry);
  bring_back_feature(place, from, entry, &map_);
  map_.features[entry].last_seen_ns = frame_.report.t_ns;
  return entry;
}

/// Of places that are not in the state and belong to a view, up to an id. -1: there is none.
int StatePlaces::nearest(const CameraView& view, Scalar depth, std::uint32_t last_id) const {
  int best = -1;
  Scalar least = kNear * kNear;
  for (const int p : used_entries(table_)) {
    const Scalar d2 = distance2(p, view, depth);
    if (link_[p].camera >= 0 || table_[p].id > last_id || !(d2 < least)) continue;
    least = d2;
    best = p;
  }
  return best;
}

Scalar StatePlaces::distance2(int p, const CameraView& view, Scalar depth) const {
  const KeptPlace& place = table_[p];
  return view_distance2(view.q_WC, view.c_W, depth, place.q_WK, place.p_WK, place.depth);
}

}  // namespace pf
