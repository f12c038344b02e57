#include "keyframe_slam/loops/loop_finder.h"

#include <algorithm>
#include <cmath>

#include "base/archive.h"
#include "base/table_entries.h"
#include "geometry/small_cholesky.h"
#include "memory/tuning.h"
#include "vision/carry.h"

namespace pf {
namespace {

using SevenBySix = Eigen::Matrix<double, 7, 6>;

Scalar trace3(const SimilarityCovariance& C, int first) {
  return static_cast<Scalar>(C(first, first) + C(first + 1, first + 1) + C(first + 2, first + 2));
}

constexpr Scalar kNoDensity = Scalar(-1e6);  ///< ln of a density, where a covariance is none

/// ln N(u; 0, P) without the factor of 2 pi.
Scalar log_normal(const Vec6& u, const Mat6& P) {
  SmallCholesky<6> factored;
  if (!factored.factor(P)) return kNoDensity;
  return -(u.dot(factored.solve<1>(u)) + factored.log_det()) / 2;
}

}  // namespace

void LoopFinder::Near::add(int entry, Scalar its_d2) {
  int at = count < PlaceMeasurement::kMaxPlaces ? count++ : count - 1;
  if (at == count - 1 && count == PlaceMeasurement::kMaxPlaces && place[at] >= 0 && d2[at] <= its_d2) return;
  for (; at > 0 && d2[at - 1] > its_d2; --at) {
    d2[at] = d2[at - 1];
    place[at] = place[at - 1];
  }
  d2[at] = its_d2;
  place[at] = entry;
}

/// D with the drift in the scales of both parts.
LoopFinder::Near LoopFinder::find_near(const CameraView& view, Scalar depth, const DriftChain& chain) const {
  using namespace tuning::place;
  Near near;
  std::fill(near.place, near.place + PlaceMeasurement::kMaxPlaces, -1);
  for (const int p : used_entries(map_.places)) {
    const KeptPlace& place = map_.places[p];
    if (!map_.places.is_present(p)) continue;
    const int number = static_cast<int>(place.id);
    const SimilarityCovariance* sum = chain.sum_of(number);
    if (sum == nullptr) continue;
    const SimilarityCovariance Q = similarity_covariance_at(view.c_W, chain.between(number, *sum, chain.sum()));
    const Scalar far = kFarShift * std::min(depth, place.depth);
    const Vec3 z_a = view.q_WC * Vec3::UnitZ(), z_b = place.q_WK * Vec3::UnitZ();
    const Scalar d2 = (view.c_W - place.p_WK).squaredNorm() / (far * far + trace3(Q, 3)) +
                      2 * (1 - z_a.dot(z_b)) / (kFarTurn * kFarTurn + trace3(Q, 0));
    if (d2 < kNear * kNear) near.add(p, d2);
  }
  return near;
}

/// ln of how much more likely this pose u against the places is by drift, covariance P, than for one that looks alike, which may be at any
/// place, and seen from its side or from any:
///
///   ln N(u; 0, P) - ln (N(u; 0, P + S) + N(u; 0, P + S')) / 2
Scalar LoopFinder::log_drift(const CameraView& view, const Vec6& u, const Mat6& P) const {
  Mat3 S = Mat3::Zero();
  int count = 0;
  for (const int p : used_entries(map_.places)) {
    if (!map_.places.is_present(p)) continue;
    const Vec3 away = map_.places[p].p_WK - view.c_W;
    S += away * away.transpose();
    ++count;
  }
  Mat6 same = P, any = P;
  same.bottomRightCorner<3, 3>() += S / static_cast<Scalar>(std::max(count, 1));
  any.bottomRightCorner<3, 3>() = same.bottomRightCorner<3, 3>();
  any.topLeftCorner<3, 3>() += Mat3::Identity();  // [rad^2]
  const Scalar a = log_normal(u, same), b = log_normal(u, any), most = std::max(a, b);
  return log_normal(u, P) - most - std::log((std::exp(a - most) + std::exp(b - most)) / 2);
}

bool LoopFinder::is_asked(const CameraView& view, Scalar depth) const {
  return data_->asked_depth > Scalar(0) &&
         view_distance2(view.q_WC, view.c_W, depth, data_->asked.q_WC, data_->asked.c_W, data_->asked_depth) <
             tuning::place::kApart * tuning::place::kApart;
}

LoopClosure LoopFinder::look(const KeyframeMotion& motion, Scalar depth, const DriftChain& chain) {
  const CameraView view = motion.view();
  if (data_ == nullptr || map_.keyframes.began_elsewhere() || is_asked(view, depth)) return LoopClosure();
  const Near near = find_near(view, depth, chain);
  if (near.count == 0) return LoopClosure();
  data_->asked = view;
  data_->asked_depth = depth;
  if (data_->breaks != chain.breaks()) data_->views = 0;
  return compare(motion, near, chain);
}

/// The pose u of the camera against the places is that of the window's drift x about the camera, u = H x, beside what the camera may be off
/// in the window. With P its covariance before the image and S after it,
///
///   x+ = x + G (u+ - u),   C+ = C + G (S - P) Gᵀ,   G = C Hᵀ P⁻¹
LoopClosure LoopFinder::compare(const KeyframeMotion& motion, const Near& near, const DriftChain& chain) {
  LoopClosure out;
  const CameraView view = motion.view();
  const int number = static_cast<int>(map_.places[near.place[0]].id);
  const SimilarityCovariance prior =
      similarity_covariance_at(view.c_W, chain.between(number, *chain.sum_of(number), chain.sum()));
  const bool is_first = data_->views == 0;
  SimilarityError x = SimilarityError::Zero();
  SimilarityCovariance C = prior;
  if (!is_first) {
    x = similarity_error_at(view.c_W) * data_->x;
    C = similarity_covariance_at(view.c_W, data_->C + chain.sum() - data_->sum);
  }
  const Vec6 u = x.head<6>().cast<Scalar>();
  PosePrior about;
  about.q_WC = (exp_so3(u.head<3>()) * view.q_WC).normalized();
  about.p_W = view.c_W + u.tail<3>();
  about.covariance = motion.pose_covariance() + C.topLeftCorner<6, 6>().cast<Scalar>();
  about.v_W = motion.body().v_W;
  about.w_C = motion.body().w_C;
  SmallCholesky<6> before, after;
  if (!before.factor(about.covariance)) return out;
  const PlaceSighting seen = places_.measure(near.place, near.count, about, belief_);
  const int n = seen.consensus.searched, k = seen.consensus.inliers;
  if (n < settings_.min_inliers) return out;
  const FindShare& share = belief_.share();
  data_->log_odds = PoseBelief::updated(is_first ? PoseBelief::anew() : data_->log_odds,
                                        evidence_against_chance(seen.consensus, share));
  data_->alike = (is_first ? Scalar(0) : data_->alike) + share.log_probability(n, k) - log_any_share(n, k);
  const Mat6 P_inverse = before.inverse();
  if (k == 0 || !after.factor(Mat6(seen.information + P_inverse))) {
    if (data_->log_odds <= PoseBelief::anew()) data_->views = 0;
    return out;
  }
  const Mat6 S = after.inverse();
  Vec6 now;
  now << log_so3(seen.pose.q_WC * view.q_WC.conjugate()), seen.pose.p_WC - view.c_W;
  const SevenBySix G = C.leftCols<6>() * P_inverse.cast<double>();
  x += G.lazyProduct((now - u).cast<double>());
  C += G.lazyProduct((S - about.covariance).cast<double>()).lazyProduct(G.transpose());
  C = (C + C.transpose().eval()) / 2;
  data_->x = similarity_error_at(-view.c_W) * x;
  data_->C = similarity_covariance_at(-view.c_W, C);
  data_->sum = chain.sum();
  data_->breaks = chain.breaks();
  ++data_->views;
  const Mat6 P_drift = prior.topLeftCorner<6, 6>().cast<Scalar>() + S + motion.pose_covariance();
  const Scalar against_alike = belief_.most_elsewhere() + data_->alike + log_drift(view, now, P_drift);
  const Scalar least = std::min(against_alike, data_->log_odds), most = std::max(against_alike, data_->log_odds);
  if (data_->views < kMinViews || !PoseBelief::is_enough(least - std::log(1 + std::exp(least - most)))) return out;
  data_->views = 0;
  return {number, view.c_W, x, prior, C};
}

void LoopFinder::carry(Archive& archive) {
  places_.carry(archive);
  if (data_ == nullptr) return;
  auto& [asked, asked_depth, views, breaks, x, C, sum, log_odds, alike] = *data_;
  pf::carry(archive, asked);
  archive.numbers(asked_depth, x, C, sum, log_odds, alike);
  archive.counts(views, breaks);
}

}  // namespace pf
