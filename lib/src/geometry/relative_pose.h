#pragma once

#include "geometry/so3.h"

namespace pf {

/// Pose of a camera C in the frame of another camera K, and its Jacobians (lib/docs/theory/relative_motion.md).
///
///   R_KC = R_WK^T R_WC,   p_KC = R_WK^T (p_WC - p_WK)
///   error (theta, p) in K:   R_true = Exp(theta) R_KC,   p_true = p_KC + e_p
///   theta_KC = R_WK^T (theta_C - theta_K),   e_KC = R_WK^T (e_C - e_K + [p_WC - p_WK]x theta_K)
///
/// J_C, J_K 6x6 by (theta, p) of each camera in W.
struct RelativePose {
  Quat q_KC;
  Vec3 p_KC;
  Mat6 J_C, J_K;
};

inline RelativePose relative_pose(const Quat& q_WK, const Vec3& p_WK, const Quat& q_WC, const Vec3& p_WC) {
  RelativePose out;
  const Mat3 R_KW = q_WK.toRotationMatrix().transpose();
  const Vec3 d_W = p_WC - p_WK;
  out.q_KC = q_WK.conjugate() * q_WC;
  out.q_KC.normalize();
  out.p_KC = R_KW * d_W;
  out.J_C.setZero();
  out.J_C.topLeftCorner<3, 3>() = R_KW;
  out.J_C.bottomRightCorner<3, 3>() = R_KW;
  out.J_K = -out.J_C;
  out.J_K.bottomLeftCorner<3, 3>() = R_KW.lazyProduct(hat(d_W));
  return out;
}

}  // namespace pf
