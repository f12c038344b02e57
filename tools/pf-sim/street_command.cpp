#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>

#include "../lib/command_line.h"
#include "backend_option.h"
#include "commands.h"
#include "motion_option.h"
#include "report.h"
#include "statistics.h"
#include "street_run.h"

namespace pfsim {
namespace {

using nlohmann::json;

struct Case {
  const char* name;
  StreetPlan plan;
  bool planes;  ///< are looked for
};

const std::vector<std::string> kDefaultCases = {"refined", "exact", "points"};
constexpr double kDepth = 5;    // of the fronts, roughly: what a point without a wall begins with [m]
constexpr int kStateDim = 500;  // rows of the filter, where none are asked for
const Case kCases[] = {{"refined", StreetPlan::kRefined, true},
                       {"exact", StreetPlan::kExact, true},
                       {"points", StreetPlan::kNone, true},
                       {"plain", StreetPlan::kNone, false}};

struct Choices {
  BackendOption backend;
  MotionOption motion;
  std::vector<std::string> cases;  ///< none: all that the back end can do of kDefaultCases
  int seeds = 5, jobs = 1, patches = 16, cameras = 8, max_state_dim = 0, max_features = 0;
  std::uint64_t first_seed = 1;
  bool no_points = false;
  StreetOptions street;
  std::string json_file, csv;
};

struct Job {
  const Choices* choices;
  std::vector<Case> cases;
  StreetSummary* summaries;
  FrameRow* rows;
};

int fail(const std::string& what) {
  std::fprintf(stderr, "pf-sim street: %s\n", what.c_str());
  return 2;
}

/// What the window has not of what is asked for; empty: nothing.
std::string refused_by_window(const Choices& c) {
  if (c.no_points) return "--no-points measures patches on walls, which the window has not";
  if (c.max_state_dim > 0) return "--max-state-dim sizes a filter; the room of the window is --max-features";
  return "";
}

/// Patches on the walls beside points, or alone. Without walls there are points alone.
pf_config_t config_of(const Choices& c, const Case& of) {
  pf_config_t config;
  pf_config_default(&config);
  const double f = 601.8;
  config.camera = {PF_CAMERA_PINHOLE,  640, 480, f, f, 319.5, 239.5, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,   0,   0, {}};
  config.first_depth.depth = kDepth;
  config.capacity.max_state_dim = c.max_state_dim > 0 ? c.max_state_dim : kStateDim;
  config.capacity.max_features = std::max(config.capacity.max_features, config.capacity.max_state_dim / 3);
  c.backend.apply(config, c.max_features);
  c.motion.apply(config);
  config.plane.enabled = of.planes;
  if (of.plan == StreetPlan::kNone) return config;
  config.capacity.max_patches = c.patches;
  config.capacity.max_cameras = c.cameras;
  if (c.no_points) config.map.features_in_view = 0;
  return config;
}

/// One seed's frames, for all plans.
void run_one_seed(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  std::vector<StreetVariant> variants;
  std::vector<StreetSummary*> summaries;
  std::vector<FrameRow*> rows;
  for (std::size_t k = 0; k < job.cases.size(); ++k) {
    const std::size_t run = k * static_cast<std::size_t>(job.choices->seeds) + static_cast<std::size_t>(index);
    variants.push_back({config_of(*job.choices, job.cases[k]), job.cases[k].plan});
    summaries.push_back(job.summaries + run);
    rows.push_back(job.rows + run * static_cast<std::size_t>(job.choices->street.frames));
  }
  run_street(job.choices->street, variants, job.choices->first_seed + static_cast<std::uint64_t>(index), summaries,
             rows);
}

json summarise_case(const Runs& runs, const StreetSummary* summaries) {
  json out = summarise_frames(runs);
  std::vector<double> end, share, sigmas;
  int lost = 0, lost_runs = 0, tracked = 0, walls = 0, doubted = 0, doubted_ever = 0;
  double plan_deg = 0, plan_m = 0, end_deg = 0, end_m = 0, nees = 0, patches = 0;
  int on_fronts = 0, off_fronts = 0, on_found = 0, off_found = 0;
  for (const StreetSummary* r = summaries; r != summaries + runs.seeds; ++r) {
    end.push_back(r->end_m >= 0 ? r->end_m : INFINITY);
    share.push_back(end.back() / std::max(r->path_m, 1e-9));
    sigmas.push_back(r->end_m >= 0 ? r->end_m / r->end_sigma_m : INFINITY);
    lost += r->lost_frames;
    lost_runs += r->lost_frames > 0;
    tracked += r->tracked_frames;
    walls += r->walls;
    doubted += r->doubted;
    doubted_ever += r->doubted_ever;
    plan_deg += r->plan_deg;
    plan_m += r->plan_m;
    end_deg += r->end_deg;
    end_m += r->wall_end_m;
    nees += r->wall_nees;
    patches += r->patches;
    on_fronts += r->on_fronts;
    off_fronts += r->off_fronts;
    on_found += r->on_found;
    off_found += r->off_found;
  }
  const double frames = static_cast<double>(runs.seeds) * runs.frames, seen = std::max(1, walls);
  out["rmse_m"] = of_seeds(rmse_of(runs));
  out["end_error_m"] = of_seeds(end);
  out["end_error_of_path"] = of_seeds(share);
  out["end_error_in_sigmas"] = of_seeds(sigmas);
  out["lost"] = {{"frames", lost}, {"runs", lost_runs}};
  out["tracked_share"] = tracked / frames;
  out["patches"] = patches / frames;
  out["patch_surfaces"] = {
      {"on_fronts", on_fronts}, {"off_fronts", off_fronts}, {"on_found", on_found}, {"off_found", off_found}};
  out["walls"] = {{"count", walls},
                  {"doubted", doubted},
                  {"doubted_ever", doubted_ever},
                  {"plan_angle_deg", plan_deg / seen},
                  {"plan_offset_m", plan_m / seen},
                  {"angle_deg", end_deg / seen},
                  {"offset_m", end_m / seen},
                  {"nees", nees / seen}};
  return out;
}

void print_case(const char* name, const json& j) {
  const auto number = [&](const char* path) {
    const json& value = j.at(json::json_pointer(path));
    return value.is_number() ? value.get<double>() : NAN;
  };
  std::printf(
      "%s: camera RMSE %.3f m in the median seed, %.3f in the worst; end error %.3f, %.3f m (%.2f, %.2f %% of the "
      "path; %.1f, %.1f sigma)\n",
      name, number("/rmse_m/median"), number("/rmse_m/worst"), number("/end_error_m/median"),
      number("/end_error_m/worst"), 100 * number("/end_error_of_path/median"), 100 * number("/end_error_of_path/worst"),
      number("/end_error_in_sigmas/median"), number("/end_error_in_sigmas/worst"));
  std::printf(
      "  %.1f %% tracked, %g frames lost in %g runs; pose NEES %.1f (6 dof), state %g, %.1f patches in a frame\n",
      100 * number("/tracked_share"), number("/lost/frames"), number("/lost/runs"), number("/nees_pose/mean"),
      number("/state_dim/median"), number("/patches"));
  if (number("/patch_surfaces/on_fronts") + number("/patch_surfaces/on_found") > 0)
    std::printf("  patches in every tenth frame: %g on fronts, %g of them off; %g on planes that were found, %g off\n",
                number("/patch_surfaces/on_fronts"), number("/patch_surfaces/off_fronts"),
                number("/patch_surfaces/on_found"), number("/patch_surfaces/off_found"));
  if (number("/walls/count") > 0)
    std::printf(
        "  fronts that were seen: %g, %.2f deg, %.3f m in the plan; %.2f deg, %.3f m at the end, NEES %.1f (3 dof); %g "
        "rejected, %g at any time\n",
        number("/walls/count"), number("/walls/plan_angle_deg"), number("/walls/plan_offset_m"),
        number("/walls/angle_deg"), number("/walls/offset_m"), number("/walls/nees"), number("/walls/doubted"),
        number("/walls/doubted_ever"));
}

int run(Choices c) {
  const std::string refused = c.backend.is_window() ? refused_by_window(c) : "";
  if (!refused.empty()) return fail("--backend window: " + refused);
  if (c.cases.empty()) c.cases = c.backend.is_window() ? std::vector<std::string>{"points"} : kDefaultCases;
  if (c.seeds < 1 || c.seeds > 10000 || c.jobs < 1 || c.street.frames < 1 || c.street.frames > 100000)
    return fail("--seeds, --jobs and --frames must be positive");
  if (!(c.street.rate_hz > 0 && c.street.rate_hz <= 1000))
    return fail("--rate must be above 0 and at most 1000 frames a second");
  Job job{&c, {}, nullptr, nullptr};
  for (const std::string& name : c.cases) {
    const auto* found =
        std::find_if(std::begin(kCases), std::end(kCases), [&](const Case& x) { return name == x.name; });
    if (found == std::end(kCases)) return fail("no case " + name + "; they are refined exact points plain");
    job.cases.push_back(*found);
  }
  const char* field = nullptr;
  const pf_config_t config = config_of(c, job.cases.front());
  if (pf_config_check(&config, &field) != PF_OK) return fail(std::string("option out of range: ") + field);
  const auto seeds = static_cast<std::size_t>(c.seeds), frames = static_cast<std::size_t>(c.street.frames);
  const std::size_t count = seeds * job.cases.size();
  job.summaries = static_cast<StreetSummary*>(shared_memory(count * sizeof(StreetSummary)));
  job.rows = static_cast<FrameRow*>(shared_memory(count * frames * sizeof(FrameRow)));
  if (!job.summaries || !job.rows) return fail("no memory");
  if (!in_processes(c.seeds, c.jobs, "street", run_one_seed, &job)) return fail("a run did not come to its end");
  json out = {{"experiment", "street"},
              {"settings",
               {{"backend", c.backend.name},
                {"points", !c.no_points},
                {"motion", c.motion.name},
                {"first_seed", c.first_seed},
                {"frames", c.street.frames},
                {"rate_hz", c.street.rate_hz},
                {"max_state_dim", config.capacity.max_state_dim},
                {"max_features", config.capacity.max_features},
                {"sigma_rotation_deg", c.street.sigma_rotation_deg},
                {"sigma_offset_m", c.street.sigma_offset}}}};
  for (std::size_t k = 0; k < job.cases.size(); ++k) {
    const Runs runs{c.seeds, c.street.frames, c.first_seed, job.rows + k * seeds * frames};
    json& numbers = out["cases"][c.cases[k]] = summarise_case(runs, job.summaries + k * seeds);
    print_case(c.cases[k].c_str(), numbers);
    if (!c.csv.empty() && !write_csv(runs, c.csv, "street_" + c.cases[k])) return fail("cannot write to " + c.csv);
  }
  if (!c.json_file.empty() && !write_json(c.json_file, out)) return fail("cannot write " + c.json_file);
  return 0;
}

}  // namespace

void add_street(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand("street", "A walk of 72 m along fronts that a coarse plan knows");
  c->backend.add_to(*command);
  c->motion.add_to(*command);
  command->add_flag("--no-points", c->no_points, "patches on the fronts alone, without points");
  command->add_option("--patches", c->patches, "that are followed at a time, at most");
  command->add_option("--cameras", c->cameras, "reference cameras of patches, at most");
  command->add_option("--max-state-dim", c->max_state_dim, "rows of the covariance (default 500)");
  command->add_option("--max-features", c->max_features,
                      "points of the map (0: a third of the rows, and at least 100)");
  command->add_option("--cases", c->cases, "one or more: refined, exact, points, plain (points without planes)");
  command->add_option("--seeds", c->seeds, "how many runs of each case");
  command->add_option("--first-seed", c->first_seed, "seed of the first run");
  command->add_option("--frames", c->street.frames, "of each run");
  command->add_option("--rate", c->street.rate_hz, "frames per second");
  command->add_option("--angle", c->street.sigma_rotation_deg,
                      "of the plan's fronts about the vertical: standard deviation [deg]");
  command->add_option("--offset", c->street.sigma_offset, "of the plan's fronts: standard deviation [m]");
  command->add_option("--jobs", c->jobs, "processes at a time");
  command->add_option("--json", c->json_file, "report to write")->check(pf::tools::writable_file());
  command->add_option("--csv", c->csv, "folder for per-frame tables")->check(pf::tools::writable_folder());
  command->callback([c, &result] { result = run(*c); });
}

}  // namespace pfsim
