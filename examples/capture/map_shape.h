#ifndef PLANEFOLD_CAPTURE_MAP_SHAPE_H
#define PLANEFOLD_CAPTURE_MAP_SHAPE_H

#include <planefold/planefold.h>

#include <vector>

namespace pf::capture {

/// How well each feature is known within the map: its largest sigma without what all of the map shares, which is where it lies, how
/// it is turned, and its scale. A bare camera knows none of these; the covariance in W holds them all.
///
///   P_i - N_i G N_iᵀ,   G = (Nᵀ P⁻¹ N)⁻¹,   N_i = [I  -[x]x  x]        never below 0: G is the most that can be taken out
///
/// features  as they are in slam now
/// empty when the filter cannot say: it has no pose
/// src       lib/docs/theory/gauge.md
std::vector<double> sigmas_in_map(const pf_slam_t* slam, const std::vector<pf_feature_t>& features);

}  // namespace pf::capture

#endif
