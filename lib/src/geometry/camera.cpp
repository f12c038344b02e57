#include "geometry/camera.h"

#include <cmath>
#include <limits>

#include "geometry/camera_distortion.h"

namespace pf {
namespace {

constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();

CameraModel model_of(const Camera& camera) { return static_cast<CameraModel>(camera.model); }

/// False where a model that the checks let pass overflows far from its axis.
bool is_finite(const Vec2& v) { return std::isfinite(v.x()) && std::isfinite(v.y()); }

/// Distorted position of m, relative to the principal point, in units of the focal length.
/// False outside the domain.
bool distort_flat(const Camera& c, const Vec2& m, Vec2* out, Mat2* J) {
  const Scalar r2 = m.squaredNorm();
  switch (model_of(c)) {
    case CameraModel::kPinhole:
      if (!(r2 <= c.max_r2)) return false;
      *out = m;
      if (J != nullptr) J->setIdentity();
      return true;
    case CameraModel::kRadtan:
      if (!(r2 <= c.max_r2)) return false;
      *out = distort_radtan(c.distortion, m, J);
      return true;
    case CameraModel::kDivision: {
      const Vec2 u(c.fx * m.x(), c.fy * m.y());
      const Scalar u2 = u.squaredNorm();
      if (!(u2 <= c.max_r2)) return false;
      const Scalar k2 = 2 * c.distortion[0];
      const Scalar s = 1 / std::sqrt(1 + k2 * u2), s3 = k2 * s * s * s;
      *out = s * m;
      if (J != nullptr) {
        *J << s - s3 * u.x() * u.x(), -s3 * u.x() * u.y() * (c.fy / c.fx),  //
            -s3 * u.x() * u.y() * (c.fx / c.fy), s - s3 * u.y() * u.y();
      }
      return true;
    }
    default:
      return false;
  }
}

/// The equidistant model, which also sees behind itself.
///
///   radial direction e = (x, y)/|(x, y)|, slopes  dθd/d|(x,y)| = θd' z/ρ²,  dθd/dz = -θd' |(x,y)|/ρ²
bool project_equidistant(const Camera& c, const Vec3& p, Vec2* pixel, Mat23* J) {
  const Scalar r = std::hypot(p.x(), p.y()), z = p.z();
  const Scalar rho2 = r * r + z * z;
  if (!(rho2 > kMinDepth * kMinDepth && rho2 <= kMaxDepth)) return false;
  const Scalar theta = std::atan2(r, z);
  if (!(theta * theta <= c.max_r2)) return false;
  Scalar slope;
  const Scalar theta_d = distort_theta(c.distortion, theta, &slope);
  const bool on_axis = !(r > std::numeric_limits<Scalar>::min());
  const Scalar along = slope * z / rho2;
  const Scalar across = on_axis ? along : theta_d / r;
  const Scalar ex = on_axis ? 0 : p.x() / r, ey = on_axis ? 0 : p.y() / r;
  const Vec2 z_px(c.fx * across * p.x() + c.cx, c.fy * across * p.y() + c.cy);
  if (!is_finite(z_px)) return false;
  *pixel = z_px;
  if (J != nullptr) {
    const Scalar d = along - across, dz = -slope * r / rho2;
    *J << c.fx * (across + ex * ex * d), c.fx * ex * ey * d, c.fx * ex * dz,  //
        c.fy * ex * ey * d, c.fy * (across + ey * ey * d), c.fy * ey * dz;
  }
  return true;
}

/// θ with θd(θ) = theta_d: Newton steps inside a bracket that shrinks, so that it always ends.
bool undistort_theta(const Camera& c, Scalar theta_d, Scalar* theta, Scalar* slope) {
  Scalar low = 0, high = std::sqrt(c.max_r2);
  if (!(theta_d <= distort_theta(c.distortion, high, slope))) return false;
  Scalar t = theta_d < high ? theta_d : high;
  for (int i = 0; i < 60; ++i) {
    const Scalar error = distort_theta(c.distortion, t, slope) - theta_d;
    if (error > 0) {
      high = t;
    } else {
      low = t;
    }
    Scalar next = t - error / *slope;
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    const Scalar step = std::abs(next - t);
    t = next;
    if (step <= 2 * kEpsilon * t) break;
  }
  distort_theta(c.distortion, t, slope);
  *theta = t;
  return true;
}

bool unproject_equidistant(const Camera& c, const Vec2& m, Vec3* ray, Mat32* J_ray_m) {
  const Scalar theta_d = m.norm();
  Scalar theta, slope;
  if (!std::isfinite(theta_d)) return false;
  if (!undistort_theta(c, theta_d, &theta, &slope)) return false;
  const bool on_axis = !(theta_d > std::numeric_limits<Scalar>::min());
  const Vec2 e = on_axis ? Vec2(0, 0) : Vec2(m / theta_d);
  const Scalar sine = std::sin(theta), cosine = std::cos(theta);
  const Scalar across = on_axis ? 1 / slope : sine / theta_d, along = cosine / slope;
  *ray = Vec3(sine * e.x(), sine * e.y(), cosine);
  if (J_ray_m != nullptr) {
    const Scalar d = along - across, dz = -sine / slope;
    *J_ray_m << across + e.x() * e.x() * d, e.x() * e.y() * d,  //
        e.x() * e.y() * d, across + e.y() * e.y() * d,          //
        e.x() * dz, e.y() * dz;
  }
  return true;
}

/// m whose distortion is target. Inside the domain the Jacobian is symmetric and positive definite, so the map is the
/// gradient of a convex function and Newton with backtracking finds the one solution if there is one.
bool undistort_radtan(const Camera& c, const Vec2& target, Vec2* m, Mat2* J) {
  const Scalar limit = std::sqrt(c.max_r2);
  const Scalar start = target.norm();
  Vec2 x = start > limit ? Vec2(target * (Scalar(0.9) * limit / start)) : target;
  Vec2 error = distort_radtan(c.distortion, x, J) - target;
  Scalar e2 = error.squaredNorm();
  const Scalar tolerance = 32 * kEpsilon * (1 + start), enough = kEpsilon * kEpsilon * e2;
  for (int i = 0; i < 40 && e2 > enough && e2 > 0; ++i) {
    const Scalar det = (*J)(0, 0) * (*J)(1, 1) - (*J)(0, 1) * (*J)(1, 0);
    const Vec2 step =
        Vec2((*J)(1, 1) * error.x() - (*J)(0, 1) * error.y(), (*J)(0, 0) * error.y() - (*J)(1, 0) * error.x()) / det;
    Scalar fraction = 1;
    bool better = false;
    for (int k = 0; k < 12 && !better; ++k, fraction /= 2) {
      const Vec2 next = x - fraction * step;
      if (!(next.squaredNorm() <= c.max_r2)) continue;
      Mat2 J_next;
      const Vec2 next_error = distort_radtan(c.distortion, next, &J_next) - target;
      if (!(next_error.squaredNorm() < e2)) continue;
      x = next;
      error = next_error;
      e2 = error.squaredNorm();
      *J = J_next;
      better = true;
    }
    if (!better) break;
  }
  if (!(e2 <= tolerance * tolerance)) return false;
  *m = x;
  return true;
}

/// m whose distortion is target, and J = d(distorted)/d(m) there.
bool undistort_flat(const Camera& c, const Vec2& target, Vec2* m, Mat2* J) {
  switch (model_of(c)) {
    case CameraModel::kRadtan:
      return undistort_radtan(c, target, m, J);
    case CameraModel::kDivision: {
      const Scalar d2 = Vec2(c.fx * target.x(), c.fy * target.y()).squaredNorm();
      const Scalar rest = 1 - 2 * c.distortion[0] * d2;
      if (!(rest > 0)) return false;
      *m = target / std::sqrt(rest);
      break;
    }
    default:
      *m = target;
  }
  Vec2 again;
  return distort_flat(c, *m, &again, J);
}

}  // namespace

bool project(const Camera& c, const Vec3& p_C, Vec2* pixel, Mat23* J_pixel_p) {
  if (model_of(c) == CameraModel::kEquidistant) return project_equidistant(c, p_C, pixel, J_pixel_p);
  if (!(p_C.z() > kMinDepth && p_C.z() <= kMaxDepth)) return false;
  const Scalar w = 1 / p_C.z();
  const Vec2 m(p_C.x() * w, p_C.y() * w);
  Vec2 d;
  Mat2 J;
  if (!distort_flat(c, m, &d, J_pixel_p != nullptr ? &J : nullptr)) return false;
  const Vec2 z_px(c.fx * d.x() + c.cx, c.fy * d.y() + c.cy);
  if (!is_finite(z_px)) return false;
  *pixel = z_px;
  if (J_pixel_p != nullptr) {
    J.row(0) *= c.fx * w;
    J.row(1) *= c.fy * w;
    J_pixel_p->leftCols<2>() = J;
    J_pixel_p->col(2) = -(J * m);
  }
  return true;
}

bool unproject(const Camera& c, const Vec2& pixel, Vec3* ray_C, Mat32* J_ray_pixel) {
  const Vec2 target((pixel.x() - c.cx) / c.fx, (pixel.y() - c.cy) / c.fy);
  Vec3 ray;
  Mat32 J_ray_target;
  if (model_of(c) == CameraModel::kEquidistant) {
    if (!unproject_equidistant(c, target, &ray, J_ray_pixel != nullptr ? &J_ray_target : nullptr)) return false;
  } else {
    Vec2 m;
    Mat2 J;
    if (!undistort_flat(c, target, &m, &J)) return false;
    const Scalar n = 1 / std::sqrt(1 + m.squaredNorm());
    ray = Vec3(m.x() * n, m.y() * n, n);
    if (J_ray_pixel != nullptr) {
      // d ray/d m = n (I - ray rayᵀ) [I; 0]
      const Scalar det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
      Mat2 J_m_target;
      J_m_target << J(1, 1) / det, -J(0, 1) / det, -J(1, 0) / det, J(0, 0) / det;
      Mat32 J_ray_m = -n * ray * ray.head<2>().transpose();
      J_ray_m(0, 0) += n;
      J_ray_m(1, 1) += n;
      J_ray_target = J_ray_m * J_m_target;
    }
  }
  if (!(std::abs(ray.squaredNorm() - 1) < Scalar(1e-5))) return false;  // something overflowed
  *ray_C = ray;
  if (J_ray_pixel != nullptr) {
    J_ray_pixel->col(0) = J_ray_target.col(0) / c.fx;
    J_ray_pixel->col(1) = J_ray_target.col(1) / c.fy;
  }
  return true;
}

}  // namespace pf
