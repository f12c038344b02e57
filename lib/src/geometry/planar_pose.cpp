#include "geometry/planar_pose.h"

#include <cmath>
#include <limits>

#include "geometry/homography.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {
namespace {

constexpr int kRefineRounds = 50;
constexpr Scalar kMaxScalar = std::numeric_limits<Scalar>::max();

/// Rotation nearest to [a b a x b]: both directions are rotated by the same angle until they are perpendicular.
/// False when they are almost parallel.
bool rotation_from_two(const Vec3& a, const Vec3& b, Mat3* R) {
  const Vec3 z = a.cross(b);
  if (!(z.norm() > Scalar(1e-3))) return false;
  const Vec3 sum = (a + b).normalized(), difference = (a - b).normalized();
  const Scalar h = std::sqrt(Scalar(0.5));
  R->col(0) = h * (sum + difference);
  R->col(1) = h * (sum - difference);
  R->col(2) = z.normalized();
  return true;
}

/// R_CW and t_CW of a plane z = 0 from H = s [r1 r2 t], s > 0.
bool decompose(const Mat3& H, Mat3* R_CW, Vec3* t_CW) {
  const Vec3 h1 = H.col(0), h2 = H.col(1);
  const Scalar n1 = h1.norm(), n2 = h2.norm();
  if (!(n1 > 0) || !(n2 > 0) || !rotation_from_two(h1 / n1, h2 / n2, R_CW)) return false;
  *t_CW = H.col(2) / std::sqrt(n1 * n2);
  return true;
}

/// The second solution: the plane's points mirrored at the line of sight to the origin.
Mat3 mirrored(const Mat3& R_CW, const Vec3& t_CW) {
  const Vec3 d = t_CW.normalized();
  Mat3 M = R_CW - 2 * d * (d.transpose() * R_CW).eval();
  M.col(2) = -M.col(2).eval();
  return M;
}

PoseEstimate pose_of(const Mat3& R_CW, const Vec3& t_CW) {
  PoseEstimate pose;
  pose.q_WC = Quat(Mat3(R_CW.transpose()));
  pose.q_WC.normalize();
  pose.p_WC = -(R_CW.transpose() * t_CW);
  return pose;
}

/// An error about the pivot as one about the camera: e = e_pivot + θ x (p - pivot).
Mat6 to_camera(const Vec3& arm) {
  Mat6 T = Mat6::Identity();
  T.block<3, 3>(3, 0) = -hat(arm);
  return T;
}

/// Whether both estimates are the same pose to working precision.
bool is_same(const PoseEstimate& a, const PoseEstimate& b) {
  const Scalar distance = a.p_WC.norm();
  return (a.p_WC - b.p_WC).norm() < Scalar(1e-3) * distance &&
         log_so3(a.q_WC * b.q_WC.conjugate()).norm() < Scalar(1e-3);
}

/// Widens the best solution's covariance by the likelihood of the other one.
void widen(const PoseEstimate& other, int count, Scalar sigma_px, PoseEstimate* best) {
  const Scalar values = static_cast<Scalar>(2 * count), s2 = sigma_px * sigma_px;
  const Scalar excess = values * (other.rms_px * other.rms_px - best->rms_px * best->rms_px) / s2;
  if (!(excess < 40)) return;
  const Scalar odds = std::exp(-excess / 2), w = odds / (1 + odds);
  Vec6 d;
  d << log_so3(other.q_WC * best->q_WC.conjugate()), other.p_WC - best->p_WC;
  best->covariance = (1 - w) * best->covariance + w * (other.covariance + d * d.transpose());
}

}  // namespace

bool refine_pose(const Camera& camera, const Vec3* points_W, const Vec2* pixels, int count, Scalar sigma_px,
                 PoseEstimate* inout) {
  if (count < 3 || count > kPoseMaxPoints) return false;
  PnpPoint points[kPoseMaxPoints];
  for (int i = 0; i < count; ++i) points[i] = {points_W[i], Scalar(1), pixels[i]};
  return refine_pnp(camera, points, count, nullptr, {sigma_px, Scalar(0), kRefineRounds}, inout);
}

