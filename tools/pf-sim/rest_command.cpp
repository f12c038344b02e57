// pf-sim rest: the camera stops on real frames and stands still: the same picture with fresh noise. The pose should stay.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "../lib/command_line.h"
#include "commands.h"
#include "context.h"
#include "film.h"
#include "pose_difference.h"
#include "report.h"
#include "run.h"
#include "sim/random.h"
#include "statistics.h"

namespace pfsim {
namespace {

using nlohmann::json;

constexpr double kDegrees = 57.29577951308232;  // in a radian
constexpr std::uint64_t kNoiseStream = 41;
constexpr double kMaxSeconds = 86400;

struct Choices {
  pf::tools::CalibrationOptions calibration;
  std::string source, start = "auto", json_file;
  std::vector<int> at;
  double seconds = 60, noise = 2;
  int jobs = 2;
  std::uint64_t seed = 1;
};

/// One stop. Plain data, so that it may lie in memory shared between processes.
struct Stop {
  std::int32_t tracked = 0;                  ///< 1: the frame of the stop was tracked
  std::int32_t frames = 0, not_tracked = 0;  ///< at rest
  double sigma_deg = 0, sigma_m = 0;         ///< at the stop
  double worst_deg = 0, worst_m = 0;         ///< farthest from the pose at the stop
  double worst_sigmas = 0;                   ///< of rotation or position, in its sigma at the stop
  double worst_normalised = 0;               ///< e^T (P + P_stop)^-1 e of the pose, 6 dof
  double worst_step = 0;                     ///< likewise from one frame to the next, e^T P^-1 e with the P before
  double widest = 0;                         ///< largest sigma over that at the stop
};

struct Job {
  const Film* film;
  const Choices* choices;
  const pf_config_t* config;
  const pf_target_t* target;
  Stop* stops;
};

int fail(const std::string& what, int code = 2) {
  std::fprintf(stderr, "pf-sim rest: %s\n", what.c_str());
  return code;
}

/// Square root of the trace of a pose's covariance, of its rotation (first = 0) or position (3).
double sigma(const pf_pose_t& pose, int first) {
  double sum = 0;
  for (int i = first; i < first + 3; ++i) sum += pose.covariance[7 * i];
  return std::sqrt(sum);
}

void compare(const pf_pose_t& stop, const pf_pose_t& before, const pf_pose_t& now, Stop* out) {
  const PoseDifference drift = pose_difference(stop, now), step = pose_difference(before, now);
  double P[36];
  for (int i = 0; i < 36; ++i) P[i] = stop.covariance[i] + now.covariance[i];
  out->worst_deg = std::max(out->worst_deg, drift.rad * kDegrees);
  out->worst_m = std::max(out->worst_m, drift.m);
  out->worst_sigmas = std::max({out->worst_sigmas, drift.rad / sigma(stop, 0), drift.m / sigma(stop, 3)});
  out->worst_normalised = std::max(out->worst_normalised, normalised_error(drift.e, P, 6, 6, 0));
  out->worst_step = std::max(out->worst_step, normalised_error(step.e, before.covariance, 6, 6, 0));
  out->widest = std::max({out->widest, sigma(now, 0) / sigma(stop, 0), sigma(now, 3) / sigma(stop, 3)});
}

void run_one(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  const Film& film = *job.film;
  const int at = job.choices->at[static_cast<std::size_t>(index)];
  Stop* const out = job.stops + index;
  Context slam(*job.config);
  if (slam.slam == nullptr || (job.target != nullptr && pf_start_from_target(slam.slam, job.target) != PF_OK)) return;
  const pf_camera_t& camera = film.camera();
  pf_status_t status = PF_ERROR_STATE;
  for (int i = 0; i <= at; ++i) {
    const pf_image_t image = {film.pixels(i), camera.width, camera.height, camera.width, film.t_ns(i)};
    status = pf_push_frame(slam.slam, &image);
  }
  pf_pose_t stop, before;
  out->tracked = status == PF_OK && pf_get_pose(slam.slam, &stop) == PF_OK;
  if (out->tracked == 0) return;
  out->sigma_deg = sigma(stop, 0) * kDegrees;
  out->sigma_m = sigma(stop, 3);
  before = stop;

  pf::sim::Random random(job.choices->seed, kNoiseStream + static_cast<std::uint64_t>(at));
  const std::size_t size = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  std::vector<std::uint8_t> noisy(size);
  std::int64_t t_ns = film.t_ns(at);
  const double end_ns = job.choices->seconds * 1e9 + static_cast<double>(t_ns);
  while (static_cast<double>(t_ns) < end_ns) {
    t_ns += film.interval_ns();
    for (std::size_t k = 0; k < size; ++k) {
      const double value = film.pixels(at)[k] + job.choices->noise * random.normal();
      noisy[k] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    }
    const pf_image_t image = {noisy.data(), camera.width, camera.height, camera.width, t_ns};
    pf_pose_t now;
    ++out->frames;
    if (pf_push_frame(slam.slam, &image) != PF_OK || pf_get_pose(slam.slam, &now) != PF_OK ||
        now.map_id != stop.map_id) {
      ++out->not_tracked;
      continue;
    }
    compare(stop, before, now, out);
    before = now;
  }
}

json report_of(int at, const Stop& s) {
  return {{"frame", at},
          {"tracked", s.tracked != 0},
          {"frames_at_rest", s.frames},
          {"not_tracked", s.not_tracked},
          {"sigma_deg", s.sigma_deg},
          {"sigma_m", s.sigma_m},
          {"worst_deg", s.worst_deg},
          {"worst_m", s.worst_m},
          {"worst_sigmas", s.worst_sigmas},
          {"worst_normalised", s.worst_normalised},
          {"worst_step_normalised", s.worst_step},
          {"widest_sigma_ratio", s.widest}};
}

/// Three places, where no others were asked for: a quarter, a half and three quarters of the way.
std::vector<int> places(const Film& film) { return {film.frames() / 4, film.frames() / 2, 3 * film.frames() / 4}; }

int run(Choices c) {
  if (!(c.seconds > 0 && c.seconds <= kMaxSeconds) || !(c.noise >= 0 && c.noise <= 255) || c.jobs < 1)
    return fail("--seconds must be above 0 and at most 86400, --noise 0 to 255, --jobs positive");
  pf_target_t target;
  pf_config_t config;
  bool has_target = false;
  Film film;
  std::string error;
  if (!read_start(c.start, &has_target, &target, &error)) return fail(error);
  if (!film.open(c.source, c.calibration, &error) || !config_for(film, &config, &error)) return fail(error);
  if (c.at.empty()) c.at = places(film);
  for (const int frame : c.at)
    if (frame < 0 || frame >= film.frames())
      return fail("--at " + std::to_string(frame) + ": the source has frames 0 to " +
                  std::to_string(film.frames() - 1));

  Job job{&film, &c, &config, has_target ? &target : nullptr, nullptr};
  job.stops = static_cast<Stop*>(shared_memory(c.at.size() * sizeof(Stop)));
  if (!job.stops) return fail("no memory", 1);
  for (std::size_t i = 0; i < c.at.size(); ++i) job.stops[i] = Stop();
  if (!in_processes(static_cast<int>(c.at.size()), c.jobs, "rest", run_one, &job))
    return fail("a run did not come to its end", 1);

  json out = {
      {"experiment", "rest"},
      {"settings",
       {{"source", c.source}, {"start", c.start}, {"seconds", c.seconds}, {"noise", c.noise}, {"seed", c.seed}}}};
  std::printf("%s: at rest for %g s, noise of %g grey levels\n", c.source.c_str(), c.seconds, c.noise);
  std::printf("%6s %8s %12s %10s %10s %8s %10s %10s %8s\n", "frame", "frames", "not tracked", "worst deg", "worst m",
              "sigmas", "NEES of 6", "largest step", "widest");
  for (std::size_t i = 0; i < c.at.size(); ++i) {
    const Stop& s = job.stops[i];
    out["stops"].push_back(report_of(c.at[i], s));
    if (s.tracked == 0)
      std::printf("%6d is not tracked\n", c.at[i]);
    else
      std::printf("%6d %8d %12d %10.4f %10.5f %8.2f %10.2f %12.2f %8.3f\n", c.at[i], s.frames, s.not_tracked,
                  s.worst_deg, s.worst_m, s.worst_sigmas, s.worst_normalised, s.worst_step, s.widest);
  }
  if (!c.json_file.empty() && !write_json(c.json_file, out)) return fail("cannot write " + c.json_file, 1);
  return 0;
}

}  // namespace

void add_rest(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand(
      "rest", "The camera stops on real frames: the same picture with fresh noise, and how far the pose drifts");
  command->add_option("--source", c->source, "images:DIR, euroc:DIR or tum:DIR")->required();
  c->calibration.add_to(*command);
  command->add_option("--start", c->start, "auto or target:FILE");
  command->add_option("--at", c->at, "frames at which it stops, A,B,.. (default: three places)")->delimiter(',');
  command->add_option("--seconds", c->seconds, "at rest");
  command->add_option("--noise", c->noise, "standard deviation of the fresh noise [grey levels]");
  command->add_option("--seed", c->seed, "of the noise");
  command->add_option("--jobs", c->jobs, "processes at a time");
  command->add_option("--json", c->json_file, "report to write")->check(pf::tools::writable_file());
  command->callback([c, &result] { result = run(*c); });
}

}  // namespace pfsim
