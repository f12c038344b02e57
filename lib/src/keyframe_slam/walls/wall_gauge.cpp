#include "keyframe_slam/walls/wall_gauge.h"

#include <algorithm>
#include <cmath>

#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "keyframe_slam/walls/tuning.h"

namespace pf {
namespace {

using Wide37 = Eigen::Matrix<double, 3, 7>;
using Wide67 = Eigen::Matrix<double, 6, 7>;
using Wide7 = Eigen::Matrix<double, 7, 7>;

/// How (theta, p) of a pose at p_W changes with (t, theta, log s):   theta,   t + theta x p + s p
Wide67 pose_gauge(const Vec3& p_W) {
  Wide67 J = Wide67::Zero();
  J.block<3, 3>(0, 3).setIdentity();
  J.block<3, 3>(3, 0).setIdentity();
  J.block<3, 3>(3, 3) = -hat(p_W).cast<double>();
  J.col(6).tail<3>() = p_W.cast<double>();
  return J;
}

/// About the plan, wherever the wall was found: a shift of the map and of all walls with it is what no measurement sees, and G that changes
/// from one to the next would see a part of it.
Wide37 gauge_of(const PlaneFrame& plan) { return plane_gauge(plan, Vec3::Zero()).cast<double>(); }

/// Covariance of (t, theta, log s) of what is held by a pose at p_W and has a size of its own about it: the inverse of pose_gauge().
Wide7 held_by_pose(const Mat6& pose, const Vec3& p_W, Scalar sigma_scale) {
  Wide7 B = Wide7::Zero(), C = Wide7::Zero();
  B.block<3, 3>(0, 0) = hat(p_W).cast<double>();
  B.block<3, 3>(0, 3).setIdentity();
  B.col(6).head<3>() = -p_W.cast<double>();
  B.block<3, 3>(3, 0).setIdentity();
  B(6, 6) = 1;
  C.topLeftCorner<6, 6>() = pose.cast<double>();
  C(6, 6) = static_cast<double>(sigma_scale) * static_cast<double>(sigma_scale);
  const Wide7 P = B.lazyProduct(C).lazyProduct(B.transpose());
  return (P + P.transpose()) / 2;
}

}  // namespace

bool WallGauge::layout(Arena& arena, int max_walls) {
  walls_ = max_walls;
  rows_ = row_of(max_walls);
  const std::size_t rows = static_cast<std::size_t>(rows_), walls = static_cast<std::size_t>(max_walls);
  P_ = arena.take<double>(rows * rows);
  before_ = arena.take<double>(rows * rows);
  gain_ = arena.take<double>(3 * rows);
  cross_ = arena.take<double>(3 * rows);
  wall_ = arena.take<Vec3>(walls);
  wall_before_ = arena.take<Vec3>(walls);
  has_ = arena.take<bool>(walls);
  return arena.ok();
}

void WallGauge::init() {
  has_begun_ = false;
  std::fill(P_, P_ + rows_ * rows_, 0.0);
  std::fill(g_, g_ + kMapRows, 0.0);
  std::fill(wall_, wall_ + walls_, Vec3(Vec3::Zero()));
  std::fill(has_, has_ + walls_, false);
}

void WallGauge::clear_rows(int from, int count) {
  for (int i = from; i < from + count; ++i)
    for (int j = 0; j < rows_; ++j) at(i, j) = at(j, i) = 0;
}

void WallGauge::begin(const Mat6& pose, const Vec3& p_W, Scalar sigma_scale) {
  clear_rows(0, kMapRows);
  has_begun_ = true;
  drift(pose, p_W, sigma_scale);
}

void WallGauge::drift(const Mat6& pose, const Vec3& p_W, Scalar sigma_scale) {
  const Wide7 Q = held_by_pose(pose, p_W, sigma_scale);
  for (int i = 0; i < kMapRows; ++i)
    for (int j = 0; j < kMapRows; ++j) at(i, j) += Q(i, j);
}

void WallGauge::add(int k, const Mat3& covariance) {
  clear_rows(row_of(k), 3);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) at(row_of(k) + i, row_of(k) + j) = static_cast<double>(covariance(i, j));
  wall_[k].setZero();
  has_[k] = true;
}

