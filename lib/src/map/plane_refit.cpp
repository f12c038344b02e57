#include "map/plane_refit.h"

#include <algorithm>
#include <cmath>

#include "map/plane_evidence.h"
#include "map/tuning.h"

namespace pf {
namespace {

using namespace tuning::plane_search;

constexpr Scalar kMinRest = Scalar(1e-3);  ///< of 1 - leverage: below it the point alone holds the plane

}  // namespace

PlaneLayers count_layers(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings,
                         const Vec3& o_W, const Vec3& n_W) {
  PlaneLayers layers;
  const Scalar radius2 = settings.radius * settings.radius;
  for (int i = 0; i < count; ++i) {
    const Vec3 r = candidates[i].p_W - o_W;
    if (!(r.squaredNorm() < radius2)) continue;
    const Scalar h = n_W.dot(r), d = std::abs(h) / settings.distance;
    if (d <= 1) ++layers.on;
    if (d > 1 && d <= kPlaneLayer) ++layers.side[h > 0 ? 1 : 0];
  }
  return layers;
}

bool PlaneRefit::run(const PlaneHypothesis& hypothesis) {
  collect(hypothesis.o_W, hypothesis.n_W);
  if (!refit()) return false;
  for (int round = 0; round < 2; ++round) {
    collect(fit_.frame.o_W, fit_.frame.R_WP.col(2));
    if (!refit()) return false;
  }
  keep_connected();
  return refit() && reject_high_leverage() && passes();
}

/// Members: near the plane and near its origin; of more than kMaxPlaneMembers, those nearest to it.
void PlaneRefit::collect(const Vec3& o_W, const Vec3& n_W) {
  member_count_ = 0;
  const Scalar radius2 = settings_.radius * settings_.radius;
  for (int i = 0; i < count_; ++i) {
    if (candidates_[i].is_explained && settings_.known != nullptr && !may_be_plane(*settings_.known, n_W)) continue;
    const Vec3 r = candidates_[i].p_W - o_W;
    const Scalar d = n_W.dot(r);
    const Scalar variance = n_W.dot(candidates_[i].covariance * n_W) + settings_.normal_variance;
    if (!(r.squaredNorm() < radius2 && std::abs(d) <= settings_.distance && d * d < settings_.chi2 * variance))
      continue;
    int place = member_count_;
    if (place == kMaxPlaneMembers) {
      place = farthest(o_W);
      if ((candidates_[members_[place]].p_W - o_W).squaredNorm() <= r.squaredNorm()) continue;
    } else {
      ++member_count_;
    }
    members_[place] = i;
  }
}

int PlaneRefit::farthest(const Vec3& o_W) const {
  int place = 0;
  Scalar most = -1;
  for (int k = 0; k < member_count_; ++k) {
    const Scalar d = (candidates_[members_[k]].p_W - o_W).squaredNorm();
    if (d > most) {
      most = d;
      place = k;
    }
  }
  return place;
}

bool PlaneRefit::refit() {
  Vec3 points[kMaxPlaneMembers];
  for (int k = 0; k < member_count_; ++k) points[k] = candidates_[members_[k]].p_W;
  return member_count_ > settings_.min_points && fit_plane(points, member_count_, viewer_W_, &fit_);
}

/// Members shrink to the largest group whose points are within radius / 2 of one another, step by step.
void PlaneRefit::keep_connected() {
  unsigned char group[kMaxPlaneMembers] = {};
  int queue[kMaxPlaneMembers], best = 0, best_size = 0, groups = 0;
  const Scalar step2 = settings_.radius * settings_.radius / 4;
  for (int start = 0; start < member_count_; ++start) {
    if (group[start] != 0) continue;
    const unsigned char label = static_cast<unsigned char>(++groups);
    int size = 0;
    group[start] = label;
    queue[size++] = start;
    for (int head = 0; head < size; ++head) {
      for (int k = 0; k < member_count_; ++k) {
        if (group[k] != 0) continue;
        const Vec3 r = candidates_[members_[k]].p_W - candidates_[members_[queue[head]]].p_W;
        if (!(r.squaredNorm() < step2)) continue;
        group[k] = label;
        queue[size++] = k;
      }
    }
    if (size > best_size) {
      best_size = size;
      best = label;
    }
  }
  int kept = 0;
  for (int k = 0; k < member_count_; ++k) {
    if (group[k] == best) members_[kept++] = members_[k];
  }
  member_count_ = kept;
}

/// A point far from the others has high leverage: it rotates the plane towards itself and then lies on it. So each point must lie on the
/// plane through the others: the residual without it is r / (1 - leverage), leverage = 1/n + u²/λ1 + v²/λ2.
bool PlaneRefit::reject_high_leverage() {
  for (;;) {
    int worst = -1;
    Scalar most = settings_.distance;
    for (int k = 0; k < member_count_; ++k) {
      const Vec3 q = fit_.frame.R_WP.transpose() * (candidates_[members_[k]].p_W - fit_.frame.o_W);
      const Scalar leverage =
          1 / static_cast<Scalar>(fit_.count) + q.x() * q.x() / fit_.lambda(1) + q.y() * q.y() / fit_.lambda(2);
      const Scalar rest = 1 - leverage;
      const Scalar without = rest > kMinRest ? std::abs(q.z()) / rest : 2 * settings_.distance;
      if (without > most) {
        most = without;
        worst = k;
      }
    }
    if (worst < 0) return true;
    members_[worst] = members_[--member_count_];
    if (!refit()) return false;
  }
}

bool PlaneRefit::passes() const {
  const Scalar n = static_cast<Scalar>(fit_.count);
  const Scalar width = kMinWidth * settings_.distance;
  if (!(fit_.lambda(0) < n * settings_.normal_variance)) return false;
  if (!(fit_.lambda(1) > n * width * width && fit_.lambda(1) > kMinAspect * fit_.lambda(2))) return false;
  const PlaneLayers layers = count_layers(candidates_, count_, settings_, fit_.frame.o_W, fit_.frame.R_WP.col(2));
  // Each side by itself: a slice near the edge of clutter has nothing on one side.
  const Scalar density = n / 2,
               beside = static_cast<Scalar>(std::max(layers.side[0], layers.side[1])) / (kPlaneLayer - 1);
  if (!(density >= kContrast * beside)) return false;
  return is_evident();
}

/// Whether its points, or some of them where they are many, say together that they lie on it: the density of their distances is so much
/// larger than that of first depths that no choice among the points explains it.
bool PlaneRefit::is_evident() const {
  const Vec3& o_W = fit_.frame.o_W;
  const Vec3 n_W = fit_.frame.R_WP.col(2);
  JointDistances points;
  int names[kMaxJoint];
  points.count = std::min(member_count_, kMaxJoint);
  for (int i = 0; i < points.count; ++i) {
    const PlaneCandidate& c = candidates_[members_[i * member_count_ / points.count]];
    names[i] = c.name;
    points.d[i] = n_W.dot(c.p_W - o_W);
    points.uv[i] = plane_coordinates(fit_.frame, c.p_W);
    for (int j = 0; j < i; ++j) points.S[i * points.count + j] = Scalar(0);
    points.S[i * points.count + i] = n_W.dot(c.covariance * n_W);
  }
  if (settings_.joint.fill != nullptr)
    settings_.joint.fill(settings_.joint.owner, n_W, names, points.count, points.S);
  Scalar reach2 = 0;
  for (int k = 0; k < member_count_; ++k)
    reach2 = std::max(reach2, (candidates_[members_[k]].p_W - o_W).squaredNorm());
  int near = 0;
  for (int i = 0; i < count_; ++i) near += (candidates_[i].p_W - o_W).squaredNorm() <= reach2 ? 1 : 0;
  const Vec3 away_W = viewer_W_ - o_W;
  const Scalar roughness = settings_.roughness * std::max(Scalar(1), away_W.norm() / settings_.depth);
  const Scalar first = settings_.first_sigma * std::abs(n_W.dot(away_W));
  return log_odds_of_plane(points, first, roughness) - log_choices(points.count, near, count_) > kLogOdds;
}

}  // namespace pf
