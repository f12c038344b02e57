#pragma once

#include "filter/filter.h"

namespace pf {

/// Finds the largest set of matches that are consistent with one of them (one-point RANSAC; Civera, Grasa, Davison, Montiel 2010). Not
/// random: every match is tried as the hypothesis, since with the joint S = H P H^T + R a trial needs 2x2 blocks only.
///
///   after match i:   r_j|i = r_j - S_ji S_ii^-1 r_i,   S_j|i = S_jj - S_ji S_ii^-1 S_ij;   j is an inlier if r^T S_j|i^-1 r < gate
///
/// begin_update must hold the same observations. keep gets 1 for the inliers of the best hypothesis. Returns how many.
int find_inliers(const Filter& filter, const PixelMeasurement* observations, int count, Scalar gate,
                 unsigned char* keep);

/// r^T S^-1 r of one observation with covariance S [px^2]; huge where S is not positive.
Scalar squared_distance(const Vec2& r, const Mat2& S);

/// Whether an innovation covariance S = H P H^T + R is one: finite and positive definite. It is not where H P H^T is a difference of
/// numbers so large that rounding exceeds R: a position far from the map's origin with a variance of 1e6 and a point close to the camera,
/// which shares nearly all of it. Such a pixel cannot be measured.
bool is_covariance(const Mat2& S);

}  // namespace pf