bool pose_by_lens(const Camera& camera, const Vec3* points_W, int count, const PoseEstimate& pose, const LensRows& rows,
                  Scalar* J_pose_lens) {
  Vec3 pivot = Vec3::Zero();
  for (int i = 0; i < count; ++i) pivot += points_W[i] / static_cast<Scalar>(count);
  Mat6 A = Mat6::Zero();
  Eigen::Matrix<Scalar, 6, kLensParameters> B = Eigen::Matrix<Scalar, 6, kLensParameters>::Zero();
  for (int i = 0; i < count; ++i) {
    Vec2 pixel;
    Mat26 J;
    if (!project_from_pose(camera, pose.q_WC, pose.p_WC, points_W[i], pivot, &pixel, &J)) return false;
    A += J.transpose().lazyProduct(J);
    B += J.transpose().lazyProduct(lens_jacobian(camera, pose.q_WC.conjugate() * (points_W[i] - pose.p_WC)));
  }
  SmallCholesky<6> factored;
  if (!factored.factor(A)) return false;
  const Eigen::Matrix<Scalar, 6, kLensParameters> J =
      -to_camera(pose.p_WC - pivot).lazyProduct(factored.solve<kLensParameters>(B));
  for (int a = 0; a < 6; ++a)
    for (int i = 0; i < rows.count; ++i) J_pose_lens[a * rows.count + i] = J(a, rows.parameter[i]);
  return true;
}

void rectangle_points(Scalar width, Scalar height, Vec3 points_W[4]) {
  const Scalar x = width / 2, y = height / 2;
  points_W[0] = Vec3(-x, -y, 0);
  points_W[1] = Vec3(x, -y, 0);
  points_W[2] = Vec3(x, y, 0);
  points_W[3] = Vec3(-x, y, 0);
}

bool rectangle_pose(const Camera& camera, Scalar width, Scalar height, const Vec2 corners[4], Scalar sigma_px,
                    PoseEstimate* best, Scalar* second_rms) {
  // In units of the rectangle, so that the plane's points and the rays have similar magnitudes.
  const Scalar unit = (width + height) / 2;
  if (!(width > 0) || !(height > 0) || !(unit <= kMaxScalar)) return false;
  Vec3 points_W[4], plane[4], rays[4];
  rectangle_points(width, height, points_W);
  for (int i = 0; i < 4; ++i) {
    if (!unproject(camera, corners[i], &rays[i])) return false;
    plane[i] = Vec3(points_W[i].x() / unit, points_W[i].y() / unit, 1);
  }
  Mat3 H, R_CW;
  Vec3 t_CW;
  if (!homography_from_4(plane, rays, &H) || !decompose(H, &R_CW, &t_CW)) return false;
  t_CW *= unit;

  PoseEstimate first = pose_of(R_CW, t_CW), second = pose_of(mirrored(R_CW, t_CW), t_CW);
  bool first_ok = refine_pose(camera, points_W, corners, 4, sigma_px, &first);
  bool second_ok = refine_pose(camera, points_W, corners, 4, sigma_px, &second);
  // From behind, the corners would be in the opposite order: reject a pose behind the wall.
  first_ok = first_ok && first.p_WC.z() < 0;
  second_ok = second_ok && second.p_WC.z() < 0;
  if (!first_ok && !second_ok) return false;
  if (first_ok && second_ok && is_same(first, second)) second_ok = false;
  if (!first_ok || (second_ok && second.rms_px < first.rms_px)) {
    const PoseEstimate keep = first;
    first = second;
    second = keep;
    second_ok = first_ok && second_ok;
  }
  if (second_ok) widen(second, 4, sigma_px, &first);
  if (second_rms != nullptr) *second_rms = second_ok ? second.rms_px : kMaxScalar;
  *best = first;
  return true;
}

}  // namespace pf
