#include <algorithm>
#include <chrono>
#include <cmath>
#include <unordered_map>

#include "context.h"
#include "record.h"
#include "session.h"
#include "sim/random.h"
#include "sim/trajectory.h"

namespace replay {
namespace {

using pf::sim::Vec3;

double sigma_of(const double* covariance, int size, int i) { return std::sqrt(covariance[(size + 1) * i]); }

void compare_sigma(double recorded, double here, double* worst) {
  const double difference = std::fabs(here / recorded - 1);
  if (!(difference <= *worst)) *worst = difference;
}

void compare(const pf_pose_t& recorded, const pf_pose_t& here, Distance* d) {
  const Vec3 turn =
      pf::sim::rotation_log(pf::sim::rotation_of(recorded.q_WC) * pf::sim::rotation_of(here.q_WC).transposed());
  const double theta[3] = {turn.x, turn.y, turn.z};
  for (int i = 0; i < 3; ++i) {
    d->rotation = std::max(d->rotation, std::fabs(theta[i]) / sigma_of(recorded.covariance, 6, i));
    d->position =
        std::max(d->position, std::fabs(here.p_WC[i] - recorded.p_WC[i]) / sigma_of(recorded.covariance, 6, i + 3));
  }
  for (int i = 0; i < 6; ++i) {
    compare_sigma(sigma_of(recorded.covariance, 6, i), sigma_of(here.covariance, 6, i), &d->sigma);
  }
}

void compare(const std::vector<pf_feature_t>& recorded, const std::vector<pf_feature_t>& here, Distance* d) {
  for (const pf_feature_t& a : recorded) {
    for (const pf_feature_t& b : here) {
      if (a.external_id != b.external_id) continue;
      d->other_kind += a.kind != b.kind;
      if (a.kind != b.kind || a.kind == PF_FEATURE_INVERSE_DEPTH) continue;
      ++d->map_points;
      d->folded += a.kind == PF_FEATURE_FOLDED || a.kind == PF_FEATURE_FIXED;
      for (int i = 0; i < 3; ++i) {
        d->map_position = std::max(d->map_position, std::fabs(a.p_W[i] - b.p_W[i]) / sigma_of(a.covariance, 3, i));
        compare_sigma(sigma_of(a.covariance, 3, i), sigma_of(b.covariance, 3, i), &d->map_sigma);
      }
    }
  }
}

/// Which decisions about features the two runs have taken by now.
class Decisions {
 public:
  void compare(const Frame& recorded, const std::vector<pf_feature_t>& here, Distance* d) {
    for (const Decision& decision : recorded.decisions) kind_[decision.external_id] = decision.kind;
    for (const pf_feature_t& f : here) {
      const auto known = kind_.find(f.external_id);
      if (known == kind_.end()) continue;
      const bool open = known->second == PF_FEATURE_INVERSE_DEPTH;
      ++(open ? d->open_depths : d->places);
      if (open != (f.kind == PF_FEATURE_INVERSE_DEPTH))
        ++d->converted_apart;
      else if (known->second != f.kind)
        ++d->folded_apart;
    }
  }

 private:
  std::unordered_map<std::uint32_t, std::int32_t> kind_;
};

/// Counts a frame whose state has another number of rows. run: of such frames before this one.
void compare_state(bool other, int* run, Distance* d) {
  *run = other ? *run + 1 : 0;
  d->other_state += other;
  d->longest_other = std::max(d->longest_other, *run);
  d->other_end = other;
}

}  // namespace

bool follow(const std::string& file, double sigma_px, Distance* d) {
  Tape tape(file, false);
  int frames = 0;
  std::uint64_t seed = 0;
  bool planes = false;
  if (!tape.ok() || !tape.read(frames) || !tape.read(seed) || !tape.read(planes)) return false;
  const pfsim::BedOptions options = session_bed(frames);
  const pf_config_t config = session_config(options, planes);
  pfsim::Bed bed(options, config, seed);  // for the start and the truth alone
  const pfsim::Context context(config);
  pf_slam_t* slam = context.slam;
  if (slam == nullptr || pf_start_from_target(slam, &bed.target()) != PF_OK ||
      pf_start_from_pose(slam, &bed.start(), bed.velocity_covariance()) != PF_OK) {
    return false;
  }
  Frame frame;
  Decisions decisions;
  pf::sim::Random noise(seed);
  double us = 0;
  int run = 0;
  for (int i = 0; i < frames; ++i) {
    if (!tape.read(frame)) return false;
    if (i > 0) {
      pf_push_control(slam, frame.dv_C, frame.dw_C);
      bed.move(i, frame.dv_C, frame.dw_C);
    }
    for (pf_observation_t& o : frame.observations)
      for (double& coordinate : o.pixel) coordinate += sigma_px * noise.normal();
    const auto begin = std::chrono::steady_clock::now();
    const pf_status_t status =
        pf_push_observations(slam, frame.t_ns, frame.observations.data(), frame.observations.size());
    us += std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
    pf_report_t report;
    pf_pose_t pose;
    if (pf_get_report(slam, &report) != PF_OK || pf_get_pose(slam, &pose) != PF_OK) {
      ++d->starts_again;
      break;
    }
    ++d->frames;
    d->tracked += status == PF_OK;
    d->not_tracked += frame.tracked != 0 && status != PF_OK;
    d->offered += frame.offered;
    d->refused += frame.offered - static_cast<long>(frame.observations.size());
    d->refused_again += std::max(0, frame.inliers - report.inliers);
    d->other_map += report.features != frame.features;
    compare_state(report.state_dim != frame.state_dim, &run, d);
    decisions.compare(frame, map_of(slam), d);
    compare(frame.pose, pose, d);
    d->recorded.add(bed.truth().pose, frame.pose);
    d->here.add(bed.truth().pose, pose);
    if (i % 1000 == 999) {
      std::fprintf(stderr, "\r%d of %d frames: %.3f sigma, sigma off by %.2f %%, %ld refused", i + 1, frames,
                   std::max(d->position, d->rotation), 100 * d->sigma, d->refused_again);
    }
  }
  std::fprintf(stderr, "\n");
  d->us_per_frame = us / std::max(1, d->frames);
  std::vector<pf_feature_t> map;
  if (d->frames == frames && !tape.read(map)) return false;
  const std::vector<pf_feature_t> map_here = map_of(slam);
  compare(map, map_here, d);
  d->recorded.add(bed.points(), map);
  d->here.add(bed.points(), map_here);
  return true;
}

}  // namespace replay
