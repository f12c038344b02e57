#include "keyframe_slam/planes/planes.h"

#include "base/table_entries.h"
#include "frame/tuning.h"

namespace pf {

namespace same = tuning::plane_lifecycle;

bool KeyframePlanes::layout(Arena& arena) {
  const std::size_t points = static_cast<std::size_t>(settings_.max_features);
  plane_ = arena.take<KeyframePlane>(static_cast<std::size_t>(settings_.max_planes));
  candidate_ = arena.take<PlaneCandidate>(points);
  return arena.ok();
}

int KeyframePlanes::list_points(int k) {
  int count = 0;
  for (const int i : used_entries(map_)) {
    if (!map_.point(i).has_depth || map_.point(i).plane != k) continue;
    candidate_[count].name = i;
    points_W()[count++] = map_.position(i);
  }
  return count;
}

int KeyframePlanes::points_on(int k) const {
  int count = 0;
  for (int i = 0; i < map_.capacity(); ++i) count += map_.used(i) && map_.point(i).plane == k ? 1 : 0;
  return count;
}

/// Gives a plane another frame, with the first axis along the old one's, and its outlines in it. Those of a wall are carried by it.
void KeyframePlanes::set_frame(int k, const PlaneFrame& frame) {
  const PlaneFrame from = plane_[k].frame;
  plane_[k].frame = frame;
  if (table_[k].known) return;
  for (PlaneOutline* known : {&table_[k].seen, &table_[k].support})
    for (int i = 0; i < known->count; ++i)
      known->uv[i] = plane_coordinates(frame, plane_point(from, Vec3::Zero(), known->uv[i]));
}

/// Gives a plane the frame in which it lies, of (a, b, h) about another one. That of a wall has the origin and axes of the plan, as far as
/// these can be kept. False where it is slanted too far.
bool KeyframePlanes::lay(int k, const PlaneFrame& about, const Vec3& x, const Mat3& covariance) {
  Vec3 of_plan, zero;
  Mat3 J;
  const bool is_wall = table_[k].known;
  if (is_wall && !reframe_plane(about, x, plane_[k].plan, &of_plan)) return false;
  const PlaneFrame frame = is_wall ? lying_frame(plane_[k].plan, of_plan) : lying_frame(about, x);
  if (!reframe_plane(about, x, frame, &zero, &J)) return false;
  set_frame(k, frame);
  plane_[k].covariance = J.lazyProduct(covariance).lazyProduct(J.transpose());
  return true;
}

void KeyframePlanes::begin_adjustment() {
  for (const int k : used_entries(table_)) plane_[k].adjusted = false;
}

bool KeyframePlanes::take_adjusted(int k, const Vec3& x, const Mat3& covariance) {
  const PlaneFrame old = plane_[k].frame;
  Vec3 n;
  Scalar d;
  plane_normal(old, x, &n, &d);
  if (!(n.dot(old.R_WP.col(2)) > same::kMinNormalCosine) || !lay(k, old, x, covariance)) return false;
  plane_[k].adjusted = true;
  return true;
}

void KeyframePlanes::set_wall(int k, const Vec3& x, const Mat3& covariance) {
  plane_[k].frame = lying_frame(plane_[k].plan, x);
  plane_[k].covariance = covariance;
}

void KeyframePlanes::clear_points(int k) {
  for (const int i : used_entries(map_))
    if (map_.point(i).plane == k) map_.point(i).plane = -1;
}

void KeyframePlanes::move(const Similarity& T) {
  for (const int k : used_entries(table_)) move(k, T);
}

void KeyframePlanes::move(int k, const Similarity& T) {
  const Scalar s = T.s;
  if (table_[k].known && !is_measured(k)) return;  // it is where the plan has it, and not in the map
  KeyframePlane& plane = plane_[k];
  plane.frame = {T.q.toRotationMatrix() * plane.frame.R_WP, T.of(plane.frame.o_W)};
  plane.covariance.row(2) *= s;
  plane.covariance.col(2) *= s;
  for (PlaneOutline* known : {&table_[k].seen, &table_[k].support})
    for (int i = 0; i < known->count && !table_[k].known; ++i) known->uv[i] *= s;
}

///   covariance of (a, b, h) = sum J_i (Sigma_i + roughness² n nᵀ) J_iᵀ,   J_i of fit_plane_jacobian
void KeyframePlanes::fit(int k, int count) {
  const PlaneFrame old = plane_[k].frame;
  const Vec3 n_old = old.R_WP.col(2);
  PlaneFit fit;
  if (count < same::kMinPoints || !fit_plane(points_W(), count, old.o_W + n_old, &fit)) return;
  const Mat3 axes = fit.frame.R_WP;
  const Vec3 n = axes.col(2);
  if (!table_[k].known && !(n.dot(n_old) > same::kMinNormalCosine)) return;
  Mat3 P = Mat3::Zero();
  const Scalar roughness2 = roughness_of(k) * roughness_of(k);
  for (int c = 0; c < count; ++c) {
    const Mat3 J = fit_plane_jacobian(fit, points_W()[c]);
    const Mat3 S = map_.covariance(candidate_[c].name) + roughness2 * n * n.transpose();
    P += J.lazyProduct(S).lazyProduct(J.transpose());
  }
  PlaneFrame frame = fit.frame;
  frame.R_WP.col(0) = (old.R_WP.col(0) - n * n.dot(old.R_WP.col(0))).normalized();
  frame.R_WP.col(1) = n.cross(frame.R_WP.col(0));
  // (a, b) turn with the axes.
  Mat3 T = frame.R_WP.transpose() * axes;
  T.col(2).setZero();
  T.row(2).setZero();
  T(2, 2) = 1;
  lay(k, frame, Vec3::Zero(), T.lazyProduct(P).lazyProduct(T.transpose()));
}

void KeyframePlanes::add_found(int k, const PlaneFrame& frame) {
  plane_[k] = {frame, Mat3::Identity() * (settings_.plane_distance * settings_.plane_distance), false, {}};
}

bool KeyframePlanes::is_certain(int i, Mat3* covariance) const {
  if (!map_.used(i) || !map_.point(i).has_depth) return false;
  const Feature& f = map_.feature(i);
  if (f.is_target || f.rejections > 0 || f.observations < tuning::plane_keeper::kConverged) return false;
  if (!(map_.point(i).variance > Scalar(0))) return false;
  *covariance = map_.covariance(i);
  return covariance->trace() < settings_.fold_sigma * settings_.fold_sigma;
}

void KeyframePlanes::put_on(int k, int i) {
  map_.point(i).plane = static_cast<std::int8_t>(k);
  if (table_[k].known) return;  // it has the outline of the plan
  const Vec2 uv = plane_coordinates(plane_[k].frame, map_.position(i));
  extend_outline(&table_[k].support, &uv, 1);
}

}  // namespace pf
