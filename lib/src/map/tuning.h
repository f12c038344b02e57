#pragma once

#include "base/scalar.h"

/// Tuned numbers of the map, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning::plane_search {

inline constexpr int kKept = 4;           ///< hypotheses that are refitted
inline constexpr int kSurroundings = 20;  ///< chance is judged against a layer this many times as thick
inline constexpr Scalar kContrast = 5;    ///< density of a plane against either layer beside it, at least
inline constexpr Scalar kLogFalsePlanes = Scalar(-4.6);       ///< ln of the planes that chance may give: ln 0.01
inline constexpr Scalar kLogFalseLocalPlanes = Scalar(-7.6);  ///< the same among the points near by: ln 0.0005
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
inline constexpr Scalar kOff = 4;    ///< the same, of one that is off
inline constexpr Scalar kSameSide = Scalar(0.9);  ///< cosine between the plane and the one that is judged

inline constexpr int kPerOff = 3;  ///< points that are judged, of which one may be off the plane
}  // namespace pf::tuning::plane_majority

namespace pf::tuning {

/// Walls whose place is judged by what is seen.
namespace plane_doubt {
inline constexpr Scalar kRefusedGate = Scalar(16);  ///< chi-square of a point that does not lie on a wall
inline constexpr int kMinRefused = 8;               ///< points, before a wall is rejected or accepted again
inline constexpr int kRefusedShare = 4;       ///< rejected points for each on the wall, above which it is rejected
static constexpr int kCells = 5;              ///< along each side of the image
inline constexpr Scalar kDoubtedPrior = 100;  ///< times its covariance that a rejected wall's prior gets
}  // namespace plane_doubt

/// Points before a wall that is hardly known.
namespace plane_walls {
inline constexpr Scalar kOffWall = Scalar(0.5);       ///< sigma of a new point relative to the depth of its wall
inline constexpr int kTrials = 60;                    ///< triples of points
inline constexpr Scalar kTripleGate = Scalar(11.34);  ///< chi-square of three degrees of freedom, 0.99
inline constexpr int kMinOnWall = 2;                  ///< one in so many points before a wall lies on it
}  // namespace plane_walls

/// A map whose unit of length the walls give.
namespace start_before_walls {
inline constexpr Scalar kOneWall = Scalar(1.12);  ///< ratio of distances of points that lie on walls of the plan
inline constexpr int kMinOnWall = 8;              ///< points that give the unit of length
inline constexpr int kClearMajority = 2;          ///< of these to the points that give another one
inline constexpr int kMaxRatios = 256;            ///< that are compared
}  // namespace start_before_walls

}  // namespace pf::tuning
