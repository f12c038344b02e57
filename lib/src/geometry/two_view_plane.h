#pragma once

#include "base/eigen.h"

namespace pf {

/// The plane of points that two cameras K and C see, whose poses are known. A ray r of K meets it in r / (m . r), m = n / d in K:
///
///   ray_C x (R r + t (m . r)) = 0   with R, t = T_CK of each ray             linear in m, least squares over all rays
///
/// R, t: of each ray, since rows are read out one after the other. False where there is too little parallax, or a point would be behind a
/// camera; *m untouched.
/// src  Servant 2008 (5), solved for n / d
bool two_view_plane(const Vec3* ray_K, const Vec3* ray_C, const Mat3* R_CK, const Vec3* t_CK, int count, Vec3* m);

}  // namespace pf
