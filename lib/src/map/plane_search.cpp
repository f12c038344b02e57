#include "map/plane_search.h"

#include <algorithm>
#include <cmath>

#include "base/draw_by_name.h"
#include "map/plane_refit.h"
#include "map/tuning.h"

namespace pf {
namespace {

using namespace tuning::plane_search;

/// A point, and two others near it that are about a triangle with it: in the order of their priorities, the first of all, and the first two
/// that lie near it. So each point, and each pair near it, is as likely as any other.
bool draw_set(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings, const DrawByName& draw,
              PlaneHypothesis* hypothesis) {
  int first = 0;
  std::uint32_t least = draw.priority(candidates[0].name);
  for (int i = 1; i < count; ++i) {
    const std::uint32_t priority = draw.priority(candidates[i].name);
    if (priority >= least) continue;
    first = i;
    least = priority;
  }
  const Vec3& p = candidates[first].p_W;
  const Scalar reach2 = settings.radius * settings.radius / 4;
  int chosen[2] = {-1, -1};
  std::uint32_t of_chosen[2] = {0, 0};
  for (int i = 0; i < count; ++i) {
    if (i == first || !((candidates[i].p_W - p).squaredNorm() < reach2)) continue;
    const std::uint32_t priority = draw.priority(candidates[i].name);
    if (chosen[0] < 0 || priority < of_chosen[0]) {
      chosen[1] = chosen[0];
      of_chosen[1] = of_chosen[0];
      chosen[0] = i;
      of_chosen[0] = priority;
    } else if (chosen[1] < 0 || priority < of_chosen[1]) {
      chosen[1] = i;
      of_chosen[1] = priority;
    }
  }
  if (chosen[1] < 0) return false;
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
                  const Vec3& viewer_W, std::uint32_t search, PlaneFit* fit, int* members, int* member_count) {
  if (count < 3 || count <= settings.min_points) return false;
  PlaneHypothesis kept[kKept], made;
  for (int trial = 0; trial < settings.trials; ++trial) {
    const DrawByName draw(search * static_cast<std::uint32_t>(settings.trials) + static_cast<std::uint32_t>(trial));
    if (!draw_set(candidates, count, settings, draw, &made)) continue;
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
