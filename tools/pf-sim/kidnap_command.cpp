// pf-sim kidnap: the library on real frames that end, go black, are another place's, or come in random order.

#include <algorithm>
#include <cstdio>
#include <memory>

#include "../lib/command_line.h"
#include "commands.h"
#include "kidnap_run.h"
#include "report.h"
#include "statistics.h"

namespace pfsim {
namespace {

using nlohmann::json;

constexpr int kManyInView = 20;  // old features that make a place one that can be found again
constexpr double kFoundWithin_s = 1;
constexpr double kFiveSigma = 5.733e-7;  // probability that a normal variable lies beyond five standard deviations
constexpr double kRounding = 1e-6;       // of a ratio of standard deviations

struct Choices {
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

const char* name_of(Return then) { return then == Return::kOn ? "on" : then == Return::kBack ? "back" : "elsewhere"; }

std::string label_of(const GapCase& c) {
  char text[64];
  std::snprintf(text, sizeof text, "%s_%gs_%s", c.picture == GapPicture::kBlack ? "black" : "elsewhere", c.seconds,
                name_of(c.then));
  return text;
}

json trial_report(const GapCase& gap, int frame, const Trial& t) {
  return {{"case", label_of(gap)},
          {"frame", frame},
          {"tracked_after_frames", t.tracked_after},
          {"worst_frame", t.worst_frame},
          {"worst_deg", t.worst_deg},
          {"worst_depths", t.worst_depths},
          {"worst_normalised", t.worst_normalised},
          {"least_covariance_growth", t.least_growth},
          {"least_against_prediction", t.least_taken_in}};
}

/// Counts over trials.
struct Tally {
  int trials = 0, tracking_again = 0, beyond = 0, wrong = 0, wrong_and_beyond = 0, shrinks = 0, taken_in = 0,
      in_view = 0, found = 0;
  double least_growth = 1, least_taken_in = 1;
  double old_ids = 0, kept_ids = 0;
  std::vector<double> delay_s;

  void add(const Trial& t, double interval_s) {
    static const double bound = chi_square_quantile(1 - kFiveSigma, 6);
    if (!t.done) return;
    ++trials;
    tracking_again += t.tracked_after >= 0;
    if (t.tracked_after >= 0) delay_s.push_back(t.tracked_after * interval_s);
    beyond += t.worst_normalised > bound;
    wrong += is_wrong(t.worst_deg, t.worst_depths);
    wrong_and_beyond += t.wrong_normalised > bound;
    shrinks += t.least_growth < 1 - kRounding;
    least_growth = std::min(least_growth, t.least_growth);
    taken_in += t.least_taken_in < 1 - kRounding;
    least_taken_in = std::min(least_taken_in, t.least_taken_in);
    old_ids += t.old_ids;
    kept_ids += t.kept_ids;
    if (t.old_in_view < kManyInView) return;
    ++in_view;
    found += t.tracked_after >= 0 && t.tracked_after * interval_s <= kFoundWithin_s;
  }

