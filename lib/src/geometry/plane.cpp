#include "geometry/plane.h"

#include <cmath>

#include "geometry/so3.h"
#include "geometry/symmetric_eigen.h"

namespace pf {

Vec3 plane_point(const PlaneFrame& frame, const Vec3& x, const Vec2& uv, Mat3* J_p_x, Mat32* J_p_uv) {
  const Mat3& R = frame.R_WP;
  if (J_p_x != nullptr) {
    J_p_x->col(0) = uv.x() * R.col(2);
    J_p_x->col(1) = uv.y() * R.col(2);
    J_p_x->col(2) = R.col(2);
  }
  if (J_p_uv != nullptr) {
    J_p_uv->col(0) = R.col(0) + x(0) * R.col(2);
    J_p_uv->col(1) = R.col(1) + x(1) * R.col(2);
  }
  return frame.o_W + R * Vec3(uv.x(), uv.y(), x(2) + x(0) * uv.x() + x(1) * uv.y());
}

Vec2 plane_coordinates(const PlaneFrame& frame, const Vec3& p_W) {
  const Vec3 q = frame.R_WP.transpose() * (p_W - frame.o_W);
  return q.head<2>();
}

void plane_normal(const PlaneFrame& frame, const Vec3& x, Vec3* n_W, Scalar* d_W, Mat3* J_n_x, Mat13* J_d_x) {
  const Scalar w = 1 / std::sqrt(1 + x(0) * x(0) + x(1) * x(1));
  const Vec3 n = frame.R_WP * Vec3(-x(0) * w, -x(1) * w, w);
  const Vec3 foot = frame.o_W + x(2) * frame.R_WP.col(2);
  if (J_n_x != nullptr || J_d_x != nullptr) {
    // d n/d a = -w e1 - a w² n
    Mat3 J;
    J.col(0) = -w * frame.R_WP.col(0) - x(0) * w * w * n;
    J.col(1) = -w * frame.R_WP.col(1) - x(1) * w * w * n;
    J.col(2).setZero();
    if (J_n_x != nullptr) *J_n_x = J;
    if (J_d_x != nullptr) *J_d_x << foot.dot(J.col(0)), foot.dot(J.col(1)), w;
  }
  *n_W = n;
  *d_W = n.dot(foot);
}

Scalar plane_distance(const PlaneFrame& frame, const Vec3& x, const Vec3& p_W, Mat13* J_r_x, Mat13* J_r_p) {
  const Scalar w = 1 / std::sqrt(1 + x(0) * x(0) + x(1) * x(1));
  const Vec3 q = frame.R_WP.transpose() * (p_W - frame.o_W);
  const Scalar r = w * (q.z() - x(2) - x(0) * q.x() - x(1) * q.y());
  if (J_r_x != nullptr) *J_r_x << -w * q.x() - r * x(0) * w * w, -w * q.y() - r * x(1) * w * w, -w;
  if (J_r_p != nullptr) *J_r_p = (frame.R_WP * Vec3(-x(0) * w, -x(1) * w, w)).transpose();
  return r;
}

Mat37 plane_gauge(const PlaneFrame& frame, const Vec3& x) {
  const Mat3& R = frame.R_WP;
  const Vec3 m_W = R * Vec3(-x(0), -x(1), 1);
  const Vec3 g1_W = R * Vec3(1, 0, x(0)), g2_W = R * Vec3(0, 1, x(1));
  const Vec3 foot = frame.o_W + x(2) * R.col(2);
  Mat37 G = Mat37::Zero();
  G.block<1, 3>(2, 0) = m_W.transpose();
  // m · (θ x g) = θ · (g x m)
  G.block<1, 3>(0, 3) = g1_W.cross(m_W).transpose();
  G.block<1, 3>(1, 3) = g2_W.cross(m_W).transpose();
  G.block<1, 3>(2, 3) = foot.cross(m_W).transpose();
  G(2, 6) = m_W.dot(foot);
  return G;
}

PlaneFrame lying_frame(const PlaneFrame& frame, const Vec3& x) {
  PlaneFrame out;
  Vec3 n_W;
  Scalar d;
  plane_normal(frame, x, &n_W, &d);
  const Vec3 e1 = frame.R_WP.col(0);
  out.R_WP.col(0) = (e1 - n_W * n_W.dot(e1)).normalized();
  out.R_WP.col(1) = n_W.cross(out.R_WP.col(0));
  out.R_WP.col(2) = n_W;
  out.o_W = frame.o_W + x(2) * frame.R_WP.col(2);
  return out;
}

Mat3 plane_error_jacobian() { return Vec3(-1, -1, 1).asDiagonal(); }

bool reframe_plane(const PlaneFrame& from, const Vec3& x, const PlaneFrame& to, Vec3* x_new, Mat3* J_new_old) {
  // Not normalised: m · (p_W - foot) = 0.
  const Vec3 m = to.R_WP.transpose() * (from.R_WP * Vec3(-x(0), -x(1), 1));
  const Vec3 foot = to.R_WP.transpose() * (from.o_W + x(2) * from.R_WP.col(2) - to.o_W);
  if (!(std::abs(m.z()) > Scalar(0.17) * m.norm())) return false;
  const Scalar a = -m.x() / m.z(), b = -m.y() / m.z();
  const Scalar h = foot.z() - a * foot.x() - b * foot.y();
  if (J_new_old != nullptr) {
    const Mat3 R = to.R_WP.transpose() * from.R_WP;
    for (int i = 0; i < 2; ++i) {
      const Vec3 dm = -R.col(i);
      const Scalar da = -(dm.x() + a * dm.z()) / m.z(), db = -(dm.y() + b * dm.z()) / m.z();
      J_new_old->col(i) = Vec3(da, db, -da * foot.x() - db * foot.y());
    }
    const Vec3 df = R.col(2);
    J_new_old->col(2) = Vec3(0, 0, df.z() - a * df.x() - b * df.y());
  }
  *x_new = Vec3(a, b, h);
  return true;
}

bool fit_plane(const Vec3* points_W, int count, const Vec3& viewer_W, PlaneFit* fit) {
  if (count < 3) return false;
  Vec3 mean = Vec3::Zero();
  for (int i = 0; i < count; ++i) mean += points_W[i] / static_cast<Scalar>(count);
  Mat3 C = Mat3::Zero(), V;
  for (int i = 0; i < count; ++i) C += (points_W[i] - mean) * (points_W[i] - mean).transpose();
  Vec3 lambda;
  symmetric_eigen(C, &lambda, &V);
  if (!(lambda(1) > Scalar(1e-6) * lambda(2)) || !std::isfinite(lambda(2))) return false;
  const Scalar side = V.col(0).dot(viewer_W - mean) < 0 ? Scalar(-1) : Scalar(1);
  fit->frame.R_WP.col(0) = V.col(1);
  fit->frame.R_WP.col(1) = side * V.col(2);
  fit->frame.R_WP.col(2) = side * V.col(0);
  fit->frame.o_W = mean;
  fit->lambda = lambda;
  fit->count = count;
  return true;
}

Mat3 fit_plane_jacobian(const PlaneFit& fit, const Vec3& p_W) {
  const Vec3 r = p_W - fit.frame.o_W, n = fit.frame.R_WP.col(2);
  Mat3 J;
  for (int i = 0; i < 2; ++i) {
    const Vec3 e = fit.frame.R_WP.col(i);
    J.row(i) = (r.dot(n) * e + r.dot(e) * n).transpose() / (fit.lambda(i + 1) - fit.lambda(0));
  }
  J.row(2) = n.transpose() / static_cast<Scalar>(fit.count);
  return J;
}

}  // namespace pf
