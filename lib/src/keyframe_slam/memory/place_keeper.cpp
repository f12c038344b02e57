#include "keyframe_slam/memory/place_keeper.h"

#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "keyframe_slam/map/keyframe_upkeep.h"
#include "memory/returning_feature.h"
#include "memory/tuning.h"

namespace pf {
namespace {

using namespace tuning::place;

/// Whether a place keeps a point of the window that its keyframe saw.
bool is_worth_keeping(const KeyframeMap& map, int i) {
  const KeyframePoint& point = map.point(i);
  const Feature& f = map.feature(i);
  return point.has_depth && f.has_appearance && !f.is_target && !f.was_missed && point.variance > Scalar(0) &&
         point.variance < kMaxDepthSigma * kMaxDepthSigma * point.rho * point.rho;
}

/// The point as the keyframe knows it.
PlacePoint seen_from(const KeyframeMap& map, int i, const Keyframe& k) {
  const Mat3 R_KW = k.q_WC.conjugate().toRotationMatrix();
  const Vec3 at_K = R_KW * (map.position(i) - k.p_W);
  const Mat3 P = R_KW * map.covariance(i) * R_KW.transpose();
  const CameraView& first = map.tables().first_view(i);
  const Quat q_KV = (k.q_WC.conjugate() * first.q_WC).normalized();
  const Vec3 c_K = R_KW * (first.c_W - k.p_W);
  PlacePoint out;
  out.id = map.feature(i).id;
  out.plane = map.point(i).plane >= 0 ? map.tables().planes[map.point(i).plane].id : 0;
  out.observations = map.feature(i).observations;
  set_place_point(at_K, P, q_KV, c_K, map.tables().appearance(i).patch, &out);
  return out;
}

/// Variance of the inverse depth of a point by the covariance of its position:  rho^4 rᵀ P r.
Scalar inverse_depth_variance(const PlacePoint& point) {
  const Vec3 r = point.ray();
  const Scalar rho2 = static_cast<Scalar>(point.rho) * static_cast<Scalar>(point.rho);
  return rho2 * rho2 * r.dot(point.covariance_K() * r);
}

}  // namespace

bool make_place(const KeyframeMap& map, int keyframe, const bool* taken, KeptPlace* out) {
  const Keyframe& k = map.keyframes[keyframe];
  *out = KeptPlace();
  out->id = static_cast<std::uint32_t>(k.number);
  out->q_WK = k.q_WC;
  out->p_WK = k.p_W;
  out->covariance = k.covariance;
  for (const bool second : {false, true})
    for (const int i : used_entries(map)) {
      if (second && out->count >= kMinPoints) break;
      if ((taken != nullptr && taken[i]) == second && map.keyframes.pixels(keyframe)[i].seen &&
          is_worth_keeping(map, i))
        add_point(seen_from(map, i, k), out);
    }
  if (out->count < kMinPoints) return false;
  out->depth = median_depth(*out);
  return true;
}

void mark_taken(const KeyframeMap& map, const KeptPlace& place, bool* taken) {
  for (int i = 0; i < place.count; ++i) {
    const int row = map.tables().features.entry_of(place.point[i].id);
    if (row >= 0) taken[row] = true;
  }
}

void PlaceKeeper::keep(int keyframe) {
  if (settings_.kept.places == 0) return;
  const int kept = map_.places.entry_of(static_cast<std::uint32_t>(map_.keyframes[keyframe].number));
  std::fill(taken_, taken_ + map_.capacity(), false);
  for (const int p : used_entries(map_.places))
    if (p != kept) mark_taken(map_, map_.places[p], taken_);
  const bool is_place = make_place(map_, keyframe, taken_, scratch_);
  if (kept >= 0)
    update(*scratch_, &map_.places[kept]);
  else if (is_place)
    map_.places.keep(*scratch_);
}

/// A place leaves the window once more: where it is now, with the points that it has now, and those of before that are gone since.
void PlaceKeeper::update(const KeptPlace& now, KeptPlace* kept) const {
  kept->is_back = false;
  kept->q_WK = now.q_WK;
  kept->p_WK = now.p_WK;
  for (int i = 0; i < now.count; ++i) {
    int same = -1;
    for (int j = 0; j < kept->count; ++j)
      if (kept->point[j].id == now.point[i].id) same = j;
    if (same >= 0)
      kept->point[same] = now.point[i];
    else
      add_point(now.point[i], kept);
  }
  if (kept->count > 0) kept->depth = median_depth(*kept);
}

bool PlaceKeeper::bring_back(std::uint32_t id) {
  if (map_.keyframes.entry_of(static_cast<int>(id)) >= 0) return true;
  const int leaving = leaving_keyframe(map_, settings_.window_keyframes);
  if (leaving >= 0) {
    keep(leaving);
    remove_keyframe(leaving, &map_);
  }
  const int at = map_.places.entry_of(id);
  if (at < 0) return false;
  const KeptPlace& place = map_.places[at];
  map_.keyframes.add_again(static_cast<int>(id), place.q_WK, place.p_WK, place.covariance);
  map_.places.note_return(at);
  bring_points(id);
  return true;
}

void PlaceKeeper::follow_keyframes() {
  for (const int k : used_entries(map_.keyframes)) {
    const int at = map_.places.entry_of(static_cast<std::uint32_t>(map_.keyframes[k].number));
    if (at < 0) continue;
    map_.places[at].q_WK = map_.keyframes[k].q_WC;
    map_.places[at].p_WK = map_.keyframes[k].p_W;
  }
}

void PlaceKeeper::bring_points(std::uint32_t id) {
  const int at = map_.places.entry_of(id), k = map_.keyframes.entry_of(static_cast<int>(id));
  if (at < 0 || k < 0) return;
  const KeptPlace& place = map_.places[at];
  for (int i = 0; i < place.count; ++i) bring_point(place, place.point[i], k);
}

void PlaceKeeper::bring_near(const CameraView& view, Scalar depth, int most) {
  for (int n = 0; n < most; ++n) {
    std::uint32_t nearest = 0;
    Scalar least = kNear * kNear;
    for (const int p : used_entries(map_.places)) {
      const KeptPlace& place = map_.places[p];
      const Scalar d2 = view_distance2(view.q_WC, view.c_W, depth, place.q_WK, place.p_WK, place.depth);
      if (!map_.places.is_present(p) || place.is_back || !(d2 < least)) continue;
      least = d2;
      nearest = place.id;
    }
    if (nearest == 0 || !bring_back(nearest)) return;
  }
}

void PlaceKeeper::bring_point(const KeptPlace& place, const PlacePoint& from, int keyframe) {
  Vec2 pixel;
  if (!project(map_.camera(), from.ray(), &pixel)) return;
  const int known = map_.tables().features.entry_of(from.id);
  if (known >= 0) {
    if (map_.point(known).has_depth) map_.keyframes.set_pixel(keyframe, known, pixel);
    return;
  }
  const int i = map_.add(keyframe, pixel);
  if (i < 0) return;
  Map& tables = map_.tables();
  bring_back_feature(place, from, i, &tables);
  KeyframePoint& point = map_.point(i);
  point.ray_K = from.ray().normalized();
  point.rho = static_cast<Scalar>(from.rho);
  point.variance = inverse_depth_variance(from);
  point.remembered = {point.rho, std::sqrt(point.variance)};
  point.has_depth = true;
  point.faces_host = false;
  point.plane = static_cast<std::int8_t>(tables.planes.entry_of(tables.planes.find(from.plane)));
}

}  // namespace pf
