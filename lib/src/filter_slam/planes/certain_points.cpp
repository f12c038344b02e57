#include "filter_slam/planes/certain_points.h"

#include "filter_slam/features/tuning.h"
#include "frame/tuning.h"
#include "geometry/symmetric_eigen.h"

namespace pf {
namespace {

Scalar largest_eigenvalue(const Mat3& C) {
  Vec3 lambda;
  Mat3 V;
  symmetric_eigen(C, &lambda, &V);
  return lambda(2);
}

}  // namespace

bool CertainPoints::knows_scale() const {
  using tuning::plane_walls::kKnownScale;
  return scale_.parts > 0 && filter_.variance_of(scale_) < kKnownScale * kKnownScale;
}

bool CertainPoints::is_converged(int entry) const {
  if (!map_.features.used(entry) || map_.features[entry].is_target) return false;
  const Feature& f = map_.features[entry];
  return filter_.state().block[f.slot].kind == BlockKind::kPoint && f.rejections == 0 &&
         f.observations >= tuning::plane_keeper::kConverged;
}

bool CertainPoints::is_settled(int entry) const { return is_converged(entry) && !map_.features[entry].was_missed; }

bool CertainPoints::is_certain(int entry, Mat3* covariance) const {
  *covariance = filter_.relative_covariance(map_.features[entry].slot, scale_);
  const Scalar limit = settings_.fold_sigma * settings_.fold_sigma;
  return (*covariance)(0, 0) + (*covariance)(1, 1) + (*covariance)(2, 2) < limit ||
         largest_eigenvalue(*covariance) < limit;
}

}  // namespace pf
