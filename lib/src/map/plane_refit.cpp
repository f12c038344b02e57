#include "map/plane_refit.h"

#include <algorithm>
#include <cmath>

#include "base/false_alarms.h"
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
    ++layers.around;
    if (d <= 1) ++layers.on;
    if (d > 1 && d <= kPlaneLayer) ++layers.side[h > 0 ? 1 : 0];
    if (d <= kSurroundings) ++layers.near;
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
  return !chance_explains(layers);
}

/// Whether chance makes planes like this one. Two families of tests, each with its own allowance of false planes:
///
///   among all within the radius     near / distance = kSurroundings, so share = 1 / kSurroundings
///   among those in a ball about the origin, radius rho, in which points without a plane are spread evenly:
///   share = (3 h - h³) / 2 with h = e / rho, of a layer of half-thickness e = distance or half of that
///
/// A small plane that nothing stands beside, such as a screen, does not show in the first: there are too many points elsewhere.
bool PlaneRefit::chance_explains(const PlaneLayers& layers) const {
  const int near = layers.near - layers.on + member_count_;
  if (log_false_alarms(member_count_, near, Scalar(1) / kSurroundings, layers.around) < kLogFalsePlanes) return false;
  const Vec3& o_W = fit_.frame.o_W;
  const Vec3 n_W = fit_.frame.R_WP.col(2);
  const Scalar bound = kLogFalseLocalPlanes - std::log(Scalar(2 * kBalls));
  Scalar rho = kSmallestBall * settings_.distance;
  for (int ball = 0; ball < kBalls; ++ball, rho *= 2) {
    int beside = 0, on = 0, close = 0;
    for (int i = 0; i < count_; ++i) {
      const Vec3 r = candidates_[i].p_W - o_W;
      if (r.squaredNorm() < rho * rho && std::abs(n_W.dot(r)) > settings_.distance) ++beside;
    }
    for (int k = 0; k < member_count_; ++k) {
      const Vec3 r = candidates_[members_[k]].p_W - o_W;
      if (!(r.squaredNorm() < rho * rho)) continue;
      ++on;
      if (std::abs(n_W.dot(r)) <= settings_.distance / 2) ++close;
    }
    const auto log_false = [&](int inside, Scalar h) {
      return log_false_alarms(inside, beside + on, (3 * h - h * h * h) / 2, layers.around);
    };
    const Scalar h = settings_.distance / rho;
    if (log_false(on, h) < bound || log_false(close, h / 2) < bound) return false;
  }
  return true;
}

}  // namespace pf
