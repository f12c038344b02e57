#pragma once

#include "base/scalar.h"

/// Tuned numbers of the map, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning::plane_search {

inline constexpr int kKept = 4;           ///< hypotheses that are refitted
inline constexpr int kSurroundings = 20;  ///< chance is judged against a layer this many times as thick
inline constexpr Scalar kContrast = 5;    ///< density of a plane against either layer beside it, at least
inline constexpr Scalar kLogFalsePlanes = Scalar(-4.6);       ///< ln of the planes that chance may give: ln 0.01
inline constexpr Scalar kLogFalseLocalPlanes = Scalar(-7.6);  ///< likewise among the points near by: ln 0.0005
inline constexpr int kBalls = 4;                              ///< sizes of the neighbourhood, each twice the last
inline constexpr Scalar kSmallestBall = 10;                   ///< radius of the first, in plane.max_distance
inline constexpr Scalar kMinWidth = 3;               ///< narrow side of the points' spread, in plane.max_distance
inline constexpr Scalar kMinAspect = Scalar(0.02);   ///< of the points' spread, middle to largest eigenvalue
inline constexpr Scalar kMinHeight = Scalar(0.15);   ///< of a triangle of points over its longest side
inline constexpr Scalar kSameNormal = Scalar(0.98);  ///< cosine between hypotheses of one plane

}  // namespace pf::tuning::plane_search

/// The plane of most points, and those that are off it.
namespace pf::tuning::plane_majority {

inline constexpr int kTrials = 100;  ///< sets of three that are drawn; those of badly known points are passed over
inline constexpr int kRounds = 3;    ///< of fitting
inline constexpr Scalar kNear = 3;   ///< standard deviations of a point that takes part in the fit
inline constexpr Scalar kOff = 4;    ///< likewise, of one that is off
inline constexpr Scalar kSameSide = Scalar(0.9);  ///< cosine between the plane and the one that is judged

inline constexpr int kPerOff = 3;  ///< points that are judged, of which one may be off the plane
}  // namespace pf::tuning::plane_majority
