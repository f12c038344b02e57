#pragma once

#include "base/eigen.h"

namespace pf {

/// H with  to_i = s_i H from_i,  s_i > 0,  i = 0 .. 3.
///
/// Points are homogeneous: (x, y, 1) of a plane, or rays of a camera with any field of view, whose side counts. H has
/// unit Frobenius norm. Through the projective bases of both sides: from_3 = Σ a_i from_i, to_3 = Σ b_i to_i, and
/// H = [to_i b_i / a_i] [from_i]⁻¹, with no system larger than 3x3.
/// False when three points of one side are in line, or when no H keeps every point on its side; H untouched.
/// src  Hartley and Zisserman 2004, section 4.1
bool homography_from_4(const Vec3 from[4], const Vec3 to[4], Mat3* H);

}  // namespace pf
