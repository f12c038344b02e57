#include "record.h"

#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "context.h"
#include "session.h"

namespace replay {

bool record(const std::string& file, int frames, std::uint64_t seed, bool planes) {
  const pfsim::BedOptions options = session_bed(frames);
  const pf_config_t config = session_config(options, planes);
  pfsim::Bed bed(options, config, seed);
  const pfsim::Context context(config);
  pf_slam_t* slam = context.slam;
  Tape tape(file, true);
  if (!tape.ok() || slam == nullptr || pf_start_from_target(slam, &bed.target()) != PF_OK ||
      pf_start_from_pose(slam, &bed.start(), bed.velocity_covariance()) != PF_OK) {
    return false;
  }
  bool written = tape.write(frames) && tape.write(seed) && tape.write(planes);
  Frame frame;
  frame.pose = bed.start();
  std::vector<pf_match_t> tracks(1000);
  std::unordered_map<std::uint32_t, std::uint32_t> observation_of;  // by id of the feature
  std::unordered_map<std::uint32_t, std::int32_t> kind_of;          // by the observations' id
  for (int i = 0; i < frames && written; ++i) {
    if (i > 0) {
      bed.steer(i - 1, frame.pose, frame.dv_C, frame.dw_C);
      pf_push_control(slam, frame.dv_C, frame.dw_C);
      bed.move(i, frame.dv_C, frame.dw_C);
    }
    int births = 0;
    const std::vector<pf_observation_t> seen = bed.observe(i, &births);
    frame.t_ns = std::llround(i * 1e9 / options.rate_hz);
    frame.tracked = pf_push_observations(slam, frame.t_ns, seen.data(), seen.size()) == PF_OK;
    if (pf_get_pose(slam, &frame.pose) != PF_OK) return false;
    pf_report_t report;
    pf_get_report(slam, &report);
    frame.offered = static_cast<std::int32_t>(seen.size());
    frame.inliers = report.inliers;
    frame.features = report.features;
    frame.state_dim = report.state_dim;

    // A feature may leave the map in the frame that refuses its measurement.
    frame.decisions.clear();
    for (const pf_feature_t& f : map_of(slam)) {
      observation_of[f.id] = f.external_id;
      std::int32_t& kind = kind_of[f.external_id];
      if (kind != f.kind) frame.decisions.push_back({f.external_id, f.kind});
      kind = f.kind;
    }
    std::size_t count = 0;
    pf_get_matches(slam, tracks.data(), tracks.size(), &count);
    std::unordered_set<std::uint32_t> dropped;
    for (std::size_t k = 0; k < count && k < tracks.size(); ++k) {
      if (tracks[k].status == PF_MATCH_OUTLIER) dropped.insert(observation_of[tracks[k].id]);
    }
    frame.observations.clear();
    for (const pf_observation_t& o : seen) {
      if (dropped.count(o.id) == 0) frame.observations.push_back(o);
    }
    written = tape.write(frame);
    if (i % 1000 == 999) std::fprintf(stderr, "\r%d of %d frames", i + 1, frames);
  }
  std::fprintf(stderr, "\n");
  return written && tape.write(map_of(slam));
}

}  // namespace replay
