#include "slam/moving_start.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/imu_path.h"
#include "filter/tuning.h"
#include "geometry/pnp.h"
#include "slam/tuning.h"

namespace pf {

using namespace tuning::moving_verdict;

/// Keeps this frame: its inliers, and the samples since the last one that is kept. False where samples are missing.
bool MovingStart::add() {
  const State& state = filter_.state();
  if (data_.count == kMaxMovingPoses) std::copy(data_.view + 1, data_.view + data_.count--, data_.view);
  View& view = data_.view[data_.count];
  view = View();
  view.q_WC = state.body.q_WC;
  view.p_W = state.body.p_W;
  const std::int64_t t_ns = frame_.report.t_ns;
  if (data_.count > 0) {
    Preintegral samples(settings_.unit.noise, state.body.gyro_bias, Vec3::Zero());
    ImuReading now;
    if (integrate_samples(imu_, motion_.on_unit_clock(data_.t_ns), motion_.on_unit_clock(t_ns), Coasting(), &samples,
                          &now) > Scalar(0))
      return false;
    view.dt = samples.dt();
    view.gyro_bias = state.body.gyro_bias;
    view.v = samples.v();
    view.p = samples.p();
    view.by_bias = samples.by_bias().bottomRows<6>();
  }
  for (int i = 0; i < frame_.match_count() && view.count < kMaxPixels; ++i) {
    const Match& match = frame_.match(i);
    if (match.status != MatchStatus::kInlier) continue;
    view.seen[view.count++] = {match.id, static_cast<float>(match.measured.x()),
                               static_cast<float>(match.measured.y())};
  }
  data_.t_ns = t_ns;
  ++data_.count;
  return true;
}

/// Whether a feature's depth is known, but for the scale of all.
bool MovingStart::has_depth(int entry) const {
  const int slot = map_.features[entry].slot;
  const Block& block = filter_.state().block[slot];
  if (block.kind != BlockKind::kInverseDepth) return true;
  const Scalar rho = block.inverse_depth().rho;
  return rho > Scalar(0) && std::sqrt(filter_.block_variance(slot, 2)) < kMaxDepthSigma * rho;
}

/// The pose of a view by what the map says of its features now.
bool MovingStart::locate(View* view) const {
  PnpPoint point[kMaxPixels];
  int count = 0;
  for (int i = 0; i < view->count; ++i) {
    int entry = 0;
    while (entry < map_.features.capacity() &&
           !(map_.features.used(entry) && map_.features[entry].id == view->seen[i].id))
      ++entry;
    if (entry == map_.features.capacity() || !has_depth(entry)) continue;
    point[count++] = {filter_.point(map_.features[entry].slot), Scalar(1),
                      Vec2(static_cast<Scalar>(view->seen[i].x), static_cast<Scalar>(view->seen[i].y))};
  }
  if (count < kMinPixels) return false;
  PoseEstimate pose;
  pose.q_WC = view->q_WC;
  pose.p_WC = view->p_W;
  if (!refine_pnp(filter_.lens(), point, count, nullptr, {settings_.sigma_px, kHuber, kRounds}, &pose)) return false;
  view->q_WC = pose.q_WC;
  view->p_W = pose.p_WC;
  return true;
}

/// Of the views behind the last one that sees too little of the map, as it is known now. Returns how many.
int MovingStart::find_poses(MovingPose* pose) {
  int first = data_.count;
  while (first > 0 && locate(&data_.view[first - 1])) --first;
  const Mat3& R_CB = filter_.state().mounting.R_CB;
  const Vec3 gyro_bias = filter_.state().body.gyro_bias;
  const int count = data_.count - first;
  for (int k = 0; k < count; ++k) {
    const View& view = data_.view[first + k];
    pose[k].p_W = view.p_W;
    pose[k].m_W = view.q_WC * settings_.unit.mounting.p_C;
    if (k == 0) continue;
    const Mat3 R_WB = data_.view[first + k - 1].q_WC.toRotationMatrix() * R_CB;
    const Vec3 more = gyro_bias - view.gyro_bias;
    pose[k].dt = view.dt;
    pose[k].Rv = R_WB * (view.v + view.by_bias.block<3, 3>(0, 0) * more);
    pose[k].Rp = R_WB * (view.p + view.by_bias.block<3, 3>(3, 0) * more);
    pose[k].Rv_b = R_WB * view.by_bias.block<3, 3>(0, 3);
    pose[k].Rp_b = R_WB * view.by_bias.block<3, 3>(3, 3);
  }
  return count;
}

bool MovingStart::is_accepted(const MovingPose* pose, int count, const MovingStartNoise& noise,
                              MovingSolution* solution) const {
  MovingSolution half[2];
  const int middle = count / 2;
  if (!solve_moving_start(pose, count, noise, solution)) return false;
  if (!(solution->sigma_scale() < kMaxSigmaScale) || !(solution->sigma_gravity() < kMaxSigmaGravity)) return false;
  if (!(solution->misfit < kMaxMisfit)) return false;
  if (!solve_moving_start(pose, middle + 1, noise, &half[0]) ||
      !solve_moving_start(pose + middle, count - middle, noise, &half[1]))
    return false;
  const Scalar of_scale = half[0].covariance(0, 0) + half[1].covariance(0, 0);
  const Scalar of_gravity =
      half[0].sigma_gravity() * half[0].sigma_gravity() + half[1].sigma_gravity() * half[1].sigma_gravity();
  const Scalar apart = std::log(half[0].scale / half[1].scale);
  const Vec3 g_0 = half[0].q_WG.toRotationMatrix().col(2), g_1 = half[1].q_WG.toRotationMatrix().col(2);
  return apart * apart < kMaxApart * of_scale && (g_0 - g_1).squaredNorm() < kMaxApart * of_gravity;
}

bool MovingStart::note(bool usable, std::uint32_t map_id, Scalar depth, MovingSolution* solution) {
  if (!usable || map_id != data_.map_id) data_.count = 0;
  data_.map_id = map_id;
  if (!usable ||
      (data_.count > 0 && seconds(elapsed_ns(data_.t_ns, frame_.report.t_ns)) < static_cast<double>(kInterval)))
    return false;
  if (!add()) {
    data_.count = 0;
    return false;
  }
  MovingPose pose[kMaxMovingPoses];
  const int count = data_.count < kMinPoses ? 0 : find_poses(pose);
  if (count < kMinPoses) return false;
  MovingStartNoise noise;
  noise.gravity = settings_.unit.gravity;
  noise.position = kPosition * depth;
  noise.accel_density = std::hypot(settings_.unit.noise.accel_density, settings_.unit.gravity * kRotation);
  noise.tilt_density = std::max(kTiltDensity, settings_.unit.noise.gyro_density);
  noise.accel_bias = tuning::inertial::kAccelBias;
  return is_accepted(pose, count, noise, solution);
}

}  // namespace pf
