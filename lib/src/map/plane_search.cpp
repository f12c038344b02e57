#include "map/plane_search.h"

#include <algorithm>
#include <cmath>

#include "map/plane_chance.h"

namespace pf {
namespace {

constexpr int kKept = 4;           // hypotheses that are refitted
constexpr int kLayer = 4;          // the layers beside a plane reach this many times as far as its points may
constexpr int kSurroundings = 20;  // and what chance is judged against, this many times
constexpr Scalar kContrast = 3;    // a plane is at least this many times as dense as those layers
constexpr Scalar kLogFalsePlanes = Scalar(-4.6);  // ln 0.01
constexpr Scalar kMinWidth = 3;                   // the narrow side of the points' spread, in distances
constexpr Scalar kMinAspect = Scalar(0.02);       // λ1 / λ2

struct Hypothesis {
  Vec3 o_W = Vec3::Zero();
  Vec3 n_W = Vec3::UnitZ();
  int score = 0;
};

struct Layers {
  int on = 0;      // within the distance
  int side = 0;    // beyond it, within kLayer distances
  int near = 0;    // within kSurroundings distances
  int around = 0;  // within the radius of the origin, at any height
};

/// xorshift32. A state of zero, which it would never leave, becomes another.
std::uint32_t next_random(std::uint32_t* state) {
  std::uint32_t x = *state != 0 ? *state : 0x9e3779b9u;
  x ^= x << 13;
  x ^= x >> 17;
  x ^= x << 5;
  *state = x;
  return x;
}

int random_below(std::uint32_t* state, int limit) {
  return static_cast<int>((static_cast<std::uint64_t>(next_random(state)) * static_cast<std::uint64_t>(limit)) >> 32);
}

/// A point, and two others near it that are about a triangle with it.
bool draw_set(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings, std::uint32_t* random,
              Hypothesis* hypothesis) {
  const int first = random_below(random, count);
  const Vec3& p = candidates[first].p_W;
  const Scalar reach2 = settings.radius * settings.radius / 4;
  int chosen[2] = {-1, -1}, seen = 0;
  for (int i = 0; i < count; ++i) {
    if (i == first || !((candidates[i].p_W - p).squaredNorm() < reach2)) continue;
    // Two out of all that come, each pair as likely as any other.
    const int place = seen < 2 ? seen : random_below(random, seen + 1);
    if (place < 2) chosen[place] = i;
    ++seen;
  }
  if (seen < 2) return false;
  const Vec3 u = candidates[chosen[0]].p_W - p, v = candidates[chosen[1]].p_W - p;
  const Vec3 n = u.cross(v);
  const Scalar longest = std::max(std::max(u.norm(), v.norm()), (u - v).norm()), size = n.norm();
  // Height of the triangle over its longest side: enough to fix a plane, against the points' own distances and its length.
  if (!(size > std::max(2 * settings.distance, Scalar(0.15) * longest) * longest)) return false;
  hypothesis->n_W = n / size;
  hypothesis->o_W = p + (u + v) / 3;
  return true;
}

Layers count_layers(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings, const Vec3& o_W,
                    const Vec3& n_W) {
  Layers layers;
  const Scalar radius2 = settings.radius * settings.radius;
  for (int i = 0; i < count; ++i) {
    const Vec3 r = candidates[i].p_W - o_W;
    if (!(r.squaredNorm() < radius2)) continue;
    const Scalar d = std::abs(n_W.dot(r)) / settings.distance;
    ++layers.around;
    if (d <= 1) ++layers.on;
    if (d > 1 && d <= kLayer) ++layers.side;
    if (d <= kSurroundings) ++layers.near;
  }
  return layers;
}

/// How much denser the plane is than the layers beside it, as a number of points.
int score_of(const Layers& layers) { return (kLayer - 1) * layers.on - layers.side; }

/// Keeps the best, one of each plane.
void keep_best(const Hypothesis& made, const PlaneSearchSettings& settings, Hypothesis* kept) {
  int place = -1;
  for (int i = 0; i < kKept && place < 0; ++i) {
    const bool same = kept[i].score > 0 && std::abs(kept[i].n_W.dot(made.n_W)) > Scalar(0.98) &&
                      std::abs(kept[i].n_W.dot(made.o_W - kept[i].o_W)) < kLayer * settings.distance &&
                      (made.o_W - kept[i].o_W).norm() < settings.radius;
    if (same) place = i;
  }
  if (place < 0) place = kKept - 1;
  if (made.score <= kept[place].score) return;
  kept[place] = made;
  for (; place > 0 && kept[place].score > kept[place - 1].score; --place) std::swap(kept[place], kept[place - 1]);
}

class Refit {
 public:
  Refit(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings, const Vec3& viewer_W)
      : candidates_(candidates), count_(count), settings_(settings), viewer_W_(viewer_W) {}

