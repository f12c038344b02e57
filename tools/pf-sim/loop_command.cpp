// pf-sim loop: once around a ring of corridors and on along its beginning, with places and without.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <vector>

#include "../lib/command_line.h"
#include "backend_option.h"
#include "commands.h"
#include "context.h"
#include "planefold_platform/sim.h"
#include "report.h"
#include "run.h"
#include "sim/scene_loop.h"
#include "statistics.h"

namespace pfsim {
namespace {

using nlohmann::json;

constexpr int kVariants = 2;  // without places, with them
constexpr int kJudged = 30;   // last frames of a run, whose median error is that after the return

struct Choices {
  BackendOption backend{"window"};
  int seeds = 5, jobs = 1, places = 16, frames = pf::sim::kLoopFrames;
  std::uint64_t first_seed = 1;
  std::string json_file;
};

/// One run. Plain data, so that it may lie in memory shared between processes.
struct LoopRun {
  std::int32_t done = 0, tracked = 0, lost = 0;
  std::int32_t returned = 0, return_frame = -1;  ///< places that came back to the window, and when the first one did
  double before_m = -1;                          ///< error just before the first came back; negative: there was none
  double end_m = -1, end_nees = -1;              ///< of the last frames, medians
  double worst_ms = 0, median_ms = 0;
};

struct Job {
  const Choices* choices;
  LoopRun* runs;
};

int fail(const std::string& what, int code = 2) {
  std::fprintf(stderr, "pf-sim loop: %s\n", what.c_str());
  return code;
}

/// One context on its way around.
class LoopRunner {
 public:
  LoopRunner(const Choices& c, const pf_sim_t* sim, int places) {
    pf_config_t config;
    pf_config_default(&config);
    pf_sim_camera(sim, &config.camera);
    c.backend.apply(config);
    config.capacity.max_places = places;
    context_ = std::make_unique<Context>(config);
    pf_target_t target;
    if (context_->slam && pf_sim_target(sim, PF_TARGET_RECTANGLE, &target) == PF_OK &&
        pf_start_from_target(context_->slam, &target) == PF_OK)
      run.done = 1;
  }

  void push(const pf_image_t& image, const pf_pose_t& truth, int frame) {
    const double begin = processor_seconds();
    const pf_status_t status = pf_push_frame(context_->slam, &image);
    ms_.push_back(1000 * (processor_seconds() - begin));
    run.tracked += status == PF_OK;
    run.lost += status == PF_NOTE_LOST;
    pf_pose_t pose;
    pf_report_t report;
    if (pf_get_pose(context_->slam, &pose) != PF_OK || pf_get_report(context_->slam, &report) != PF_OK) return;
    if (report.places_returned > 0 && run.returned == 0) {
      run.return_frame = frame;
      run.before_m = errors_.empty() ? -1 : errors_.back();
    }
    run.returned = report.places_returned;
    const FrameRow row =
        judge({pf::sim::rotation_of(truth.q_WC), {truth.p_WC[0], truth.p_WC[1], truth.p_WC[2]}}, pose, report);
    errors_.push_back(static_cast<double>(row.error_m));
    nees_.push_back(static_cast<double>(row.nees_position));
  }

  void finish() {
    const auto last = [](const std::vector<double>& all) {
      return std::vector<double>(all.end() - std::min<std::ptrdiff_t>(kJudged, std::distance(all.begin(), all.end())),
                                 all.end());
    };
    if (errors_.empty()) return;
    run.end_m = median(last(errors_));
    run.end_nees = median(last(nees_));
    run.median_ms = median(ms_);
    run.worst_ms = *std::max_element(ms_.begin(), ms_.end());
  }

  LoopRun run;

 private:
  static double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

