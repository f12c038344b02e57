#include "map/plane_search.h"

#include <algorithm>
#include <cmath>

#include "map/plane_refit.h"
#include "map/tuning.h"

namespace pf {
namespace {

using namespace tuning::plane_search;

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
              PlaneHypothesis* hypothesis) {
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
  if (!(size > std::max(2 * settings.distance, kMinHeight * longest) * longest)) return false;
  hypothesis->n_W = n / size;
  hypothesis->o_W = p + (u + v) / 3;
  return true;
}

/// How much denser the plane is than the denser layer beside it; so that a slice of clutter does not hide a small wall.
int score_of(const PlaneLayers& layers) {
  return (kPlaneLayer - 1) * layers.on - 2 * std::max(layers.side[0], layers.side[1]);
}

/// Keeps the best, one of each plane.
void keep_best(const PlaneHypothesis& made, const PlaneSearchSettings& settings, PlaneHypothesis* kept) {
  int place = -1;
  for (int i = 0; i < kKept && place < 0; ++i) {
    const bool same = kept[i].score > 0 && std::abs(kept[i].n_W.dot(made.n_W)) > kSameNormal &&
                      std::abs(kept[i].n_W.dot(made.o_W - kept[i].o_W)) < kPlaneLayer * settings.distance &&
                      (made.o_W - kept[i].o_W).norm() < settings.radius;
    if (same) place = i;
  }
  if (place < 0) place = kKept - 1;
  if (made.score <= kept[place].score) return;
  kept[place] = made;
  for (; place > 0 && kept[place].score > kept[place - 1].score; --place) std::swap(kept[place], kept[place - 1]);
}

}  // namespace

bool search_plane(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings,
                  const Vec3& viewer_W, std::uint32_t* random, PlaneFit* fit, int* members, int* member_count) {
  if (count < 3 || count <= settings.min_points) return false;
  PlaneHypothesis kept[kKept], made;
  for (int trial = 0; trial < settings.trials; ++trial) {
    if (!draw_set(candidates, count, settings, random, &made)) continue;
    const PlaneLayers layers = count_layers(candidates, count, settings, made.o_W, made.n_W);
    if (layers.on <= settings.min_points / 2) continue;
    made.score = score_of(layers);
    keep_best(made, settings, kept);
  }
  PlaneRefit refit(candidates, count, settings, viewer_W);
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