  const PlaneFit& fit() const { return fit_; }
  const int* members() const { return members_; }
  int member_count() const { return member_count_; }

  bool run(const Hypothesis& hypothesis) {
    collect(hypothesis.o_W, hypothesis.n_W);
    if (!refit()) return false;
    for (int round = 0; round < 2; ++round) {
      collect(fit_.frame.o_W, fit_.frame.R_WP.col(2));
      if (!refit()) return false;
    }
    keep_connected();
    if (!refit() || !leave_out_the_lonely()) return false;
    return passes();
  }

 private:
  /// Members: near the plane and near its origin, at most kMaxPlaneMembers, then the nearest.
  void collect(const Vec3& o_W, const Vec3& n_W) {
    member_count_ = 0;
    const Scalar radius2 = settings_.radius * settings_.radius;
    for (int i = 0; i < count_; ++i) {
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

  int farthest(const Vec3& o_W) const {
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

  bool refit() {
    Vec3 points[kMaxPlaneMembers];
    for (int k = 0; k < member_count_; ++k) points[k] = candidates_[members_[k]].p_W;
    return member_count_ > settings_.min_points && fit_plane(points, member_count_, viewer_W_, &fit_);
  }

  /// Members shrink to the largest group whose points are within radius / 2 of one another, step by step.
  void keep_connected() {
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

  /// A point far outside of the others turns the plane towards itself and then lies on it. So each must lie where the
  /// plane through the others passes: the residual without it is r / (1 - leverage), leverage = 1/n + u²/λ1 + v²/λ2.
  bool leave_out_the_lonely() {
    for (;;) {
      int worst = -1;
      Scalar most = settings_.distance;
      for (int k = 0; k < member_count_; ++k) {
        const Vec3 q = fit_.frame.R_WP.transpose() * (candidates_[members_[k]].p_W - fit_.frame.o_W);
        const Scalar leverage =
            1 / static_cast<Scalar>(fit_.count) + q.x() * q.x() / fit_.lambda(1) + q.y() * q.y() / fit_.lambda(2);
        const Scalar rest = 1 - leverage;
        const Scalar without = rest > Scalar(1e-3) ? std::abs(q.z()) / rest : 2 * settings_.distance;
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

  bool passes() const {
    const Scalar n = static_cast<Scalar>(fit_.count);
    const Scalar width = kMinWidth * settings_.distance;
    if (!(fit_.lambda(0) < n * settings_.normal_variance)) return false;
    if (!(fit_.lambda(1) > n * width * width && fit_.lambda(1) > kMinAspect * fit_.lambda(2))) return false;
    const Layers layers = count_layers(candidates_, count_, settings_, fit_.frame.o_W, fit_.frame.R_WP.col(2));
    const Scalar density = static_cast<Scalar>((kLayer - 1) * member_count_);
    if (!(density >= kContrast * static_cast<Scalar>(layers.side))) return false;
    const int near = layers.near - layers.on + member_count_;
    return log_false_planes(member_count_, near, Scalar(1) / kSurroundings, layers.around) < kLogFalsePlanes;
  }

  const PlaneCandidate* candidates_;
  int count_;
  const PlaneSearchSettings& settings_;
  const Vec3& viewer_W_;
  PlaneFit fit_;
  int members_[kMaxPlaneMembers];
  int member_count_ = 0;
};

}  // namespace

bool search_plane(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings,
                  const Vec3& viewer_W, std::uint32_t* random, PlaneFit* fit, int* members, int* member_count) {
  if (count < 3 || count <= settings.min_points) return false;
  Hypothesis kept[kKept], made;
  for (int trial = 0; trial < settings.trials; ++trial) {
    if (!draw_set(candidates, count, settings, random, &made)) continue;
    const Layers layers = count_layers(candidates, count, settings, made.o_W, made.n_W);
    if (layers.on <= settings.min_points / 2) continue;
    made.score = score_of(layers);
    keep_best(made, settings, kept);
  }
  Refit refit(candidates, count, settings, viewer_W);
  for (int i = 0; i < kKept; ++i) {
    if (kept[i].score <= 0 || !refit.run(kept[i])) continue;
    *fit = refit.fit();
    *member_count = refit.member_count();
    for (int k = 0; k < refit.member_count(); ++k) members[k] = refit.members()[k];
    return true;
  }
  return false;
}

}  // namespace pf