  std::unique_ptr<Context> context_;
  std::vector<double> errors_, nees_, ms_;
};

/// One seed's frames, for both runs.
void run_one(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  const Choices& c = *job.choices;
  pf_sim_options_t options;
  pf_sim_options_default("loop", &options);
  options.seed = c.first_seed + static_cast<std::uint64_t>(index);
  options.frames = c.frames;
  const std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim(pf_sim_open("loop", &options), pf_sim_close);
  if (!sim) return;
  LoopRunner without(c, sim.get(), 0), with(c, sim.get(), c.places);
  if (without.run.done == 0 || with.run.done == 0) return;
  pf_image_t image;
  pf_pose_t truth;
  for (int frame = 0; pf_sim_next(sim.get(), &image, &truth); ++frame) {
    without.push(image, truth, frame);
    with.push(image, truth, frame);
  }
  without.finish();
  with.finish();
  job.runs[kVariants * index] = without.run;
  job.runs[kVariants * index + 1] = with.run;
}

json run_json(const LoopRun& r) {
  return {{"tracked", r.tracked},           {"lost", r.lost},           {"returned", r.returned},
          {"return_frame", r.return_frame}, {"before_m", r.before_m},   {"end_m", r.end_m},
          {"end_nees", r.end_nees},         {"median_ms", r.median_ms}, {"worst_ms", r.worst_ms}};
}

int run(const Choices& c) {
  if (c.seeds < 1 || c.seeds > 10000 || c.jobs < 1 || c.frames < 1 || c.frames > 100000)
    return fail("--seeds, --jobs and --frames must be positive");
  const std::size_t count = static_cast<std::size_t>(c.seeds) * kVariants;
  Job job{&c, static_cast<LoopRun*>(shared_memory(count * sizeof(LoopRun)))};
  if (!job.runs) return fail("no memory", 1);
  if (!in_processes(c.seeds, c.jobs, "loop", run_one, &job)) return fail("a run did not come to its end", 1);
  json each = json::array();
  std::vector<double> without, with, ratio;
  std::printf("  seed | without places: end m | with: before m  end m  NEES  places back (first)  lost | ratio\n");
  for (int s = 0; s < c.seeds; ++s) {
    const LoopRun &a = job.runs[kVariants * s], &b = job.runs[kVariants * s + 1];
    if (a.done == 0) return fail("there is no memory, or --max-places is out of range", 1);
    without.push_back(a.end_m);
    with.push_back(b.end_m);
    ratio.push_back(b.end_m / a.end_m);
    const auto seed = c.first_seed + static_cast<std::uint64_t>(s);
    std::printf("  %4d | %21.3f | %14.3f  %5.3f  %4.1f  %11d (%5d)  %4d | %5.2f\n", static_cast<int>(seed), a.end_m,
                b.before_m, b.end_m, b.end_nees, b.returned, b.return_frame, b.lost, ratio.back());
    each.push_back({{"seed", seed}, {"without", run_json(a)}, {"with", run_json(b)}});
  }
  std::printf("after %.1f m: %.3f m (%.3f) without places, %.3f (%.3f) with them; ratio %.2f (%.2f)\n",
              pf::sim::kLoopLength, median(without), *std::max_element(without.begin(), without.end()), median(with),
              *std::max_element(with.begin(), with.end()), median(ratio),
              *std::max_element(ratio.begin(), ratio.end()));
  const json out = {
      {"experiment", "loop"},
      {"settings",
       {{"backend", c.backend.name}, {"first_seed", c.first_seed}, {"places", c.places}, {"frames", c.frames}}},
      {"cases",
       {{"loop",
         {{"without_m", of_seeds(without)},
          {"with_m", of_seeds(with)},
          {"ratio", of_seeds(ratio)},
          {"each_run", each}}}}}};
  if (!c.json_file.empty() && !write_json(c.json_file, out)) return fail("cannot write " + c.json_file, 1);
  return 0;
}

}  // namespace

void add_loop(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand(
      "loop", "Once around a ring of corridors: the error when the camera is back, with places and without");
  c->backend.add_to(*command);
  command->add_option("--max-places", c->places, "of the run that has some")
      ->check(pf::capture::whole_number_in(1, 200));
  command->add_option("--seeds", c->seeds, "how many walks");
  command->add_option("--first-seed", c->first_seed, "seed of the first walk");
  command->add_option("--frames", c->frames, "of each walk");
  command->add_option("--jobs", c->jobs, "processes at a time");
  command->add_option("--json", c->json_file, "report to write")->check(pf::tools::writable_file());
  command->callback([c, &result] { result = run(*c); });
}

}  // namespace pfsim
