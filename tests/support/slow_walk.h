#pragma once

// A slow sideways walk past points that are seen with 0.1 px of noise, with default settings and no target: nothing tells the scale of
// the world, and what its points know of each other is soon a hundred thousand times better known than the scale.

#include <vector>

#include "api/context.h"
#include "filter_slam/filter_slam.h"
#include "same.h"
#include "support/filter_cases.h"

namespace pf {

struct SlowWalk {
  int frames = 1500;
  int look_every = 10;    // frames from one look at the whole covariance to the next
  double pose_sigma = 0;  // [rad, m] of the pose that it starts from; 0: from none

  // What came of it.
  double smallest = 1;  // eigenvalue of the correlations of P
  double error_m = 0;   // of the camera's position after Sim(3), root mean square
  int starts = 0, tracked = 0, repairs = 0;

  void run(std::uint64_t seed);
};

namespace slow_walk {

using Point = Eigen::Vector3d;

inline Point camera(int frame) {
  return Point(0.8 * std::sin(frame * 0.01) + 0.002 * frame, 0.2 * std::sin(frame * 0.017),
               0.2 * std::sin(frame * 0.013));
}

/// Smallest eigenvalue of the correlations of all of P, in double. A row without variance is known exactly, and has none.
inline double smallest_correlation(const Triangle& P) {
  Dense C(P.n, P.n);
  for (int i = 0; i < P.n; ++i)
    for (int j = 0; j <= i; ++j) {
      const double scale = std::sqrt(static_cast<double>(P(i, i))) * std::sqrt(static_cast<double>(P(j, j)));
      C(i, j) = C(j, i) = i == j ? (P(i, i) < 0 ? -1 : 1) : scale > 0 ? static_cast<double>(P(i, j)) / scale : 0;
    }
  return eigenvalues_of(C)(0);
}

}  // namespace slow_walk

inline void SlowWalk::run(std::uint64_t seed) {
  constexpr int kPoints = 400, kSeen = 60, kSettled = 20;
  constexpr double kNoise = 0.1;
  SeededRandom random(seed);
  pf_config_t config;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  config.camera = {PF_CAMERA_PINHOLE,  320, 240, 280, 280, 159.5, 119.5, {0}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,   0,   0,   {0}};
  Settings settings;
  TEST_ASSERT_SAME(Status::kOk, settings_from(config, &settings, nullptr));
  TestArena arena(std::size_t{16} << 20);
  Map map;
  map.layout(*arena, settings.max_features, settings.max_planes);
  map.init();
  ImuLog imu;
  imu.layout(*arena, settings.imu.buffer);
  imu.init(settings.imu.buffer, settings.imu.ranges);
  FilterSlam loop(settings, map, imu);
  TEST_ASSERT_TRUE(loop.layout(*arena));
  loop.init();
  if (pose_sigma > 0) {
    KnownBody known;
    const int rows = settings.body.known_rows();
    for (int i = 0; i < rows; ++i)
      known.covariance[i * rows + i] = i < 6 ? static_cast<Scalar>(pose_sigma * pose_sigma) : 1;
    TEST_ASSERT_SAME(Status::kOk, loop.start().use_pose(known));
  }
  std::vector<slow_walk::Point> point(kPoints), found, truth;
  for (slow_walk::Point& p : point) p = {random.uniform(-2, 10), random.uniform(-1.2, 1.2), random.uniform(2, 5)};
  smallest = 1;
  starts = tracked = 0;
  std::uint32_t map_id = loop.tracking().map_id();
  for (int f = 0; f < frames; ++f) {
    std::vector<PixelObservation> seen;
    for (std::uint32_t i = 0; i < kPoints && seen.size() < kSeen; ++i) {
      const slow_walk::Point p = point[i] - slow_walk::camera(f);
      double pixel[2];
      if (pf_camera_project(&config.camera, p.data(), pixel) != PF_OK || pixel[0] < 5 || pixel[0] > 314 ||
          pixel[1] < 5 || pixel[1] > 234)
        continue;
      const Vec2 z(static_cast<Scalar>(pixel[0] + kNoise * random.normal()),
                   static_cast<Scalar>(pixel[1] + kNoise * random.normal()));
      seen.push_back({i, z, static_cast<Scalar>(kNoise)});
    }
    const Status status =
        loop.push_observations(seen.data(), static_cast<int>(seen.size()), (f + 1) * std::int64_t{33333333});
    tracked += status == Status::kOk ? 1 : 0;
    if (loop.tracking().map_id() != map_id) {
      map_id = loop.tracking().map_id();
      ++starts;
      found.clear();
      truth.clear();
    }
    if (f > kSettled && status == Status::kOk) {
      found.push_back(loop.filter().state().body.p_W.cast<double>());
      truth.push_back(slow_walk::camera(f));
    }
    if (f % look_every == look_every - 1)
      smallest = std::min(smallest, slow_walk::smallest_correlation(loop.filter().covariance()));
  }
  repairs = loop.frame().report.repairs;
  error_m = found.empty() ? 1e9 : error_after_sim3(found, truth);
  std::printf(
      "%d frames: smallest eigenvalue %.3g, %.2f mm after Sim(3), tracked %d, starts again %d, repairs %d, rows %d\n",
      frames, smallest, 1000 * error_m, tracked, starts, repairs, loop.filter().dim());
}

}  // namespace pf
