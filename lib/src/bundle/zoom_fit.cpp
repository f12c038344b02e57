#include "bundle/zoom_fit.h"

#include <algorithm>
#include <cmath>

#include "bundle/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {

using namespace tuning::zoom_fit;

bool project_zoomed(const Camera& camera, const CameraPose& pose, Scalar s, const PnpPoint& point, Vec2* u,
                    Mat26* J_pose, Vec2* J_s) {
  const Vec2 centre(camera.cx, camera.cy);
  Vec2 z;
  if (!project_from_pose(camera, pose.q_WC, pose.p_WC, point.m, point.w, pose.p_WC, &z, J_pose)) return false;
  *J_s = std::exp(s) * (z - centre);
  *J_pose *= std::exp(s);
  *u = centre + *J_s;
  return true;
}

void ZoomPoints::add(const PnpPoint& point, Scalar variance, const Vec2& by_readout) {
  if (count_ < kMax && variance > Scalar(0)) point_[count_++] = {point, variance, by_readout};
}

ZoomFit ZoomPoints::fit(const Camera& camera, const CameraPose& near) const {
  CameraPose pose = near;
  ZoomFit out;
  if (count_ < kLeastPoints) return out;
  Scalar s = 0, variance = 0;
  for (int round = 0; round < kRounds; ++round) {
    Mat6 A = Mat6::Zero();
    Vec6 a = Vec6::Zero(), b = Vec6::Zero();
    Scalar c = 0, g = 0, chi2 = 0;
    Vec6 h = Vec6::Zero();  // of the readout, in its standard deviation
    Scalar k = 0, f = 0, q = 1;
    for (int i = 0; i < count_; ++i) {
      const PnpPoint& point = point_[i].point;
      Vec2 u, by_zoom;
      Mat26 J;
      if (!project_zoomed(camera, pose, s, point, &u, &J, &by_zoom)) return out;
      const Vec2 r = point.pixel - u;
      const Scalar weight = 1 / point_[i].variance;
      A += weight * J.transpose().lazyProduct(J);
      a += weight * J.transpose().lazyProduct(by_zoom);
      b += weight * J.transpose().lazyProduct(r);
      c += weight * by_zoom.squaredNorm();
      g += weight * by_zoom.dot(r);
      chi2 += weight * r.squaredNorm();
      const Vec2 by_readout = weight * point_[i].by_readout;
      h += J.transpose().lazyProduct(by_readout);
      k += by_zoom.dot(by_readout);
      f += by_readout.dot(r);
      q += by_readout.dot(point_[i].by_readout);
    }
    A -= h * h.transpose() / q;
    a -= h * (k / q);
    b -= h * (f / q);
    c -= k * k / q;
    g -= k * f / q;
    chi2 -= f * f / q;
    SmallCholesky<6> factored;
    if (!factored.factor(A)) return out;
    const Vec6 A_a = factored.solve<1>(a);
    const Scalar information = c - a.dot(A_a);
    if (!(information > kLeastShare * c)) return out;
    const Scalar step = (g - A_a.dot(b)) / information;
    const Vec6 move = factored.solve<1>(Vec6(b - step * a));
    if (!std::isfinite(step + move.sum())) return out;
    pose.q_WC = (exp_so3(Vec3(move.head<3>())) * pose.q_WC).normalized();
    pose.p_WC += move.tail<3>();
    s += step;
    variance = std::max(Scalar(1), chi2 / static_cast<Scalar>(2 * count_ - 7)) / information;
  }
  if (!(std::abs(s) < kMost)) return out;
  out.log_ratio = s;
  out.variance = variance;
  return out;
}

}  // namespace pf
