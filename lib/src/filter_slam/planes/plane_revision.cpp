#include "filter_slam/planes/plane_revision.h"

#include <algorithm>
#include <cmath>

#include "filter_slam/planes/plane_points.h"
#include "filter_slam/planes/tuning.h"

namespace pf {
namespace {

using namespace tuning::plane_places;

/// Its plane is (a, b, h) = 0 about it, and an error of (a, b, h) is one of (t1, t2, h).
PlaneFrame frame_of(const MajorityPlane& plane) {
  PlaneFrame frame;
  frame.o_W = plane.c_W;
  frame.R_WP.col(0) = plane.e_W[0];
  frame.R_WP.col(1) = plane.e_W[1];
  frame.R_WP.col(2) = plane.n_W;
  return frame;
}

/// The part of x along b, from none to all of b: a b with a = xᵀ W b / bᵀ W b, 0 <= a <= 1, W the inverse of the variances.
Vec3 part_in(const Vec3& x, const Vec3& b, const Vec3& variance) {
  const Vec3 Wb = b.cwiseQuotient(variance);
  const Scalar whole = b.dot(Wb);
  return whole > Scalar(0) ? Vec3(b * std::clamp(x.dot(Wb) / whole, Scalar(0), Scalar(1))) : Vec3(Vec3::Zero());
}

}  // namespace

int PlaneRevision::list_places(int plane, const Vec3& n_W, JudgedPoint* points, int* slots) const {
  const State& state = filter_.state();
  const Scalar limit = kMaxSigma * settings_.plane_distance;
  int count = 0;
  state.for_each_planar(plane, [&](int slot) {
    JudgedPoint* p = points + count;
    if (count == kMaxJudged || !places_.find(state.block[slot].owner, n_W, &p->p_W, &p->variance)) return;
    p->variance *= kPixel * kPixel;
    if (p->variance < limit * limit) slots[count++] = slot;
  });
  return count;
}

void PlaneRevision::revise(int plane_entry) {
  PlaneEntry& entry = map_.planes[plane_entry];
  const int plane = entry.slot;
  const State& state = filter_.state();
  if (entry.known || filter_.group_of(plane) >= 0) return;
  Vec3 n_W;
  Scalar d_W;
  plane_normal(state.frame_of(state.block[plane]), state.block[plane].xyz(), &n_W, &d_W);
  JudgedPoint points[kMaxJudged];
  int slots[kMaxJudged];
  const int count = list_places(plane, n_W, points, slots);
  MajoritySettings majority;
  majority.min_points = std::max<int>(settings_.plane_min_points, (state.block[plane].children - 1) / 2);
  majority.distance = settings_.plane_distance;
  majority.roughness = settings_.fold.roughness;
  MajorityPlane found;
  const auto seed = static_cast<std::uint32_t>(frame_.report.frames);
  if (!find_majority(points, count, n_W, majority, seed, &found) || found.off == 0) return;
  for (int k = 0; k < count; ++k)
    if (points[k].is_off) leave(plane_entry, slots[k], points[k].p_W, found.n_W);
  straighten(plane_entry, found);
  Vec3 now_W;
  plane_normal(state.frame_of(state.block[plane]), state.block[plane].xyz(), &now_W, &d_W);
  settings_.hooks.say("plane ", entry.id, ": ", found.off, " of ", count,
                      " points rejected, plane refitted: normal by ",
                      degrees(std::atan2(n_W.cross(now_W).norm(), n_W.dot(now_W))), " deg");
}

void PlaneRevision::leave(int plane_entry, int slot, const Vec3& p_W, const Vec3& n_W) {
  const State& state = filter_.state();
  const Vec3 on_W = filter_.point(slot), ray_W = (on_W - state.body.p_W).normalized();
  const Scalar slant = n_W.dot(ray_W), height = n_W.dot(p_W - on_W);
  if (!(std::abs(slant) > kMinSlant)) return;
  const Scalar sigma = settings_.plane_distance / std::abs(slant);
  if (!filter_.unfold_along(slot, height / slant, sigma)) return;
  Feature& f = map_.features[state.block[slot].owner];
  f.rejections = 0;
  f.on_trial = false;
  f.observations = 1;  // has to converge again before it may be folded
  ++map_.planes[plane_entry].outliers;
}

void PlaneRevision::straighten(int plane_entry, const MajorityPlane& to) {
  PlaneEntry& entry = map_.planes[plane_entry];
  const State& state = filter_.state();
  const Block& block = state.block[entry.slot];
  const PlaneFrame about = frame_of(to), own = state.frame_of(block);
  const Vec3 variance(to.variance(1), to.variance(2), to.variance(0));
  Vec3 apart, x;  // from the majority's plane
  Mat3 J;
  if (!reframe_plane(own, block.xyz(), about, &apart)) return;
  apart -= part_in(apart, Vec3(to.bent(1), to.bent(2), to.bent(0)), variance);
  if (!reframe_plane(about, apart, own, &x, &J)) return;
  const Vec3 step = x - block.xyz();
  const Mat3 D = kTwoSigma2 * Mat3(variance.asDiagonal()) + apart * apart.transpose();
  const Mat3 Q = J * D * J.transpose() + step * step.transpose();
  if (!filter_.slide_plane(entry.slot, x, Q, settings_.fold.roughness)) return;
  places_.forget(entry.slot);
  entry.seen = entry.support = PlaneOutline();
  state.for_each_planar(entry.slot, [&](int slot) {
    if (!map_.features[state.block[slot].owner].on_trial) support(filter_, map_, plane_entry, slot);
  });
}

}  // namespace pf
