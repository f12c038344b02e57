#include "map/plane_majority.h"

#include <algorithm>
#include <cmath>

#include "base/random_triples.h"
#include "geometry/small_cholesky.h"
#include "geometry/symmetric_eigen.h"
#include "map/tuning.h"

namespace pf {
namespace {

using namespace tuning::plane_majority;

constexpr Scalar kMedianChi2 = Scalar(0.455);  ///< of one degree of freedom
constexpr Scalar kSmallSample =
    5;  ///< the least of many medians is too small, as a sigma, by 1 + 5 / (n - 3) (Rousseeuw, Leroy 1987)

Scalar median_of(Scalar* values, int count) {
  std::nth_element(values, values + count / 2, values + count);
  return values[count / 2];
}

/// Least median of squares. median: of r_i^2 / variance_i.
bool find_hypothesis(const JudgedPoint* points, int count, const Vec3& n_W, std::uint32_t seed, MajorityPlane* plane,
                     Scalar* median) {
  Scalar value[kMaxJudged];
  for (int i = 0; i < count; ++i) value[i] = points[i].variance;
  const Scalar better = median_of(value, count);
  RandomTriples triples(count, seed);
  *median = -1;
  for (int k = 0; k < kTrials; ++k) {
    int t[3];
    triples.draw(t);
    if (points[t[0]].variance > better || points[t[1]].variance > better || points[t[2]].variance > better) continue;
    const Vec3& o = points[t[0]].p_W;
    const Vec3 cross = (points[t[1]].p_W - o).cross(points[t[2]].p_W - o);
    const Scalar length = cross.norm();
    if (!(length > 0) || std::abs(cross.dot(n_W)) < kSameSide * length) continue;
    const Vec3 n = cross / length;
    int beyond = 0;  // so many that the median is no smaller than the least one
    for (int i = 0; i < count && beyond < count - count / 2; ++i) {
      const Scalar r = n.dot(points[i].p_W - o);
      value[i] = r * r / points[i].variance;
      beyond += *median >= 0 && value[i] >= *median ? 1 : 0;
    }
    if (beyond >= count - count / 2) continue;
    *median = median_of(value, count);
    plane->n_W = n;
    plane->c_W = o;
  }
  return *median >= 0;
}

/// Fits the plane to the points within kNear of it, sigma2 their variances. The sum of their squares: chi2.
bool refit(const JudgedPoint* points, const Scalar* sigma2, int count, MajorityPlane* plane, Scalar* chi2) {
  const auto is_near = [&](int i) {
    const Scalar r = plane->n_W.dot(points[i].p_W - plane->c_W);
    return r * r < kNear * kNear * sigma2[i];
  };
  Vec3 c = Vec3::Zero();
  Scalar weight = 0;
  int members = 0;
  for (int i = 0; i < count; ++i) {
    if (!is_near(i)) continue;
    c += points[i].p_W / sigma2[i];
    weight += 1 / sigma2[i];
    ++members;
  }
  if (members < 4) return false;
  c /= weight;
  Mat3 C = Mat3::Zero();
  for (int i = 0; i < count; ++i)
    if (is_near(i)) C += (points[i].p_W - c) * (points[i].p_W - c).transpose() / sigma2[i];
  Vec3 lambda;
  Mat3 V;
  symmetric_eigen(C, &lambda, &V);
  if (!(lambda(1) > 0)) return false;
  *chi2 = lambda(0);
  plane->n_W = V.col(0).dot(plane->n_W) < 0 ? Vec3(-V.col(0)) : Vec3(V.col(0));
  plane->c_W = c;
  for (int k = 0; k < 2; ++k) plane->e_W[k] = V.col(1 + k);
  plane->variance = Vec3(1 / weight, 1 / lambda(1), 1 / lambda(2));
  plane->members = members;
  return true;
}

/// What a fit to members and points that are off gives, as an error of the plane.
Vec3 bent_by_all(const JudgedPoint* points, const Scalar* sigma2, int count, const MajorityPlane& plane) {
  Mat3 N = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  for (int i = 0; i < count; ++i) {
    const Vec3 p = points[i].p_W - plane.c_W;
    const Scalar r = plane.n_W.dot(p);
    if (!points[i].is_off && !(r * r < kNear * kNear * sigma2[i])) continue;
    const Vec3 u(1, plane.e_W[0].dot(p), plane.e_W[1].dot(p));
    N += u * u.transpose() / sigma2[i];
    b += u * (r / sigma2[i]);
  }
  SmallCholesky<3> factored;
  return factored.factor(N) ? factored.solve<1>(b) : Vec3(Vec3::Zero());
}

}  // namespace

bool find_majority(JudgedPoint* points, int count, const Vec3& n_W, const MajoritySettings& settings,
                   std::uint32_t seed, MajorityPlane* plane) {
  if (count <= settings.min_points || count > kMaxJudged) return false;
  MajorityPlane found;
  Scalar median;
  if (!find_hypothesis(points, count, n_W, seed, &found, &median)) return false;
  const Scalar few = Scalar(1) + kSmallSample / static_cast<Scalar>(count - 3);
  Scalar factor = few * few * median / kMedianChi2, chi2 = 0;
  const Scalar known = settings.distance * settings.distance / 4;
  Scalar sigma2[kMaxJudged];
  if (found.n_W.dot(n_W) < 0) found.n_W = -found.n_W;
  for (int round = 0; round < kRounds; ++round) {
    factor = std::max(settings.least_factor, factor);
    int sure = 0;
    for (int i = 0; i < count; ++i) {
      sigma2[i] = factor * points[i].variance + settings.roughness * settings.roughness;
      sure += sigma2[i] < known ? 1 : 0;
    }
    if (sure <= settings.min_points) return false;
    if (!refit(points, sigma2, count, &found, &chi2)) return false;
    if (round + 1 < kRounds) factor *= std::min(Scalar(1), chi2 / static_cast<Scalar>(std::max(1, found.members - 3)));
  }
  if (kPerOff * (count - found.members) > count) return false;
  const Scalar scale = std::max(Scalar(1), chi2 / static_cast<Scalar>(std::max(1, found.members - 3)));
  found.variance *= scale;
  for (int i = 0; i < count; ++i) {
    const Vec3 r = points[i].p_W - found.c_W;
    const Scalar u1 = found.e_W[0].dot(r), u2 = found.e_W[1].dot(r), height = found.n_W.dot(r);
    const Scalar variance = scale * sigma2[i] + found.variance.dot(Vec3(1, u1 * u1, u2 * u2));
    points[i].is_off = variance < known && height * height > kOff * kOff * variance;
    found.off += points[i].is_off ? 1 : 0;
  }
  found.bent = bent_by_all(points, sigma2, count, found);
  *plane = found;
  return true;
}

}  // namespace pf
