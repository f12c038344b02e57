#include "track/image_rotation.h"

#include <cmath>

#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "track/tuning.h"

namespace pf {

using namespace tuning::image_rotation;

namespace {

constexpr int kUnknowns = 5;  // phi, gain, bias
using Unknowns = Eigen::Matrix<Scalar, kUnknowns, 1>;

/// Grey level between pixels and its slopes. False outside, and where one of them is masked.
bool sample(const Thumbnail& t, const ThumbnailMask& mask, const Vec2& p, Scalar* grey, Scalar* slope_x,
            Scalar* slope_y) {
  if (!(p.x() >= 0 && p.y() >= 0 && p.x() < Thumbnail::kWidth - 1 && p.y() < Thumbnail::kHeight - 1)) return false;
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  if (mask.has_masked && (mask.at(x, y) || mask.at(x + 1, y) || mask.at(x, y + 1) || mask.at(x + 1, y + 1)))
    return false;
  const Scalar u = p.x() - static_cast<Scalar>(x), v = p.y() - static_cast<Scalar>(y);
  const Scalar a = static_cast<Scalar>(t.at(x, y)), b = static_cast<Scalar>(t.at(x + 1, y));
  const Scalar c = static_cast<Scalar>(t.at(x, y + 1)), d = static_cast<Scalar>(t.at(x + 1, y + 1));
  *slope_x = (1 - v) * (b - a) + v * (d - c);
  *slope_y = (1 - u) * (c - a) + u * (d - b);
  *grey = a + u * (b - a) + v * (c - a) + u * v * (a - b - c + d);
  return true;
}

/// Sums over the pixels that both images show.
struct Sums {
  SmallCholesky<kUnknowns>::Matrix A = SmallCholesky<kUnknowns>::Matrix::Zero();  ///< lower triangle
  Unknowns b = Unknowns::Zero();
  int pixels = 0;
  double f = 0, g = 0, ff = 0, gg = 0, fg = 0;  ///< of the grey levels now and before

  float correlation() const {
    const double n = pixels, vf = n * ff - f * f, vg = n * gg - g * g;
    return vf > 0 && vg > 0 ? static_cast<float>((n * fg - f * g) / std::sqrt(vf * vg)) : 0.0f;
  }
};

/// Normal equations of  now(x) = gain before(w(x)) + bias + gain J phi,  J = slopes J_w_p (-[R ray]x).
bool linearise(const Camera& camera, const Thumbnail& before, const Thumbnail& now, const ThumbnailMask& mask,
               const Quat& q, Scalar gain, Scalar bias, Sums* sums) {
  const Scalar sx = static_cast<Scalar>(Thumbnail::kWidth) / static_cast<Scalar>(camera.width);
  const Scalar sy = static_cast<Scalar>(Thumbnail::kHeight) / static_cast<Scalar>(camera.height);
  for (int y = 0; y < Thumbnail::kHeight; ++y) {
    for (int x = 0; x < Thumbnail::kWidth; ++x) {
      if (mask.has_masked && mask.at(x, y)) continue;
      Vec3 ray;
      Vec2 pixel;
      Mat23 J_pixel_p;
      Scalar grey, slope_x, slope_y;
      const Vec2 centre = from_thumbnail(camera, Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y)));
      if (!unproject(camera, centre, &ray)) continue;
      ray = q * ray;
      if (!project(camera, ray, &pixel, &J_pixel_p)) continue;
      if (!sample(before, mask, to_thumbnail(camera, pixel), &grey, &slope_x, &slope_y)) continue;
      const Scalar mine = static_cast<Scalar>(now.at(x, y));
      // d(R ray) = phi x (R ray), so that  s . (phi x r) = (r x s) . phi.
      const Vec3 s = slope_x * sx * J_pixel_p.row(0).transpose() + slope_y * sy * J_pixel_p.row(1).transpose();
      const Vec3 turn = gain * ray.cross(s);
      const Scalar J[kUnknowns] = {turn.x(), turn.y(), turn.z(), grey, Scalar(1)};
      const Scalar residual = mine - gain * grey - bias;
      for (int i = 0; i < kUnknowns; ++i) {
        for (int j = 0; j <= i; ++j) sums->A(i, j) += J[i] * J[j];
        sums->b(i) += J[i] * residual;
      }
      ++sums->pixels;
      const double f = static_cast<double>(mine), g = static_cast<double>(grey);
      sums->f += f;
      sums->g += g;
      sums->ff += f * f;
      sums->gg += g * g;
      sums->fg += f * g;
    }
  }
  return sums->pixels >= kMinOverlap;
}

