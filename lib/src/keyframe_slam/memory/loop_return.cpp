#include "keyframe_slam/memory/loop_return.h"

#include "base/table_entries.h"
#include "geometry/small_cholesky.h"
#include "keyframe_slam/adjustment/move_window.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {

bool LoopReturn::layout(Arena& arena, const Settings& settings) {
  if (settings.kept.places == 0) return arena.ok();
  part_ = arena.take<Part>(static_cast<std::size_t>(settings.kept.places + tuning::keyframe_map::kKeyframes));
  return arena.ok();
}

bool LoopReturn::close(const LoopClosure& loop, DriftChain* chain, Mat6* covariance) {
  const int at = map_.places.entry_of(loop.place);
  SmallCholesky<7, double> factored;
  if (at < 0 || !factored.factor(loop.prior)) return false;
  const KeptPlace back_at = map_.places[at];
  const int number = static_cast<int>(back_at.id), left_at = chain->left_at(number);
  const SimilarityCovariance inverse = factored.inverse(), gain = loop.prior - loop.posterior;
  const SimilarityCovariance known = similarity_covariance_at(-loop.at_W, loop.posterior);
  /// Moves in W, and the sum of the chain, of what has this number.
  const auto move_part = [&](int its_number, SimilarityCovariance* drift) {
    if (its_number <= left_at) return Similarity();
    const SimilarityCovariance A = similarity_covariance_at(loop.at_W, chain->between(number, back_at.drift, *drift));
    const SimilarityCovariance B = A.lazyProduct(inverse);
    *drift = back_at.drift + similarity_covariance_at(-loop.at_W, A - B.lazyProduct(gain).lazyProduct(B.transpose()));
    return similarity_of(B.lazyProduct(loop.x), loop.at_W);
  };
  const auto covariance_at = [&](const Vec3& p_W) {
    Mat6 J = Mat6::Identity();
    J.bottomLeftCorner<3, 3>() = -hat(Vec3(p_W - back_at.p_WK));
    return Mat6(J.lazyProduct(back_at.covariance).lazyProduct(J.transpose()) +
                similarity_covariance_at(p_W, known).topLeftCorner<6, 6>().cast<Scalar>());
  };
  const Similarity T = similarity_of(loop.x, loop.at_W);
  parts_ = 0;
  for (const int k : used_entries(map_.keyframes)) {
    Keyframe& keyframe = map_.keyframes[k];
    const Similarity its = move_part(keyframe.number, &keyframe.drift);
    part_[parts_++] = {keyframe.q_WC, keyframe.p_W, its};
    move_keyframe(its, k, &map_);
    if (keyframe.number > left_at) keyframe.covariance = covariance_at(keyframe.p_W);
  }
  for (const int p : used_entries(map_.places)) {
    KeptPlace& place = map_.places[p];
    if (!map_.places.is_present(p)) continue;
    const Similarity its = move_part(static_cast<int>(place.id), &place.drift);
    part_[parts_++] = {place.q_WK, place.p_WK, its};
    PlaceTable::move(its, &place);
  }
  for (const int j : used_entries(map_.tables().planes))
    if (is_in_view(j, left_at)) planes_.move(j, T);
  *covariance = covariance_at(T.of(loop.at_W));
  chain->close(number, back_at.drift, known, map_.keyframes.numbered());
  return true;
}

/// Whether points of keyframes that were made since lie on a plane.
bool LoopReturn::is_in_view(int plane, int left_at) const {
  for (const int i : used_entries(map_))
    if (map_.point(i).plane == plane && map_.keyframes[map_.point(i).host].number > left_at) return true;
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