  json report() const {
    return {{"trials", trials},
            {"tracking_again", tracking_again},
            {"delay_s_median", delay_s.empty() ? json() : json(median(delay_s))},
            {"beyond_5_sigma", beyond},
            {"wrong", wrong},
            {"wrong_beyond_5_sigma", wrong_and_beyond},
            {"covariance_shrinks", shrinks},
            {"least_covariance_growth", least_growth},
            {"shrinks_below_prediction", taken_in},
            {"least_against_prediction", least_taken_in},
            {"ids_kept", old_ids > 0 ? kept_ids / old_ids : 1.0},
            {"many_in_view", in_view},
            {"found_within_1_s", found}};
  }
};

void print_row(const std::string& label, const json& j) {
  const auto number = [&](const char* name) { return j[name].is_null() ? -1.0 : j[name].get<double>(); };
  std::printf("%-20s %6.0f %8.0f %7.2f %8.0f %6.0f %6.0f %8.0f %6.3f %6.0f %6.1f %6.0f/%-5.0f\n", label.c_str(),
              number("trials"), number("tracking_again"), number("delay_s_median"), number("beyond_5_sigma"),
              number("wrong"), number("wrong_beyond_5_sigma"), number("covariance_shrinks"),
              number("least_covariance_growth"), number("shrinks_below_prediction"), 100 * number("ids_kept"),
              number("found_within_1_s"), number("many_in_view"));
}

json summarise(const Job& job) {
  const double interval_s = static_cast<double>(job.film->interval_ns()) * 1e-9;
  const std::vector<GapCase>& cases = gap_cases();
  const std::size_t starts = job.reference->starts.size();
  json out, doubtful = json::array();
  Tally all, second;
  std::printf("%-20s %6s %8s %7s %8s %6s %6s %8s %6s %6s %6s %12s\n", "gap", "trials", "tracking", "after s", "5 sigma",
              "wrong", "both", "shrinks", "least", "taken", "ids %", "found in 1 s");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    Tally tally;
    for (std::size_t s = 0; s < starts; ++s) {
      const Trial& trial = job.trials[s * cases.size() + c];
      tally.add(trial, interval_s);
      all.add(trial, interval_s);
      if (is_wrong(trial.worst_deg, trial.worst_depths) || trial.least_growth < 1 - kRounding)
        doubtful.push_back(trial_report(cases[c], job.reference->starts[s].frame, trial));
      if (cases[c].picture == GapPicture::kBlack && cases[c].seconds == 1.0) second.add(trial, interval_s);
    }
    const std::string label = label_of(cases[c]);
    out["cases"][label] = tally.report();
    print_row(label, out["cases"][label]);
  }
  out["all"] = all.report();
  out["wrong_or_shrinking"] = doubtful;
  print_row("all", out["all"]);
  out["after_a_black_second"] = {{"many_in_view", second.in_view}, {"found_within_1_s", second.found}};

  double old_ids = 0, kept_ids = 0;
  for (std::size_t s = 0; s < starts; ++s) {
    old_ids += job.survivals[s].old_ids;
    kept_ids += job.survivals[s].kept_ids;
  }
  out["ids_kept_without_pictures"] = old_ids > 0 ? kept_ids / old_ids : 1.0;
  int frames = 0, tracking = 0, in_map = 0, judged = 0, right = 0, turns = 0, turns_wrong = 0;
  for (int r = 0; r < job.options->random_runs && starts > 0; ++r) {
    frames += job.random[r].frames;
    tracking += job.random[r].tracking;
    in_map += job.random[r].in_map;
    judged += job.random[r].judged;
    right += job.random[r].right;
    turns += job.random[r].turns;
    turns_wrong += job.random[r].turns_wrong;
  }
  out["random_order"] = {{"frames", frames},
                         {"tracking", tracking},
                         {"in_the_old_map", in_map},
                         {"judged", judged},
                         {"right", right},
                         {"turns", turns},
                         {"turns_wrong", turns_wrong},
                         {"tracking_share", frames > 0 ? static_cast<double>(tracking) / frames : 0.0}};
  std::printf("after a black second with %d old features in view: %d of %d found within %g s\n", kManyInView,
              second.found, second.in_view, kFoundWithin_s);
  std::printf("ids kept over %g s without a picture: %.1f %%\n", job.options->survive_s,
              100 * out["ids_kept_without_pictures"].get<double>());
  std::printf(
      "random order: %d of %d frames tracking (%.2f %%), %d of them in the old map; %d of %d that can be judged are "
      "where they should be; %d of %d turns between two of them are wrong\n",
      tracking, frames, frames > 0 ? 100.0 * tracking / frames : 0.0, in_map, right, judged, turns_wrong, turns);
  return out;
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
  json out = summarise(job);
  out["experiment"] = "kidnap";
  out["settings"] = {{"source", c.source}, {"start", c.start}, {"lens", c.lens}, {"every", c.every}, {"seed", c.seed}};
  out["reference"] = {{"frames", film.frames()}, {"tracked", tracked}, {"judged_by", truths}, {"starts", starts}};
  if (!c.json_file.empty() && !write_json(c.json_file, out)) return fail("cannot write " + c.json_file, 1);
  return 0;
}

}  // namespace

void add_kidnap(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand(
      "kidnap", "Black pictures, other places and random order on real frames: what is believed after them");
  command->add_option("--source", c->source, "images:DIR, euroc:DIR or tum:DIR")->required();
  c->calibration.add_to(*command);
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
