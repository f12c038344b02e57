#include "geometry/p3p.h"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

using Vec3d = Eigen::Matrix<double, 3, 1>;
using Mat3d = Eigen::Matrix<double, 3, 3>;

constexpr double kMinSine = 1e-5;       // of the angle between two rays, and between two sides of the triangle
constexpr double kAlmostReal = 1e-5;    // imaginary part of a double root, relative: what rounding makes of it
constexpr double kMaxResidual = 1e-9;   // of a distance equation, relative
constexpr double kSameSolution = 1e-6;  // of distances, relative
constexpr int kNewtonRounds = 6;

/// The cube root, up to rounding that Newton's steps take away.
double cube_root(double x) { return x == 0 ? 0 : std::copysign(std::exp(std::log(std::abs(x)) / 3), x); }

/// The largest real root of x³ + b x² + c x + d (Cardano; trigonometric where there are three).
double largest_cubic_root(double b, double c, double d) {
  const double p = c - b * b / 3, q = 2 * b * b * b / 27 - b * c / 3 + d;
  const double D = q * q / 4 + p * p * p / 27;
  double t;
  if (D >= 0) {
    const double s = std::sqrt(D);
    const double A = cube_root(q < 0 ? -q / 2 + s : -q / 2 - s);
    t = A == 0 ? 0 : A - p / (3 * A);
  } else {
    const double r = std::sqrt(-p / 3);
    t = 2 * r * std::cos(std::acos(std::clamp(-q / (2 * r * r * r), -1.0, 1.0)) / 3);
  }
  double x = t - b / 3;
  for (int i = 0; i < 2; ++i) {  // rounding of the closed form
    const double slope = (3 * x + 2 * b) * x + c;
    if (slope != 0) x -= (((x + b) * x + c) * x + d) / slope;
  }
  return x;
}

/// Adds the real roots of x² + b x + c; a pair that is complex by rounding alone counts as its real part.
int add_quadratic_roots(double b, double c, double* roots) {
  const double D = b * b / 4 - c;
  if (D < -kAlmostReal * (b * b / 4 + std::abs(c))) return 0;
  const double s = std::sqrt(std::max(D, 0.0));
  roots[0] = -b / 2 - s;
  roots[1] = -b / 2 + s;
  return 2;
}

/// Real roots of a[4] x⁴ + .. + a[0], a[4] not 0 (Ferrari). Returns how many, at most four.
int quartic_roots(const double a[5], double* roots) {
  const double b = a[3] / a[4], c = a[2] / a[4], d = a[1] / a[4], e = a[0] / a[4];
  const double shift = b / 4, b2 = b * b;
  const double p = c - 3 * b2 / 8;
  const double q = d - b * c / 2 + b2 * b / 8;
  const double r = e - b * d / 4 + b2 * c / 16 - 3 * b2 * b2 / 256;
  // y⁴ + p y² + q y + r = (y² + m y + n)(y² - m y + l),  m² the largest root of z³ + 2 p z² + (p² - 4 r) z - q²
  const double z = largest_cubic_root(2 * p, p * p - 4 * r, -q * q);
  int count = 0;
  const double size = std::abs(p) + std::sqrt(std::abs(r));
  if (z > 1e-12 * size) {
    const double m = std::sqrt(z);
    count += add_quadratic_roots(m, (p + z - q / m) / 2, roots);
    count += add_quadratic_roots(-m, (p + z + q / m) / 2, roots + count);
  } else {  // y⁴ + p y² + r
    double square[2];
    const int squares = add_quadratic_roots(p, r, square);
    for (int i = 0; i < squares; ++i) {
      if (square[i] < -1e-12 * size) continue;
      const double y = std::sqrt(std::max(square[i], 0.0));
      roots[count++] = y;
      roots[count++] = -y;
    }
  }
  for (int i = 0; i < count; ++i) roots[i] -= shift;
  return count;
}

/// The triangle's squared sides and the cosines between rays, each opposite to its point: 0 of (1, 2), 1 of (0, 2), 2 of (0, 1).
struct RayTriangle {
  double side2[3], cosine[3];
};

/// Coefficients of the polynomial in v = s_2 / s_0 (points counted from 0), the constant one first.
void grunert(const RayTriangle& t, double A[5]) {
  const double a = t.side2[0] / t.side2[1], c = t.side2[2] / t.side2[1];
  const double k = a - c, ca = t.cosine[0], cb = t.cosine[1], cg = t.cosine[2];
  A[4] = (k - 1) * (k - 1) - 4 * c * ca * ca;
  A[3] = 4 * (k * (1 - k) * cb - (1 - (a + c)) * ca * cg + 2 * c * ca * ca * cb);
  A[2] = 2 *
         (k * k - 1 + 2 * k * k * cb * cb + 2 * (1 - c) * ca * ca - 4 * (a + c) * ca * cb * cg + 2 * (1 - a) * cg * cg);
  A[1] = 4 * (-k * (1 + k) * cb + 2 * a * cg * cg * cb - (1 - (a + c)) * ca * cg);
  A[0] = (1 + k) * (1 + k) - 4 * a * cg * cg;
}

