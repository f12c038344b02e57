// pf-sim kidnap: the library on real frames that end, go black, are another place's, or come in random order.

#include <cstdio>
#include <memory>

#include "../lib/command_line.h"
#include "backend_option.h"
#include "commands.h"
#include "kidnap_report.h"
#include "kidnap_run.h"
#include "report.h"

namespace pfsim {
namespace {

using nlohmann::json;

struct Choices {
  BackendOption backend;
  pf::tools::CalibrationOptions calibration;
  std::string source, start = "auto", lens = "estimate", json_file;
  int every = 8, jobs = 2, random_frames = 700, random_runs = 4;
  std::uint64_t seed = 1;
};

struct Job {
  const Film* film;
  const KidnapOptions* options;
  const Reference* reference;
  Context* context;
  Trial* trials;
  Survival* survivals;
  RandomOrder* random;
};

int fail(const std::string& what, int code = 2) {
  std::fprintf(stderr, "pf-sim kidnap: %s\n", what.c_str());
  return code;
}

void run_one(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  const int starts = static_cast<int>(job.reference->starts.size());
  if (index < starts) {
    play_trials(*job.film, *job.options, *job.reference, index, *job.context,
                job.trials + static_cast<std::size_t>(index) * gap_cases().size(), job.survivals + index);
    return;
  }
  const int run = index - starts;
  job.random[run] = play_random(*job.film, *job.options, *job.reference, run * starts / job.options->random_runs,
                                job.options->seed + static_cast<std::uint64_t>(run), *job.context);
}

int run(const Choices& c) {
  if (c.every < 1 || c.jobs < 1 || c.random_frames < 0 || c.random_runs < 0)
    return fail("--every and --jobs must be positive, --random-frames and --random-runs must not be negative");
  KidnapOptions options;
  options.every = c.every;
  options.random_frames = c.random_frames;
  options.random_runs = c.random_runs;
  options.seed = c.seed;
  Film film;
  std::string error;
  if (!read_start(c.start, &options.has_target, &options.target, &error)) return fail(error);
  if (!film.open(c.source, c.calibration, &error)) return fail(error, 1);
  if (!config_for(film, &options.config, &error)) return fail(error);
  c.backend.apply(options.config);
  options.config.camera.estimate = c.lens == "estimate" ? PF_CAMERA_ESTIMATE : PF_CAMERA_EXACT;
  Context context(options.config);
  Reference reference;
  if (!context.slam || !play_reference(film, options, context, &reference))
    return fail("the target has more points than the map has room for, or there is no memory");
  int tracked = 0, truths = 0;
  for (const Reference::Frame& frame : reference.frames) {
    tracked += frame.tracked;
    truths += frame.is_truth;
  }
  std::printf("%s: %d frames, %d of them tracked without a gap, %d well enough to judge by; gaps at %zu of them\n",
              c.source.c_str(), film.frames(), tracked, truths, reference.starts.size());

  const std::size_t starts = reference.starts.size();
  const std::size_t random_runs = starts > 0 ? static_cast<std::size_t>(options.random_runs) : 0;
  Job job{&film, &options, &reference, &context, nullptr, nullptr, nullptr};
  job.trials = static_cast<Trial*>(shared_memory((starts * gap_cases().size() + 1) * sizeof(Trial)));
  job.survivals = static_cast<Survival*>(shared_memory((starts + 1) * sizeof(Survival)));
  job.random = static_cast<RandomOrder*>(shared_memory((random_runs + 1) * sizeof(RandomOrder)));
  if (!job.trials || !job.survivals || !job.random) return fail("no memory", 1);
  for (std::size_t t = 0; t < starts * gap_cases().size(); ++t) job.trials[t] = Trial();
  if (!in_processes(static_cast<int>(starts + random_runs), c.jobs, "kidnap", run_one, &job))
    return fail("a run did not come to its end", 1);
  json out = summarise_kidnap({film, options, reference, job.trials, job.survivals, job.random});
  out["experiment"] = "kidnap";
  out["settings"] = {{"source", c.source},        {"start", c.start}, {"lens", c.lens},
                     {"backend", c.backend.name}, {"every", c.every}, {"seed", c.seed}};
  out["reference"] = {{"frames", film.frames()}, {"tracked", tracked}, {"judged_by", truths}, {"starts", starts}};
  if (!c.json_file.empty() && !write_json(c.json_file, out)) return fail("cannot write " + c.json_file, 1);
  return 0;
}

}  // namespace

void add_kidnap(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand(
      "kidnap", "Black pictures, other places and random order on real frames: which poses are accepted after them");
  command->add_option("--source", c->source, "images:DIR, euroc:DIR or tum:DIR")->required();
  c->calibration.add_to(*command);
  c->backend.add_to(*command);
  command->add_option("--start", c->start, "auto or target:FILE");
  command->add_option("--lens", c->lens, "exact, or estimate as pf-capture does by default")
      ->check(CLI::IsMember({"exact", "estimate"}))
      ->capture_default_str();
  command->add_option("--every", c->every, "frames between the frames at which trials begin");
  command->add_option("--random-frames", c->random_frames, "of each run in random order");
  command->add_option("--random-runs", c->random_runs, "runs in random order");
  command->add_option("--seed", c->seed, "of the random order");
  command->add_option("--jobs", c->jobs, "processes at a time");
  command->add_option("--json", c->json_file, "report to write")->check(pf::tools::writable_file());
  command->callback([c, &result] { result = run(*c); });
}

}  // namespace pfsim
