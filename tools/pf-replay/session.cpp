#include "session.h"

#include <algorithm>

namespace replay {

pfsim::BedOptions session_bed(int frames) {
  pfsim::BedOptions bed;
  bed.layout = pfsim::Layout::kRoom;
  bed.circle = true;
  bed.fov_deg = 43;
  bed.frames = frames;
  return bed;
}

pf_config_t session_config(const pfsim::BedOptions& bed, bool planes) {
  pf_config_t config;
  pf_config_default(&config);
  config.camera = pfsim::Bed::camera(bed.fov_deg);
  config.measurement.sigma_px = 1;
  config.measurement.gate_probability = 0.9999;
  config.capacity.max_features = 300;
  config.capacity.max_state_dim = 1000;
  config.capacity.max_observations = 100;
  config.motion.coast_s = 10;
  config.first_depth.depth = 2;
  config.plane.enabled = planes;
  return config;
}

bool Tape::write(const Frame& frame) {
  return write(frame.t_ns) && write(frame.dv_C) && write(frame.dw_C) && write(frame.observations) &&
         write(frame.decisions) && write(frame.tracked) && write(frame.offered) && write(frame.inliers) &&
         write(frame.features) && write(frame.state_dim) && write(frame.pose);
}

bool Tape::read(Frame& frame) {
  return read(frame.t_ns) && read(frame.dv_C) && read(frame.dw_C) && read(frame.observations) &&
         read(frame.decisions) && read(frame.tracked) && read(frame.offered) && read(frame.inliers) &&
         read(frame.features) && read(frame.state_dim) && read(frame.pose);
}

std::vector<pf_feature_t> map_of(const pf_slam_t* slam) {
  std::vector<pf_feature_t> features(1000);
  std::size_t count = 0;
  pf_get_features(slam, features.data(), features.size(), &count);
  features.resize(std::min(count, features.size()));
  return features;
}

}  // namespace replay
