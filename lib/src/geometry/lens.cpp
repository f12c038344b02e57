#include "geometry/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/small_cholesky.h"

namespace pf {
namespace {

constexpr Scalar kLeastReadout = Scalar(1e-6);  ///< [s] of one that is estimated: there are no rows below zero

Scalar* parameter_of(Camera* camera, int index) {
  Scalar* const intrinsics[4] = {&camera->fx, &camera->fy, &camera->cx, &camera->cy};
  if (index == kReadoutParameter) return &camera->readout;
  return index < 4 ? intrinsics[index] : &camera->distortion[index - 4];
}

void put_radtan(const Camera& c, const Vec2& m, LensJacobian* J) {
  const Scalar x = m.x(), y = m.y(), r2 = m.squaredNorm();
  const Vec2 by[5] = {m * r2, m * r2 * r2, Vec2(2 * x * y, r2 + 2 * y * y), Vec2(r2 + 2 * x * x, 2 * x * y),
                      m * r2 * r2 * r2};
  for (int i = 0; i < 5; ++i) J->col(4 + i) = Vec2(c.fx * by[i].x(), c.fy * by[i].y());
}

}  // namespace

LensJacobian lens_jacobian(const Camera& c, const Vec3& p_C) {
  LensJacobian J = LensJacobian::Zero();
  J(0, 2) = J(1, 3) = Scalar(1);
  if (static_cast<CameraModel>(c.model) == CameraModel::kEquidistant) {
    const Scalar r = std::hypot(p_C.x(), p_C.y());
    const Scalar theta = std::atan2(r, p_C.z());
    const bool on_axis = !(r > std::numeric_limits<Scalar>::min());
    const Vec2 e = on_axis ? Vec2(0, 0) : Vec2(p_C.x() / r, p_C.y() / r);
    Scalar theta_d = theta, power = theta;
    for (int i = 0; i < 4; ++i) {
      power *= theta * theta;
      theta_d += c.distortion[i] * power;
      J.col(4 + i) = Vec2(c.fx * e.x() * power, c.fy * e.y() * power);
    }
    J(0, 0) = e.x() * theta_d;
    J(1, 1) = e.y() * theta_d;
    return J;
  }
  const Vec2 m(p_C.x() / p_C.z(), p_C.y() / p_C.z());
  Vec2 pixel;
  if (!project(c, p_C, &pixel)) return J;
  J(0, 0) = (pixel.x() - c.cx) / c.fx;
  J(1, 1) = (pixel.y() - c.cy) / c.fy;
  if (static_cast<CameraModel>(c.model) == CameraModel::kRadtan) put_radtan(c, m, &J);
  if (static_cast<CameraModel>(c.model) == CameraModel::kDivision) {
    const Vec2 u(c.fx * m.x(), c.fy * m.y());
    const Scalar k = c.distortion[0], s = 1 / std::sqrt(1 + 2 * k * u.squaredNorm()), s3 = s * s * s;
    J.col(4) = -u.squaredNorm() * s3 * u;
    J.col(0) += -2 * k * s3 * c.fx * m.x() * m.x() * u;
    J.col(1) += -2 * k * s3 * c.fy * m.y() * m.y() * u;
  }
  return J;
}

LensPrior make_lens_prior(const LensSigmas& sigmas, Camera* camera) {
  if (static_cast<CameraModel>(camera->model) == CameraModel::kPinhole && sigmas.distortion[0] > Scalar(0)) {
    camera->model = static_cast<int>(CameraModel::kRadtan);
    init_camera(camera);
  }
  LensPrior prior;
  Scalar sigma[kLensParameters] = {0, 0, sigmas.centre, sigmas.centre};
  for (int i = 0; i < kLensDistortion; ++i) sigma[4 + i] = sigmas.distortion[i];
  sigma[kReadoutParameter] = sigmas.readout;
  const Scalar common = sigmas.focal * sigmas.focal, between = sigmas.aspect * sigmas.aspect / 4;
  sigma[0] = camera->fx * std::sqrt(common + between);
  sigma[1] = camera->fy * std::sqrt(common + between);
  for (int i = 0; i < kLensParameters; ++i) {
    if (!(sigma[i] > Scalar(0))) continue;
    prior.variance[prior.rows.count] = sigma[i] * sigma[i];
    prior.rows.parameter[prior.rows.count++] = static_cast<std::int8_t>(i);
  }
  prior.between_focal = camera->fx * camera->fy * (common - between);
  return prior;
}

LensPrior shape_prior(const LensPrior& prior) {
  LensPrior out = prior;
  out.rows.count = prior.rows.shape_count();  // the readout is the last row
  return out;
}

void lens_difference(const LensRows& rows, const Camera& from, const Camera& to, Scalar* e) {
  Camera a = from, b = to;
  for (int i = 0; i < rows.count; ++i)
    e[i] = *parameter_of(&b, rows.parameter[i]) - *parameter_of(&a, rows.parameter[i]);
}

void move_lens(const LensRows& rows, const Scalar* e, Camera* camera) {
  for (int i = 0; i < rows.count; ++i) *parameter_of(camera, rows.parameter[i]) += e[i];
  if (rows.has_readout()) camera->readout = std::max(camera->readout, kLeastReadout);
  init_camera(camera);
}

/// The covariance of a prior is positive definite.
LensPrior readout_prior(const LensPrior& prior) {
  LensPrior out;
  if (!prior.rows.has_readout()) return out;
  out.rows.count = 1;
  out.rows.parameter[0] = kReadoutParameter;
  out.variance[0] = prior.variance[prior.rows.count - 1];
  return out;
}

void lens_information(const LensPrior& prior, Scalar inflation, Scalar* information) {
  const int n = prior.rows.count;
  Scalar L[kLensParameters * kLensParameters];
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) L[a * n + b] = prior.covariance(a, b);
  factor_cholesky(L, n, n);
  for (int c = 0; c < n; ++c) {
    Scalar x[kLensParameters] = {};
    x[c] = inflation;
    solve_cholesky(L, n, n, x);
    for (int a = 0; a < n; ++a) information[a * n + c] = x[a];
  }
}

}  // namespace pf