/// Where the second image lies over the first, to a pixel of the thumbnail.
float best_shift(const Thumbnail& now, const Thumbnail& before, const ThumbnailMask& mask, Vec2* shift) {
  float best = 0;
  int best_dx = 0, best_dy = 0;
  const auto compare = [&](int dx, int dy) {
    const float score = correlate(now, before, dx, dy, mask);
    if (score <= best) return;
    best = score;
    best_dx = dx;
    best_dy = dy;
  };
  for (int dy = -kReach; dy <= kReach; dy += 2)
    for (int dx = -kReach; dx <= kReach; dx += 2) compare(dx, dy);
  const int dx0 = best_dx, dy0 = best_dy;
  for (int dy = dy0 - 1; dy <= dy0 + 1; ++dy)
    for (int dx = dx0 - 1; dx <= dx0 + 1; ++dx) compare(dx, dy);
  *shift = Vec2(static_cast<Scalar>(best_dx), static_cast<Scalar>(best_dy));
  return best;
}

}  // namespace

Vec2 from_thumbnail(const Camera& camera, const Vec2& pixel) {
  const Scalar half = Scalar(0.5);
  return Vec2((pixel.x() + half) * static_cast<Scalar>(camera.width) / Thumbnail::kWidth - half,
              (pixel.y() + half) * static_cast<Scalar>(camera.height) / Thumbnail::kHeight - half);
}

Vec2 to_thumbnail(const Camera& camera, const Vec2& pixel) {
  const Scalar half = Scalar(0.5);
  return Vec2((pixel.x() + half) * Thumbnail::kWidth / static_cast<Scalar>(camera.width) - half,
              (pixel.y() + half) * Thumbnail::kHeight / static_cast<Scalar>(camera.height) - half);
}

Quat shortest_rotation(const Vec3& a, const Vec3& b) {
  const Vec3 axis = a.cross(b);
  Quat q(Scalar(1) + a.dot(b), axis.x(), axis.y(), axis.z());
  q.normalize();
  return q;
}

Quat rotation_of_shift(const Camera& camera, const Vec2& shift) {
  const Vec2 centre(static_cast<Scalar>(camera.width) / 2, static_cast<Scalar>(camera.height) / 2);
  const Vec2 moved(shift.x() * static_cast<Scalar>(camera.width) / Thumbnail::kWidth,
                   shift.y() * static_cast<Scalar>(camera.height) / Thumbnail::kHeight);
  Vec3 then_C, now_C;
  if (!unproject(camera, centre - moved / 2, &then_C) || !unproject(camera, centre + moved / 2, &now_C))
    return Quat::Identity();
  return shortest_rotation(now_C, then_C);
}

bool find_rotation(const Camera& camera, const Thumbnail& before, const Thumbnail& now, const ThumbnailMask& mask,
                   Quat* q_before_now) {
  Vec2 shift;
  if (best_shift(now, before, mask, &shift) < kMinShiftScore) return false;
  Quat q = rotation_of_shift(camera, shift);
  Scalar gain = 1, bias = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    Sums sums;
    if (!linearise(camera, before, now, mask, q, gain, bias, &sums)) return false;
    SmallCholesky<kUnknowns> cholesky;
    if (!cholesky.factor(sums.A)) return false;
    const Unknowns step = cholesky.solve<1>(sums.b);
    const Vec3 phi = step.head<3>();
    if (!(phi.norm() < kMaxTurn)) return false;
    q = (exp_so3(phi) * q).normalized();
    gain += step(3);
    bias += step(4);
    if (phi.norm() < kSmallTurn) break;
  }
  Sums last;
  if (!linearise(camera, before, now, mask, q, gain, bias, &last) || last.correlation() < kMinOverlapScore)
    return false;
  *q_before_now = q;
  return true;
}

}  // namespace pf
