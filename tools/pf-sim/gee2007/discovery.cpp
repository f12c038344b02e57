#include "discovery.h"

namespace pfsim::gee {

bool Discovery::find(const std::vector<Vec3>& points, PlaneFit* fit, std::vector<std::size_t>* inliers) {
  const int count = static_cast<int>(points.size());
  if (count <= options_.l_T) return false;
  std::vector<std::size_t> best, support;
  for (int h = 0; h < options_.hypotheses; ++h) {
    const int i = random_.below(count), j = random_.below(count), k = random_.below(count);
    if (i == j || j == k || k == i) continue;
    // Eq. 7: origin and basis from three points; only the normal of the basis is needed to count support.
    const Vec3& origin = points[static_cast<std::size_t>(i)];
    const Vec3 across =
        (points[static_cast<std::size_t>(j)] - origin).cross(points[static_cast<std::size_t>(k)] - origin);
    if (!(across.norm() > 1e-6)) continue;
    const Vec3 normal = across.normalized();
    support.clear();
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Vec3 way = points[p] - origin;
      if (std::abs(way.dot(normal)) < options_.d_T && way.norm() < options_.d_max) support.push_back(p);
    }
    if (support.size() > best.size()) best = support;
  }
  if (static_cast<int>(best.size()) <= options_.l_T) return false;
  std::vector<Vec3> chosen;
  for (const std::size_t p : best) chosen.push_back(points[p]);
  if (!fit_plane(chosen, fit) || !(fit->lambda[0] < options_.lambda_T)) return false;
  *inliers = best;
  return true;
}

}  // namespace pfsim::gee
