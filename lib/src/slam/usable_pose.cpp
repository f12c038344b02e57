#include "slam/usable_pose.h"

#include <algorithm>

#include "filter/model/kinds.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {
namespace {

constexpr Scalar kMostRotation = Scalar(0.349);  ///< [rad] 20 degrees
constexpr Scalar kMostDepths = Scalar(0.5);      ///< of the position, against the median depth
constexpr int kMostWitnesses = 12;               ///< points against which a camera is measured

}  // namespace

///   e_f = G_f g + noise,  G_f = (I, -[f]x, f)   the part g of an error that moves all points alike (translation, rotation, scale)
///   g = (sum w G^T G)^-1 sum w G^T e_f,         e' = e - G_pose g                            w = 1 / variance of f - p
bool is_pose_usable(const Filter& filter, const Map& map, const Frame& frame, Scalar* median_depth) {
  Scalar rotation = 0, position = 0;
  for (int i = 0; i < 3; ++i) {
    rotation += filter.variance(Body::kTheta + i);
    position += filter.variance(Body::kPosition + i);
  }
  constexpr int kMost = 256;
  Scalar depths[kMost];
  int slots[kMost];
  int count = 0;
  const Body& body = filter.state().body;
  const Vec3 forward = body.q_WC.toRotationMatrix().col(2);
  for (int t = 0; t < frame.match_count() && count < kMost; ++t) {
    const Match& match = frame.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier) continue;
    slots[count] = map.features[match.feature].slot;
    depths[count] = forward.dot(filter.point(slots[count]) - body.p_W);
    ++count;
  }
  if (count == 0) return false;
  Scalar sorted[kMost];
  std::copy(depths, depths + count, sorted);
  std::nth_element(sorted, sorted + count / 2, sorted + count);
  const Scalar depth = *median_depth = sorted[count / 2];
  const Scalar most_r = kMostRotation * kMostRotation, most_p = kMostDepths * kMostDepths * depth * depth;
  if (rotation < most_r && position < most_p) return true;

  // The best known of the points, as witnesses.
  struct Witness {
    Place at;
    Scalar variance;
  } witness[kMostWitnesses];
  int witnesses = 0;
  for (int i = 0; i < count; ++i) {
    Place at;
    if (!find_point(filter.state(), slots[i], &at)) continue;
    // Of f - p, per axis on average.
    Scalar variance = 0;
    int column[Place::kMaxColumns + 3];
    Eigen::Matrix<Scalar, 3, Place::kMaxColumns + 3> J;
    int n = 0;
    for (int s = 0, c = 0; s < at.parts; ++s)
      for (int k = 0; k < at.part[s].size; ++k, ++c, ++n) {
        column[n] = filter.blocks().row(at.part[s]) + k;
        J.col(n) = at.J_o.col(c);
      }
    for (int k = 0; k < 3; ++k, ++n) {
      column[n] = Body::kPosition + k;
      J.col(n) = -Mat3::Identity().col(k);
    }
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        variance += filter.covariance()(std::max(column[a], column[b]), std::min(column[a], column[b])) *
                    J.col(a).dot(J.col(b));
    int k = witnesses;
    if (witnesses == kMostWitnesses) {
      if (witness[k - 1].variance <= variance) continue;
      --k;
    } else {
      ++witnesses;
    }
    for (; k > 0 && witness[k - 1].variance > variance; --k) witness[k] = witness[k - 1];
    witness[k] = {at, variance};
  }
  if (witnesses < 3) return false;

  // About the camera, so that rotations and translations of the points are well apart.
  Eigen::Matrix<Scalar, 7, 7> A = Eigen::Matrix<Scalar, 7, 7>::Zero();
  Eigen::Matrix<Scalar, 3, 7> G[kMostWitnesses];
  for (int i = 0; i < witnesses; ++i) {
    const Vec3 d = witness[i].at.o - body.p_W;
    G[i].leftCols<3>() = Mat3::Identity();
    G[i].block<3, 3>(0, 3) = -hat(d);
    G[i].col(6) = d;
    A += G[i].transpose().lazyProduct(G[i]) / std::max(witness[i].variance, Scalar(1e-12));
  }
  SmallCholesky<7> cholesky;
  if (!cholesky.factor(A)) return false;
  // e' of (theta, p): theta - g_theta, p - g_t (the pivot is the camera, so that rotation and scale leave it where it is).
  constexpr int kColumns = kMostWitnesses * Place::kMaxColumns + 6;
  int column[kColumns];
  Vec6 M[kColumns];
  int n = 0;
  for (int k = 0; k < 6; ++k) {
    column[n] = k;
    M[n++] = Mat6::Identity().col(k);
  }
  for (int i = 0; i < witnesses; ++i) {
    const Place& at = witness[i].at;
    const Eigen::Matrix<Scalar, 7, 3> L =
        cholesky.solve<3>(G[i].transpose()) / std::max(witness[i].variance, Scalar(1e-12));
    for (int s = 0, c = 0; s < at.parts; ++s)
      for (int k = 0; k < at.part[s].size; ++k, ++c) {
        const Eigen::Matrix<Scalar, 7, 1> g = L.lazyProduct(at.J_o.col(c));
        column[n] = filter.blocks().row(at.part[s]) + k;
        M[n].head<3>() = -g.segment<3>(3);
        M[n++].tail<3>() = -g.head<3>();
      }
  }
  rotation = position = 0;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) {
      const Scalar P = filter.covariance()(std::max(column[a], column[b]), std::min(column[a], column[b]));
      rotation += P * M[a].head<3>().dot(M[b].head<3>());
      position += P * M[a].tail<3>().dot(M[b].tail<3>());
    }
  return rotation < most_r && position < most_p;
}

}  // namespace pf
