#pragma once

#include "plane.h"
#include "plane_fit.h"
#include "sim/random.h"

namespace pfsim::gee {

/// Thresholds of section 3.3, in metres.
struct DiscoveryOptions {
  double sigma_T = 0.02;            ///< a point's largest standard deviation
  double d_T = 0.005;               ///< distance from the plane
  double d_max = 2;                 ///< distance from the plane's origin
  int l_T = 7;                      ///< more points than these
  double lambda_T = 0.005 * 0.005;  ///< smallest eigenvalue of M^T M [m^2]
  int hypotheses = 50;              ///< of each frame
};

/// RANSAC over points, then principal components.   src Gee 2007, section 3.3
class Discovery {
 public:
  Discovery(const DiscoveryOptions& options, std::uint64_t seed) : options_(options), random_(seed, 23) {}

  /// The best plane among the points and which of them carry it; false when none is good enough.
  bool find(const std::vector<Vec3>& points, PlaneFit* fit, std::vector<std::size_t>* inliers);

 private:
  DiscoveryOptions options_;
  pf::sim::Random random_;
};

}  // namespace pfsim::gee
