#include "filter_slam/pose/usable_pose.h"

#include <algorithm>

#include "base/limits.h"
#include "frame/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "model/kinds.h"

namespace pf {
namespace {

constexpr int kMaxReferences = 12;  // points against which the camera is measured
constexpr Scalar kMinVariance = Scalar(1e-12);

struct Reference {
  Place at;
  Scalar variance;  ///< of its position relative to the camera, sum of the axes
};

/// Variance of f - p, sum of the axes:  tr(J P J^T),  J = (J_f, -I)
Scalar relative_variance(const Filter& filter, const Place& at) {
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
  Scalar variance = 0;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      variance +=
          filter.covariance()(std::max(column[a], column[b]), std::min(column[a], column[b])) * J.col(a).dot(J.col(b));
  return std::max(variance, kMinVariance);
}

/// Lists the best known of the points, the best first. Returns how many.
int list_references(const Filter& filter, const int* slots, int count, Reference* reference) {
  int references = 0;
  for (int i = 0; i < count; ++i) {
    Place at;
    if (!find_point(filter.state(), slots[i], &at)) continue;
    const Scalar variance = relative_variance(filter, at);
    int k = references;
    if (references == kMaxReferences) {
      if (reference[k - 1].variance <= variance) continue;
      --k;
    } else {
      ++references;
    }
    for (; k > 0 && reference[k - 1].variance > variance; --k) reference[k] = reference[k - 1];
    reference[k] = {at, variance};
  }
  return references;
}

}  // namespace

///   e_f = G_f g + noise,   G_f = (I, -[f - p]x, f - p)     the part g of an error that moves all points alike
///   g = (sum w G^T G)^-1 sum w G^T e_f,   w = 1 / variance of f - p
///   theta' = theta - g_theta,   p' = p - g_t               the pivot is the camera: rotation and scale leave p where it is
bool spread_against_points(const Filter& filter, const int* slots, int count, PoseSpread* spread) {
  Reference reference[kMaxReferences];
  const int references = list_references(filter, slots, count, reference);
  if (references < 3) return false;
  const Body& body = filter.state().body;
  Eigen::Matrix<Scalar, 7, 7> A = Eigen::Matrix<Scalar, 7, 7>::Zero();
  Eigen::Matrix<Scalar, 3, 7> G[kMaxReferences];
  for (int i = 0; i < references; ++i) {
    const Vec3 d = reference[i].at.o - body.p_W;
    G[i].leftCols<3>() = Mat3::Identity();
    G[i].block<3, 3>(0, 3) = -hat(d);
    G[i].col(6) = d;
    A += G[i].transpose().lazyProduct(G[i]) / reference[i].variance;
  }
  SmallCholesky<7> cholesky;
  if (!cholesky.factor(A)) return false;
  // Columns of M: d(theta', p') by each row of the state that it depends on.
  constexpr int kMaxColumns = kMaxReferences * Place::kMaxColumns + 6;
  int column[kMaxColumns];
  Vec6 M[kMaxColumns];
  int n = 0;
  for (; n < 6; ++n) {
    column[n] = n;
    M[n] = Mat6::Identity().col(n);
  }
  for (int i = 0; i < references; ++i) {
    const Place& at = reference[i].at;
    const Eigen::Matrix<Scalar, 7, 3> L = cholesky.solve<3>(G[i].transpose()) / reference[i].variance;
    for (int s = 0, c = 0; s < at.parts; ++s)
      for (int k = 0; k < at.part[s].size; ++k, ++c, ++n) {
        const Eigen::Matrix<Scalar, 7, 1> g = L.lazyProduct(at.J_o.col(c));
        column[n] = filter.blocks().row(at.part[s]) + k;
        M[n].head<3>() = -g.segment<3>(3);
        M[n].tail<3>() = -g.head<3>();
      }
  }
  *spread = PoseSpread();
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) {
      const Scalar P = filter.covariance()(std::max(column[a], column[b]), std::min(column[a], column[b]));
      spread->rotation += P * M[a].head<3>().dot(M[b].head<3>());
      spread->position += P * M[a].tail<3>().dot(M[b].tail<3>());
    }
  return true;
}

bool is_pose_usable(const Filter& filter, const Map& map, const Frame& frame, const Scalar* patch_depth, int patches,
                    Scalar* median_depth) {
  using namespace tuning::usable_pose;
  Scalar depths[kMaxObservations + kMaxPatches];
  int slots[kMaxObservations];
  int count = 0;
  const Body& body = filter.state().body;
  const Vec3 forward = body.q_WC.toRotationMatrix().col(2);
  for (int t = 0; t < frame.match_count() && count < kMaxObservations; ++t) {
    const Match& match = frame.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier) continue;
    slots[count] = map.features[match.feature].slot;
    depths[count] = forward.dot(filter.point(slots[count]) - body.p_W);
    ++count;
  }
  int all = count;
  for (int i = 0; i < patches && i < kMaxPatches; ++i) depths[all++] = patch_depth[i];
  if (all == 0) return false;
  std::nth_element(depths, depths + all / 2, depths + all);
  *median_depth = depths[all / 2];
  const auto is_small = [&](const PoseSpread& spread) {
    const Scalar max_position = kMaxPositionSigma * *median_depth;
    return spread.rotation < kMaxRotationSigma * kMaxRotationSigma && spread.position < max_position * max_position;
  };
  PoseSpread spread;
  for (int i = 0; i < 3; ++i) {
    spread.rotation += filter.variance(Body::kTheta + i);
    spread.position += filter.variance(Body::kPosition + i);
  }
  return is_small(spread) || (spread_against_points(filter, slots, count, &spread) && is_small(spread));
}

}  // namespace pf
