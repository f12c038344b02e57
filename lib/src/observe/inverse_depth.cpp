#include "observe/inverse_depth.h"

#include <cmath>

#include "geometry/so3.h"
#include "model/tuning.h"

namespace pf {

bool observe_inverse_depth(const Camera& lens, const CameraAt& camera, const Vec3& o_W, const InverseDepth& feature,
                           Vec2* z, Mat26* J_z_camera, Mat23* J_z_anchor, Mat23* J_z_feature) {
  const Mat3 R_CW = camera.q_WC.toRotationMatrix().transpose();
  const Mat3 R_b = feature.q_b.toRotationMatrix();
  const Vec3 baseline = o_W - camera.p_W;
  const Vec3 d_W = feature.rho * baseline + R_b.col(2);
  Mat23 J_z_C;
  if (!project(lens, R_CW.lazyProduct(d_W), z, &J_z_C)) return false;
  const Mat23 J_z_W = J_z_C.lazyProduct(R_CW);
  J_z_camera->leftCols<3>() = J_z_W.lazyProduct(hat(d_W));
  J_z_camera->rightCols<3>() = -feature.rho * J_z_W;
  *J_z_anchor = feature.rho * J_z_W;
  J_z_feature->leftCols<2>() = J_z_W.lazyProduct(R_b.leftCols<2>());
  J_z_feature->col(2) = J_z_W.lazyProduct(baseline);
  return true;
}

Vec3 inverse_depth_to_point(const Vec3& o_W, const InverseDepth& feature, Mat3* J_f_feature) {
  const Mat3 R_b = feature.q_b.toRotationMatrix();
  const Scalar depth = Scalar(1) / feature.rho;
  J_f_feature->leftCols<2>() = depth * R_b.leftCols<2>();
  J_f_feature->col(2) = -depth * depth * R_b.col(2);
  return o_W + depth * R_b.col(2);
}

Vec3 shown_place(const Vec3& o_W, const InverseDepth& feature, const Mat6& cov, Mat3* C) {
  InverseDepth shown = feature;
  shown.rho = feature.rho > tuning::inverse_depth::kMinShownRho ? feature.rho : tuning::inverse_depth::kMinShownRho;
  Mat3 J_feature;
  const Vec3 f_W = inverse_depth_to_point(o_W, shown, &J_feature);
  Eigen::Matrix<Scalar, 3, 6> J;
  J.leftCols<3>().setIdentity();
  J.rightCols<3>() = J_feature;
  const Eigen::Matrix<Scalar, 3, 6> J_cov = J.lazyProduct(cov);
  const Vec3 moved = (shown.rho - feature.rho) * J_feature.col(2);
  *C = J_cov.lazyProduct(J.transpose());
  *C += moved * moved.transpose();
  return f_W;
}

Scalar linearity_index(const Vec3& c_W, const Vec3& o_W, const InverseDepth& feature, Scalar sigma_rho) {
  using namespace tuning::inverse_depth;
  constexpr Scalar kMinDistance = Scalar(1e-9);  // [m]
  if (feature.rho <= Scalar(2) * sigma_rho || feature.rho <= kMinRho) return kNever;
  const Vec3 b = feature.q_b.toRotationMatrix().col(2);
  const Vec3 ray = o_W + b / feature.rho - c_W;
  const Scalar d1 = ray.norm();
  if (d1 <= kMinDistance) return kNever;
  const Scalar cosine = b.dot(ray) / d1;
  return Scalar(4) * sigma_rho / (feature.rho * feature.rho) * std::abs(cosine) / d1;
}

InverseDepth begin_inverse_depth(const CameraAt& camera, const Vec3& ray_C, const Mat32& J_ray_z, Scalar rho,
                                 const Vec3& c_W, Mat23* J_feature_theta, Mat2* J_feature_z, Mat23* J_feature_c) {
  const Mat3 R = camera.q_WC.toRotationMatrix();
  const Vec3 seen = R.lazyProduct(ray_C);
  const Vec3 from_anchor = seen + rho * c_W;
  const Scalar length = from_anchor.norm();
  InverseDepth feature;
  feature.q_b = turn_z_to(from_anchor / length);
  feature.rho = rho;
  const Mat23 Bt = feature.q_b.toRotationMatrix().leftCols<2>().transpose() / length;
  *J_feature_theta = -Bt.lazyProduct(hat(seen));
  const Mat32 RJ = R.lazyProduct(J_ray_z);
  *J_feature_z = Bt.lazyProduct(RJ);
  *J_feature_c = rho * Bt;
  return feature;
}

}  // namespace pf
