#include "quality.h"

#include <cmath>

#include "statistics.h"

namespace replay {

using pf::sim::Vec3;

double Quality::rms(double sum, int count) { return std::sqrt(mean(sum, count)); }

void Quality::add(const pf::sim::Pose& truth, const pf_pose_t& pose) {
  const Vec3 theta = pf::sim::rotation_log(truth.R_WC * pf::sim::rotation_of(pose.q_WC).transposed());
  const Vec3 e = truth.p_WC - Vec3{pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]};
  const double error[6] = {theta.x, theta.y, theta.z, e.x, e.y, e.z};
  nees_ += pfsim::normalised_error(error, pose.covariance, 6, 6, 0);
  square_m_ += e.dot(e);
  square_rad_ += theta.dot(theta);
  ++frames_;
}

void Quality::add(const std::vector<pfsim::WorldPoint>& truth, const std::vector<pf_feature_t>& map) {
  for (const pf_feature_t& f : map) {
    if (f.kind == PF_FEATURE_INVERSE_DEPTH || f.is_target || f.external_id >= truth.size()) continue;
    const Vec3 e = truth[f.external_id].p_W - Vec3{f.p_W[0], f.p_W[1], f.p_W[2]};
    map_square_ += e.dot(e);
    ++points_;
  }
}

}  // namespace replay