/// Newton's method on the three equations. False where it does not end at a solution in front of the camera.
bool refine_distances(const RayTriangle& t, Vec3d* s) {
  const double largest = std::max({t.side2[0], t.side2[1], t.side2[2]});
  for (int round = 0;; ++round) {
    Vec3d r;
    Mat3d J = Mat3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const double si = (*s)(i), sj = (*s)(j);
      r(k) = t.side2[k] - (si * si + sj * sj - 2 * si * sj * t.cosine[k]);
      J(k, i) = 2 * (si - sj * t.cosine[k]);
      J(k, j) = 2 * (sj - si * t.cosine[k]);
    }
    if (round == kNewtonRounds) return r.cwiseAbs().maxCoeff() < kMaxResidual * largest && s->minCoeff() > 0;
    const Vec3d a = J.row(0), b = J.row(1), c = J.row(2);
    const double determinant = a.dot(b.cross(c));
    // At a double solution J is singular: the step is one of many, and what is there is as good as it gets.
    if (!(std::abs(determinant) > 1e-14 * J.cwiseAbs().maxCoeff() * J.cwiseAbs().maxCoeff() * J.cwiseAbs().maxCoeff()))
      return r.cwiseAbs().maxCoeff() < kMaxResidual * largest && s->minCoeff() > 0;
    *s += (r(0) * b.cross(c) + r(1) * c.cross(a) + r(2) * a.cross(b)) / determinant;
  }
}

/// Axes of a triangle: along its first side, in its plane, across it.
Mat3d axes_of(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Mat3d R;
  R.col(0) = (b - a).normalized();
  R.col(2) = (b - a).cross(c - a).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

}  // namespace

int solve_p3p(const Vec3 points_W[3], const Vec3 rays_C[3], CameraPose* poses) {
  Vec3d X[3], f[3];
  RayTriangle t;
  for (int i = 0; i < 3; ++i) {
    X[i] = points_W[i].cast<double>();
    f[i] = rays_C[i].cast<double>().normalized();
  }
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    t.side2[k] = (X[i] - X[j]).squaredNorm();
    t.cosine[k] = f[i].dot(f[j]);
    if (!(f[i].cross(f[j]).norm() > kMinSine)) return 0;
  }
  const double area2 = (X[1] - X[0]).cross(X[2] - X[0]).norm();
  const double largest = std::max({t.side2[0], t.side2[1], t.side2[2]});
  if (!(area2 > kMinSine * largest) || !(largest < 1e100)) return 0;

  // Of x⁴ and 1, the larger coefficient leads: roots of the reversed polynomial are 1 / v.
  double A[5], roots[4];
  grunert(t, A);
  const bool reversed = std::abs(A[0]) > std::abs(A[4]);
  if (reversed) std::reverse(A, A + 5);
  if (A[4] == 0) return 0;
  const int count = quartic_roots(A, roots);
  Vec3d found[kMaxP3pSolutions];
  int solutions = 0;
  for (int k = 0; k < count; ++k) {
    const double v = reversed ? 1 / roots[k] : roots[k];
    if (!(v > 0) || !(v < 1e10)) continue;
    const double s0 = std::sqrt(t.side2[1] / (1 + v * v - 2 * v * t.cosine[1]));
    // u² - 2 u cosine[2] + 1 = side2[2] / s0²; the third equation decides between its roots.
    double u[2];
    const int two = add_quadratic_roots(-2 * t.cosine[2], 1 - t.side2[2] / (s0 * s0), u);
    for (int i = 0; i < two; ++i) {
      Vec3d s(s0, u[i] * s0, v * s0);
      if (solutions == kMaxP3pSolutions || !refine_distances(t, &s)) continue;
      bool is_new = true;
      for (int j = 0; j < solutions; ++j) is_new = is_new && (s - found[j]).norm() > kSameSolution * s.norm();
      if (is_new) found[solutions++] = s;
    }
  }
  for (int k = 0; k < solutions; ++k) {
    const Vec3d Y[3] = {found[k](0) * f[0], found[k](1) * f[1], found[k](2) * f[2]};
    const Mat3d axes_W = axes_of(X[0], X[1], X[2]), axes_C = axes_of(Y[0], Y[1], Y[2]);
    const Mat3d R_WC = axes_W.lazyProduct(axes_C.transpose());
    const Vec3d p_WC = (X[0] + X[1] + X[2] - R_WC.lazyProduct(Y[0] + Y[1] + Y[2])) / 3;
    poses[k].q_WC = Quat(Mat3(R_WC.cast<Scalar>()));
    poses[k].q_WC.normalize();
    poses[k].p_WC = p_WC.cast<Scalar>();
  }
  return solutions;
}

}  // namespace pf
