#include "keyframe_slam/tracking/pose.h"

#include <algorithm>
#include <cmath>

#include "belief/pose_evidence.h"
#include "bundle/bearing.h"
#include "frame/ellipse.h"
#include "frame/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {
namespace {

using namespace tuning::keyframe_pose;

constexpr Scalar kImpossible = Scalar(-1e6);  ///< ln of a density

/// The readout's error c, in its standard deviation, in the normal equations of a pose.
struct ReadoutTerm {
  Vec6 a = Vec6::Zero();
  Scalar q = 1, f = 0;

  void add(const Vec2& by_readout, const Mat2& W, const Vec2& r) {
    const Vec2 Wu = W * by_readout;
    q += by_readout.dot(Wu);
    f += Wu.dot(r);
  }
  void eliminate(Mat6* A, Vec6* b) const {
    *A -= a * a.transpose() / q;
    *b -= a * (f / q);
  }
};

Mat2 inverse2(const Mat2& S) {
  Mat2 inverse;
  inverse << S(1, 1), -S(0, 1), -S(1, 0), S(0, 0);
  return inverse / (S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0));
}

}  // namespace

bool fit_pose(const Camera& camera, const PoseMatch* matches, int count, const unsigned char* use,
              const PosePrior& prior, Scalar huber, CameraPose* inout, Mat6* information) {
  SmallCholesky<6> factored;
  if (!factored.factor(prior.covariance)) return false;
  const Mat6 prior_information = factored.inverse();
  CameraPose pose = *inout;
  Mat6 A;
  for (int round = 0; round < kRounds; ++round) {
    A.setZero();
    Vec6 b = Vec6::Zero();
    ReadoutTerm readout;
    for (int i = 0; i < count; ++i) {
      if (use[i] == 0) continue;
      const PnpPoint& point = matches[i].point;
      Vec2 z;
      Mat26 J;
      if (!project_from_pose(camera, pose.q_WC, pose.p_WC, point.m, point.w, pose.p_WC, &z, &J)) continue;
      const Vec2 r = point.pixel - z;
      Scalar weight;
      const Mat2 W = inverse2(matches[i].noise);
      huber_cost(r.dot(W * r), huber, &weight);
      const Eigen::Matrix<Scalar, 6, 2> JW = weight * J.transpose().lazyProduct(W);
      A += JW.lazyProduct(J);
      b += JW.lazyProduct(r);
      readout.a += JW.lazyProduct(matches[i].by_readout);
      readout.add(matches[i].by_readout, weight * W, r);
    }
    readout.eliminate(&A, &b);
    Vec6 e;
    e << log_so3(prior.q_WC * pose.q_WC.conjugate()), prior.p_W - pose.p_WC;
    if (!factored.factor(Mat6(A + prior_information))) return false;
    const Vec6 step = factored.solve<1>(Vec6(b + prior_information.lazyProduct(e)));
    pose.q_WC = (exp_so3(step.head<3>()) * pose.q_WC).normalized();
    pose.p_WC += step.tail<3>();
    if (!std::isfinite(step.sum())) return false;
    if (step.squaredNorm() < kSmallStep2) break;
  }
  *inout = pose;
  *information = A;
  return true;
}

Scalar log_density(const Camera& camera, const PoseMatch* matches, int count, const unsigned char* use,
                   const PosePrior& prior, const CameraPose& pose, const Mat6& information) {
  SmallCholesky<6> P, posterior;
  if (!P.factor(prior.covariance) || !posterior.factor(Mat6(P.inverse() + information))) return kImpossible;
  Vec6 e;
  e << log_so3(prior.q_WC * pose.q_WC.conjugate()), prior.p_W - pose.p_WC;
  Scalar sum = -(e.dot(P.solve<1>(e)) + P.log_det() + posterior.log_det()) / 2;
  ReadoutTerm readout;
  for (int i = 0; i < count; ++i) {
    if (use[i] == 0) continue;
    const PnpPoint& point = matches[i].point;
    Vec2 z;
    if (!project_from_pose(camera, pose.q_WC, pose.p_WC, point.m, point.w, pose.p_WC, &z)) return kImpossible;
    const Vec2 r = point.pixel - z;
    readout.add(matches[i].by_readout, inverse2(matches[i].noise), r);
    sum += log_normal_density(squared_distance(r, matches[i].noise), std::log(matches[i].noise.determinant()), 1);
  }
  return sum + (readout.f * readout.f / readout.q - std::log(readout.q)) / 2;
}

bool KeyframePose::layout(Arena& arena, int capacity) {
  const std::size_t count = static_cast<std::size_t>(capacity);
  match_ = arena.take<PoseMatch>(count);
  point_ = arena.take<PnpPoint>(count);
  inlier_ = arena.take<unsigned char>(count);
  return arena.ok();
}

void KeyframePose::init() { random_ = kSeed; }

int KeyframePose::find(const Camera& camera, int count, const PosePrior& prior, Scalar bound_px, int least,
                       CameraPose* pose, Mat6* information) {
  PoseEstimate estimate;
  estimate.q_WC = prior.q_WC;
  estimate.p_WC = prior.p_W;
  for (int i = 0; i < count; ++i) point_[i] = match_[i].point;
  const PnpSearch search = {bound_px, kTrials, least, {bound_px / kBoundSigmas, kHuber, kRefinementRounds}};
  const int inliers = find_pose(camera, point_, count, search, &random_, &estimate, inlier_);
  if (inliers == 0) return 0;
  CameraPose found = {estimate.q_WC, estimate.p_WC};
  Mat6 A;
  if (!fit_pose(camera, match_, count, inlier_, prior, kHuber, &found, &A)) return 0;
  *pose = found;
  *information = A;
  return inliers;
}

int KeyframePose::fit(const Camera& camera, int count, const PosePrior& prior, Scalar gate, CameraPose* pose,
                      Mat6* information) {
  std::fill(inlier_, inlier_ + count, static_cast<unsigned char>(1));
  CameraPose found = {prior.q_WC, prior.p_W};
  int inliers = 0;
  for (int pass = 0; pass < 2; ++pass) {
    if (!fit_pose(camera, match_, count, inlier_, prior, kHuber, &found, information)) return 0;
    inliers = 0;
    for (int i = 0; i < count; ++i) {
      Vec2 z;
      const PnpPoint& point = match_[i].point;
      const bool seen = project_from_pose(camera, found.q_WC, found.p_WC, point.m, point.w, found.p_WC, &z);
      const Mat2 S = match_[i].noise + Mat2::Identity() * (tuning::noise::kSearchSigma * tuning::noise::kSearchSigma);
      inlier_[i] = seen && squared_distance(point.pixel - z, S) < gate ? 1 : 0;
      inliers += inlier_[i];
    }
  }
  *pose = found;
  return inliers;
}

}  // namespace pf
