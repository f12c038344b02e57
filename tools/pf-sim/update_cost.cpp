#include "update_cost.h"

#include <cmath>
#include <ctime>
#include <vector>

#include "statistics.h"

namespace pfsim {

std::int64_t thread_clock(void*) {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<std::int64_t>(t.tv_sec) * 1000000000 + t.tv_nsec;
}

UpdateCost cost_of_20_rows(Bed& bed, pf_slam_t* slam, pf_pose_t pose, int frame, double rate_hz) {
  constexpr int kFrames = 60;
  constexpr std::size_t kObservations = 10;
  std::vector<double> updates, frames;
  for (int k = 0; k < kFrames; ++k, ++frame) {
    double dv_C[3], dw_C[3];
    bed.steer(frame - 1, pose, dv_C, dw_C);
    pf_push_control(slam, dv_C, dw_C);
    bed.move(frame, dv_C, dw_C);
    int births = 0;
    const auto seen = bed.observe(frame, &births);
    std::vector<pf_observation_t> some;
    for (std::size_t i = 0; i < seen.size() && seen.size() >= kObservations && some.size() < kObservations; ++i)
      if (some.size() * seen.size() <= i * kObservations) some.push_back(seen[i]);
    if (some.size() < kObservations) continue;
    const auto t_ns = static_cast<std::int64_t>(std::llround(frame * 1e9 / rate_hz));
    const auto begin = thread_clock(nullptr);
    if (pf_push_observations(slam, t_ns, some.data(), some.size()) != PF_OK) continue;
    const auto end = thread_clock(nullptr);
    pf_report_t report;
    if (pf_get_report(slam, &report) != PF_OK || pf_get_pose(slam, &pose) != PF_OK ||
        report.inliers != static_cast<int>(kObservations))
      continue;
    updates.push_back(1e-3 * static_cast<double>(report.stage_ns[PF_STAGE_UPDATE]));
    frames.push_back(1e-3 * static_cast<double>(end - begin));
  }
  if (updates.empty()) return {};
  return {median(updates), median(frames)};
}

}  // namespace pfsim