WallGauge::Wide3 WallGauge::block(int k) const {
  Wide3 C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = at(row_of(k) + i, row_of(k) + j);
  return C;
}

/// Of the mean, row i.
void WallGauge::shift(int i, double by) {
  if (i < kMapRows)
    g_[i] += by;
  else
    wall_[(i - kMapRows) / 3]((i - kMapRows) % 3) += static_cast<Scalar>(by);
}

/// From what was known before the comparison, of a map that has been moved since: the mean of g takes it back.
///
///   exp(g) of the map as it was = exp(g') T:   g' = log T^-1 in the mean
void WallGauge::begin_again(const Similarity& moved) {
  std::copy(before_, before_ + rows_ * rows_, P_);
  std::copy(wall_before_, wall_before_ + walls_, wall_);
  const Quat back = moved.q.conjugate();
  const Vec3 t = -(back * moved.t) / moved.s, theta = log_so3(back);
  for (int i = 0; i < 3; ++i) {
    g_[i] = static_cast<double>(t(i));
    g_[3 + i] = static_cast<double>(theta(i));
  }
  g_[6] = -std::log(static_cast<double>(moved.s));
}

Similarity WallGauge::compare(MeasuredWall* walls, int count, Scalar gate) {
  std::copy(P_, P_ + rows_ * rows_, before_);
  std::copy(wall_, wall_ + walls_, wall_before_);
  Similarity moved;
  for (int round = 0; round < tuning::keyframe_walls::kRounds; ++round) {
    if (round > 0) begin_again(moved);
    for (MeasuredWall* wall = walls; wall != walls + count; ++wall) {
      const PlaneFrame frame = {moved.q.toRotationMatrix() * wall->frame.R_WP, moved.of(wall->frame.o_W)};
      Vec3 z;
      Mat3 J;
      wall->fits = reframe_plane(frame, Vec3::Zero(), wall->plan, &z, &J);
      J.col(2) *= moved.s;  // lengths of the map
      if (wall->fits)
        wall->fits =
            measure(wall->wall, wall->plan, z, J.lazyProduct(wall->covariance).lazyProduct(J.transpose()), gate);
    }
    const Similarity further = take_correction();
    moved = {(further.q * moved.q).normalized(), further.of(moved.t), further.s * moved.s};
  }
  return moved;
}

bool WallGauge::measure(int k, const PlaneFrame& plan, const Vec3& z, const Mat3& R, Scalar gate) {
  const Wide37 G = gauge_of(plan);
  Eigen::Map<const Eigen::Matrix<double, kMapRows, 1>> g(g_);
  const Eigen::Vector3d r = (z - wall_[k]).cast<double>() + G.lazyProduct(g);
  for (int i = 0; i < rows_; ++i)
    for (int a = 0; a < 3; ++a) {
      double sum = at(i, row_of(k) + a);
      for (int j = 0; j < kMapRows; ++j) sum -= at(i, j) * G(a, j);
      cross_[3 * i + a] = sum;  // P Hᵀ
    }
  Wide3 S = R.cast<double>();
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 3; ++c) {
      S(a, c) += cross_[3 * (row_of(k) + a) + c];
      for (int j = 0; j < kMapRows; ++j) S(a, c) -= G(a, j) * cross_[3 * j + c];
    }
  S = Wide3((S + S.transpose()) / 2);
  SmallCholesky<3, double> cholesky;
  if (!cholesky.factor(S)) return false;
  const Eigen::Vector3d weighted = cholesky.solve<1>(r);
  if (!(r.dot(weighted) < static_cast<double>(gate))) return false;
  for (int i = 0; i < rows_; ++i) {
    const Eigen::Map<const Eigen::Vector3d> row(cross_ + 3 * i);
    Eigen::Map<Eigen::Vector3d>(gain_ + 3 * i) = cholesky.solve<1>(Eigen::Vector3d(row));
    shift(i, row.dot(weighted));
  }
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = at(i, j);
      for (int a = 0; a < 3; ++a) sum -= gain_[3 * i + a] * cross_[3 * j + a];
      at(i, j) = at(j, i) = i == j ? std::max(sum, 0.0) : sum;
    }
  return true;
}

