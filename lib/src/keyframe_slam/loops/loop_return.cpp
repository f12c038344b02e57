#include "keyframe_slam/loops/loop_return.h"

#include "base/table_entries.h"
#include "keyframe_slam/adjustment/move_window.h"
#include "keyframe_slam/adjustment/tuning.h"
#include "keyframe_slam/map/covisible.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {

bool LoopReturn::layout(Arena& arena) {
  if (settings_.kept.places == 0) return arena.ok();
  is_whole_ = arena.take<bool>(static_cast<std::size_t>(tuning::keyframe_map::kKeyframes));
  part_ = arena.take<Part>(static_cast<std::size_t>(settings_.kept.places + tuning::keyframe_map::kKeyframes));
  return arena.ok();
}

void LoopReturn::choose_whole(int place, bool* seen) {
  connected_keyframes(map_, tuning::keyframe_adjustment::kMinShared, is_whole_, seen);
  for (const int k : used_entries(map_.keyframes)) {
    const int number = map_.keyframes[k].number, at = map_.places.entry_of(static_cast<std::uint32_t>(number));
    if (number <= place || (at >= 0 && map_.places[at].is_back)) is_whole_[k] = false;
  }
}

bool LoopReturn::close(const LoopClosure& loop, bool* seen, DriftChain* chain, Mat6* covariance) {
  const int at = map_.places.entry_of(static_cast<std::uint32_t>(loop.place));
  DriftSpread spread;
  if (at < 0 || !map_.places.is_present(at) || !spread.begin(*chain, loop)) return false;
  choose_whole(loop.place, seen);
  const Mat6 covariance_at_place = map_.places[at].covariance;
  const Vec3 place_W = map_.places[at].p_WK;
  const auto covariance_at = [&](const Vec3& p_W) {
    Mat6 J = Mat6::Identity();
    J.bottomLeftCorner<3, 3>() = -hat(Vec3(p_W - place_W));
    return Mat6(J.lazyProduct(covariance_at_place).lazyProduct(J.transpose()) +
                similarity_covariance_at(p_W, spread.known()).topLeftCorner<6, 6>().cast<Scalar>());
  };
  const auto move_part = [&](int number, bool is_whole) {
    const SimilarityCovariance* known = chain->sum_of(number);
    if (known == nullptr || !(is_whole || spread.is_since(number))) return Similarity();
    SimilarityCovariance sum = *known;
    const Similarity T = is_whole ? spread.move_whole(&sum) : spread.move(number, &sum);
    chain->set_sum(number, sum);
    return T;
  };
  parts_ = 0;
  for (const int k : used_entries(map_.keyframes)) {
    Keyframe& keyframe = map_.keyframes[k];
    const int as_place = map_.places.entry_of(static_cast<std::uint32_t>(keyframe.number));
    const bool stays = as_place >= 0 && map_.places[as_place].is_back;
    const Similarity T = stays ? Similarity() : move_part(keyframe.number, is_whole_[k]);
    part_[parts_++] = {keyframe.q_WC, keyframe.p_W, T};
    move_keyframe(T, k, &map_);
    if (is_whole_[k] || spread.is_since(keyframe.number)) keyframe.covariance = covariance_at(keyframe.p_W);
  }
  for (const int p : used_entries(map_.places)) {
    KeptPlace& place = map_.places[p];
    const int number = static_cast<int>(place.id);
    if (!map_.places.is_present(p) || map_.keyframes.entry_of(number) >= 0) continue;
    const Similarity T = move_part(number, false);
    part_[parts_++] = {place.q_WK, place.p_WK, T};
    PlaceTable::move(T, &place);
  }
  const Similarity T = similarity_of(loop.x, loop.at_W);
  for (const int j : used_entries(map_.tables().planes))
    if (is_plane_of_whole(j)) planes_.move(j, T);
  *covariance = covariance_at(T.of(loop.at_W));
  chain->close(loop.place, spread.older(), spread.known());
  return true;
}

/// Whether a point of a keyframe that moves with the newest one lies on it.
bool LoopReturn::is_plane_of_whole(int plane) const {
  for (const int i : used_entries(map_))
    if (map_.point(i).plane == plane && is_whole_[map_.point(i).host]) return true;
  return false;
}

Similarity LoopReturn::near(const Quat& q_WC, const Vec3& p_W, Scalar depth) const {
  Similarity T;
  Scalar least = -1;
  for (int i = 0; i < parts_; ++i) {
    const Scalar d2 = view_distance2(q_WC, p_W, depth, part_[i].q_WK, part_[i].p_WK, depth);
    if (least >= Scalar(0) && !(d2 < least)) continue;
    least = d2;
    T = part_[i].T;
  }
  return T;
}

}  // namespace pf
