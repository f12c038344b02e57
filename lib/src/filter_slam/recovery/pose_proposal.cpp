#include "filter_slam/recovery/pose_proposal.h"

#include <algorithm>

#include "base/limits.h"
#include "base/random_triples.h"
#include "filter_slam/recovery/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "observe/point.h"

namespace pf {
namespace {

using namespace tuning::pose_proposal;

struct Problem {
  const Camera& camera;
  const Body& prior;
  const Mat6& information;
  const Vec3* f_W;
  const Vec2* pixel;
  Scalar weight;

  /// False if a point is not in front of the camera or the matches do not determine a pose.
  bool fit(const short* index, int count, Body* pose) const {
    for (int step = 0; step < kSteps; ++step) {
      Vec6 e;
      e << log_so3(pose->q_WC * prior.q_WC.conjugate()), pose->p_W - prior.p_W;
      Mat6 A = information;
      Vec6 b = -information.lazyProduct(e);
      const CameraAt at = camera_at(*pose);
      for (int k = 0; k < count; ++k) {
        Vec2 z;
        Mat26 J;
        Mat23 J_f;
        if (!observe_point(camera, at, f_W[index[k]], &z, &J, &J_f)) return false;
        A += weight * J.transpose().lazyProduct(J);
        b += weight * J.transpose().lazyProduct(pixel[index[k]] - z);
      }
      SmallCholesky<6> cholesky;
      if (!cholesky.factor(A)) return false;
      const Vec6 d = cholesky.solve<1>(b);
      const Vec3 theta = d.head<3>();
      if (!(theta.squaredNorm() < kMaxStep2)) return false;
      pose->q_WC = (exp_so3(theta) * pose->q_WC).normalized();
      pose->p_W += d.tail<3>();
      if (d.squaredNorm() < kSmallStep2) break;
    }
    return true;
  }

  /// Cost of all matches, each at most that of three sigma.
  Scalar judge(const Body& pose, int count, short* index, int* inliers) const {
    const CameraAt at = camera_at(pose);
    Scalar cost = 0;
    *inliers = 0;
    for (int i = 0; i < count; ++i) {
      Vec2 z;
      Mat26 J;
      Mat23 J_f;
      Scalar d2 = 9;
      if (observe_point(camera, at, f_W[i], &z, &J, &J_f)) d2 = std::min(d2, weight * (pixel[i] - z).squaredNorm());
      cost += d2;
      if (d2 < 9) index[(*inliers)++] = static_cast<short>(i);
    }
    return cost;
  }
};

}  // namespace

int propose_pose(const Camera& camera, const Mat6& P, const Vec3* f_W, const Vec2* pixel, int count, Scalar sigma_px,
                 Body* pose) {
  count = std::min(count, kMaxObservations);
  if (count < 4) return 0;
  const Body prior = *pose;
  Mat6 information = Mat6::Zero();
  SmallCholesky<6> cholesky;
  if (cholesky.factor(P)) information = cholesky.solve<6>(Mat6::Identity());
  const Problem problem{camera, prior, information, f_W, pixel, Scalar(1) / (sigma_px * sigma_px)};
  short index[kMaxObservations];
  int inliers = 0;
  Scalar best = problem.judge(prior, count, index, &inliers);
  RandomTriples random(count, 7);
  for (int trial = 0; trial < kTrials; ++trial) {
    int drawn[3];
    random.draw(drawn);
    const short three[3] = {static_cast<short>(drawn[0]), static_cast<short>(drawn[1]), static_cast<short>(drawn[2])};
    Body body = prior;
    if (!problem.fit(three, 3, &body)) continue;
    const Scalar cost = problem.judge(body, count, index, &inliers);
    if (cost >= best) continue;
    best = cost;
    pose->q_WC = body.q_WC;
    pose->p_W = body.p_W;
  }
  problem.judge(*pose, count, index, &inliers);
  for (int refit = 0; refit < kRefits && inliers >= 4; ++refit) {
    Body body = *pose;
    if (!problem.fit(index, inliers, &body)) break;
    const Scalar cost = problem.judge(body, count, index, &inliers);
    if (cost >= best) break;
    best = cost;
    pose->q_WC = body.q_WC;
    pose->p_W = body.p_W;
  }
  problem.judge(*pose, count, index, &inliers);
  return inliers;
}

}  // namespace pf