Similarity WallGauge::forget(int k, const Mat3& C, Scalar widening) {
  SmallCholesky<3, double> cholesky;
  const Wide3 left = (1 + 1 / static_cast<double>(widening)) * C.cast<double>() - block(k);
  if (cholesky.factor(left)) {
    const Wide3 M = cholesky.inverse();
    const Eigen::Vector3d Mx = M.lazyProduct(wall_[k].cast<double>());
    for (int i = 0; i < rows_; ++i)
      for (int a = 0; a < 3; ++a) cross_[3 * i + a] = at(i, row_of(k) + a);
    for (int i = 0; i < rows_; ++i) {
      const Eigen::Map<const Eigen::Vector3d> row(cross_ + 3 * i);
      const Eigen::Vector3d by = M.lazyProduct(row);
      for (int j = 0; j <= i; ++j) at(j, i) = at(i, j) += by.dot(Eigen::Map<const Eigen::Vector3d>(cross_ + 3 * j));
      if (i < row_of(k) || i >= row_of(k) + 3) shift(i, row.dot(Mx));
    }
  }
  clear_rows(row_of(k), 3);
  wall_[k].setZero();
  has_[k] = false;
  return take_correction();
}

Similarity WallGauge::take_correction() {
  Similarity T;
  T.t = Vec3(static_cast<Scalar>(g_[0]), static_cast<Scalar>(g_[1]), static_cast<Scalar>(g_[2]));
  T.q = exp_so3(Vec3(static_cast<Scalar>(g_[3]), static_cast<Scalar>(g_[4]), static_cast<Scalar>(g_[5])));
  T.s = static_cast<Scalar>(std::exp(g_[6]));
  std::fill(g_, g_ + kMapRows, 0.0);
  return T;
}

Mat3 WallGauge::wall_covariance(int k) const { return block(k).cast<Scalar>(); }

namespace {

Wide7 map_block(const double* P, int rows) {
  Wide7 C;
  for (int i = 0; i < WallGauge::kMapRows; ++i)
    for (int j = 0; j < WallGauge::kMapRows; ++j) C(i, j) = P[i * rows + j];
  return C;
}

}  // namespace

Mat3 WallGauge::relative_covariance(int k, const PlaneFrame& plan) const {
  const Wide37 G = gauge_of(plan);
  Wide37 C_kg;
  for (int a = 0; a < 3; ++a)
    for (int j = 0; j < kMapRows; ++j) C_kg(a, j) = at(row_of(k) + a, j);
  const Wide3 across = C_kg.lazyProduct(G.transpose());
  const Wide3 C =
      block(k) - across - across.transpose() + G.lazyProduct(map_block(P_, rows_)).lazyProduct(G.transpose());
  return C.cast<Scalar>();
}

Mat3 WallGauge::plane_covariance(const PlaneFrame& frame) const {
  const Wide37 G = plane_gauge(frame, Vec3::Zero()).cast<double>();
  return Wide3(G.lazyProduct(map_block(P_, rows_)).lazyProduct(G.transpose())).cast<Scalar>();
}

Mat6 WallGauge::pose_covariance(const Vec3& p_W) const {
  const Wide67 J = pose_gauge(p_W);
  const Eigen::Matrix<double, 6, 6> C = J.lazyProduct(map_block(P_, rows_)).lazyProduct(J.transpose());
  return ((C + C.transpose()) / 2).cast<Scalar>();
}

}  // namespace pf
