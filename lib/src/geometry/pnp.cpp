#include "geometry/pnp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random_triples.h"
#include "geometry/p3p.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {
namespace {

constexpr Scalar kFirstDamping = Scalar(1e-4);  // relative
constexpr Scalar kMaxDamping = Scalar(1e8);     // relative; more means that no step helps
constexpr Scalar kMissedTriple = Scalar(1e-3);  // probability that no drawn triple is right, at which the drawing ends
constexpr Scalar kMinParallelism =
    Scalar(1e-6);  // w of a point relative to |m - w p|, below which it fixes no position

bool is_used(const unsigned char* use, int i) { return use == nullptr || use[i] != 0; }

/// Huber's cost of a squared residual in pixels, and the weight of its linearisation.
Scalar robust(Scalar r2, Scalar bound, Scalar* weight) {
  *weight = Scalar(1);
  if (!(bound > Scalar(0)) || r2 <= bound * bound) return r2;
  const Scalar r = std::sqrt(r2);
  *weight = bound / r;
  return Scalar(2) * bound * r - bound * bound;
}

/// Robust cost, and the normal equations about the pivot where A and b are given. False where a point cannot be seen.
bool residuals(const Camera& camera, const PoseEstimate& pose, const PnpPoint* points, int count,
               const unsigned char* use, Scalar bound, const Vec3& pivot, Scalar* cost, Mat6* A = nullptr,
               Vec6* b = nullptr) {
  Scalar sum = 0;
  if (A != nullptr) {
    A->setZero();
    b->setZero();
  }
  for (int i = 0; i < count; ++i) {
    if (!is_used(use, i)) continue;
    Vec2 pixel;
    Mat26 J;
    if (!project_from_pose(camera, pose.q_WC, pose.p_WC, points[i].m, points[i].w, pivot, &pixel,
                           A != nullptr ? &J : nullptr))
      return false;
    const Vec2 r = points[i].pixel - pixel;
    Scalar weight;
    sum += robust(r.squaredNorm(), bound, &weight);
    if (A != nullptr) {
      *A += weight * J.transpose().lazyProduct(J);
      *b += weight * J.transpose().lazyProduct(r);
    }
  }
  if (!std::isfinite(sum)) return false;
  *cost = sum;
  return true;
}

PoseEstimate moved(const PoseEstimate& pose, const Vec3& pivot, const Vec6& step) {
  PoseEstimate out = pose;
  const Quat rotation = exp_so3(step.head<3>());
  out.q_WC = (rotation * pose.q_WC).normalized();
  out.p_WC = pivot + rotation * (pose.p_WC - pivot) + step.tail<3>();
  return out;
}

/// Covariance of the error about the pivot, as one about the camera: e = e_pivot + θ x (p - pivot).
Mat6 about_camera(const Mat6& P, const Vec3& arm) {
  Mat6 T = Mat6::Identity();
  T.block<3, 3>(3, 0) = -hat(arm);
  const Mat6 TP = T.lazyProduct(P);
  return TP.lazyProduct(T.transpose());
}

/// Sum of min(r², bound²), at most `best`: no more is added up once it is larger.
Scalar truncated_cost(const Camera& camera, const Quat& q_WC, const Vec3& p_WC, const PnpPoint* points, int count,
                      Scalar bound2, Scalar best) {
  const Mat3 R_CW = q_WC.conjugate().toRotationMatrix();
  Scalar sum = 0;
  for (int i = 0; i < count && sum < best; ++i) {
    Vec2 z;
    if (project(camera, R_CW.lazyProduct(points[i].m - points[i].w * p_WC), &z))
      sum += std::min(bound2, (points[i].pixel - z).squaredNorm());
    else
      sum += bound2;
  }
  return sum;
}

/// Marks the points within the bound. Returns how many.
int mark_inliers(const Camera& camera, const PoseEstimate& pose, const PnpPoint* points, int count, Scalar bound2,
                 unsigned char* inliers) {
  const Mat3 R_CW = pose.q_WC.conjugate().toRotationMatrix();
  int found = 0;
  for (int i = 0; i < count; ++i) {
    Vec2 z;
    inliers[i] = project(camera, R_CW.lazyProduct(points[i].m - points[i].w * pose.p_WC), &z) &&
                         (points[i].pixel - z).squaredNorm() < bound2
                     ? 1
                     : 0;
    found += inliers[i];
  }
  return found;
}

/// Draws after which a set of right points was missed with probability kMissedTriple, at a share of right points.
int needed_trials(Scalar share, int max_trials) {
  const Scalar right = share * share * share;
  if (!(right > Scalar(0))) return max_trials;
  if (right >= Scalar(1)) return 1;
  const Scalar trials = std::log(kMissedTriple) / std::log(Scalar(1) - right);
  return trials < static_cast<Scalar>(max_trials) ? static_cast<int>(std::ceil(trials)) : max_trials;
}

}  // namespace

bool project_from_pose(const Camera& camera, const Quat& q_WC, const Vec3& p_WC, const Vec3& m, Scalar w,
                       const Vec3& pivot, Vec2* pixel, Mat26* J_pixel_pose) {
  const Mat3 R_CW = q_WC.conjugate().toRotationMatrix();
  const Vec3 p_C = R_CW * (m - w * p_WC);
  Mat23 J_pixel_C;
  if (!project(camera, p_C, pixel, J_pixel_pose != nullptr ? &J_pixel_C : nullptr)) return false;
  if (J_pixel_pose != nullptr) {
    const Mat23 J_pixel_W = J_pixel_C * R_CW;
    J_pixel_pose->leftCols<3>() = J_pixel_W * hat(m - w * pivot);
    J_pixel_pose->rightCols<3>() = -w * J_pixel_W;
  }
  return true;
}

bool refine_pnp(const Camera& camera, const PnpPoint* points, int count, const unsigned char* use,
                const PnpRefinement& options, PoseEstimate* inout) {
  Scalar used = 0, near = 0;
  for (int i = 0; i < count; ++i) {
    used += is_used(use, i) ? Scalar(1) : Scalar(0);
    near += is_used(use, i) && points[i].w > Scalar(0) ? Scalar(1) : Scalar(0);
  }
  if (used < Scalar(3)) return false;
  Vec3 pivot = Vec3::Zero();
  for (int i = 0; i < count; ++i)
    if (is_used(use, i) && points[i].w > Scalar(0)) pivot += points[i].m / points[i].w / near;

  const Scalar bound = options.huber * options.sigma_px;
  PoseEstimate pose = *inout;
  Mat6 A;
  Vec6 b;
  Scalar cost;
  SmallCholesky<6> factored;
  if (!residuals(camera, pose, points, count, use, bound, pivot, &cost, &A, &b)) return false;
  Scalar damping = kFirstDamping;
  for (int i = 0; i < options.max_rounds; ++i) {
    Mat6 damped = A;
    damped.diagonal() *= 1 + damping;
    if (!factored.factor(damped)) return false;
    const Vec6 step = factored.solve<1>(b);
    const PoseEstimate next = moved(pose, pivot, step);
    Scalar next_cost;
    if (residuals(camera, next, points, count, use, bound, pivot, &next_cost) && next_cost <= cost) {
      const bool done = cost - next_cost <= 16 * std::numeric_limits<Scalar>::epsilon() * cost;
      pose = next;
      if (!residuals(camera, pose, points, count, use, bound, pivot, &cost, &A, &b)) return false;
      damping *= Scalar(0.1);
      if (done) break;
    } else {
      damping *= 10;
      if (damping > kMaxDamping) break;
    }
  }
  if (!factored.factor(A)) return false;
  pose.covariance = about_camera(options.sigma_px * options.sigma_px * factored.inverse(), pose.p_WC - pivot);
  pose.rms_px = std::sqrt(cost / (2 * used));
  *inout = pose;
  return true;
}

int find_pose(const Camera& camera, const PnpPoint* points, int count, const PnpSearch& options, std::uint32_t* random,
              PoseEstimate* inout, unsigned char* inliers) {
  const Scalar bound2 = options.max_residual_px * options.max_residual_px;
  PoseEstimate best = *inout;
  Scalar cost = truncated_cost(camera, best.q_WC, best.p_WC, points, count, bound2, std::numeric_limits<Scalar>::max());
  int found = mark_inliers(camera, best, points, count, bound2, inliers);
  int trials =
      count < 3 ? 0 : needed_trials(static_cast<Scalar>(found) / static_cast<Scalar>(count), options.max_trials);
  RandomTriples triples(count, *random);
  for (int trial = 0; trial < trials; ++trial) {
    int three[3];
    Vec3 p_W[3], ray_C[3];
    triples.draw(three);
    bool usable = true;
    for (int k = 0; k < 3 && usable; ++k) {
      const PnpPoint& point = points[three[k]];
      usable = point.w > kMinParallelism * point.m.norm() && unproject(camera, point.pixel, &ray_C[k]);
      if (usable) p_W[k] = point.m / point.w;
    }
    CameraPose pose[kMaxP3pSolutions];
    const int solutions = usable ? solve_p3p(p_W, ray_C, pose) : 0;
    for (int k = 0; k < solutions; ++k) {
      const Scalar c = truncated_cost(camera, pose[k].q_WC, pose[k].p_WC, points, count, bound2, cost);
      if (!(c < cost)) continue;
      cost = c;
      best.q_WC = pose[k].q_WC;
      best.p_WC = pose[k].p_WC;
      found = mark_inliers(camera, best, points, count, bound2, inliers);
      trials = std::min(
          trials, std::max(trial + 1,
                           needed_trials(static_cast<Scalar>(found) / static_cast<Scalar>(count), options.max_trials)));
    }
  }
  *random = triples.state();
  for (int round = 0; round < 2; ++round) {
    found = mark_inliers(camera, best, points, count, bound2, inliers);
    if (found < std::max(3, options.min_inliers) ||
        !refine_pnp(camera, points, count, inliers, options.refinement, &best))
      return 0;
  }
  found = mark_inliers(camera, best, points, count, bound2, inliers);
  if (found < options.min_inliers) return 0;
  *inout = best;
  return found;
}

}  // namespace pf
