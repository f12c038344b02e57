#include <planefold/planefold_research.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <iterator>
#include <memory>

#include "../lib/command_line.h"
#include "backend_option.h"
#include "box_run.h"
#include "commands.h"
#include "motion_option.h"
#include "report.h"
#include "statistics.h"

namespace pfsim {
namespace {

using nlohmann::json;

struct Case {
  const char* name;
  Plan plan;
};

const std::vector<std::string> kDefaultCases = {"refined", "exact", "points"};
constexpr double kGoodDeg = 2;  // of a wall that was discovered
constexpr double kDepth =
    1.6;  // of the sides when they are first seen, roughly: what a point without a wall begins with [m]

const Case kCases[] = {{"refined", Plan::kRefined}, {"exact", Plan::kExact},   {"points", Plan::kNone},
                       {"ungated", Plan::kUngated}, {"absent", Plan::kAbsent}, {"shifted", Plan::kShifted},
                       {"missing", Plan::kMissing}, {"half", Plan::kHalf}};

struct Choices {
  BackendOption backend;
  MotionOption motion;
  std::vector<std::string> cases;  ///< none: all that the back end can do of kDefaultCases
  int seeds = 10;
  std::uint64_t first_seed = 1;
  int jobs = 1;
  double sigma_px = 0.5, fov_deg = 56;
  bool geometric = false, no_points = false;
  int patches = 16, cameras = 8, patch_side_px = 100;
  BoxOptions box;
  std::string json_file, csv;
};

struct Job {
  const Choices* choices;
  pf_config_t config;
  std::vector<Plan> plans;
  BoxSummary* summaries;
  FrameRow* rows;
};

int fail(const std::string& what) {
  std::fprintf(stderr, "pf-sim box: %s\n", what.c_str());
  return 2;
}

pf_config_t rendered_config(const Choices& c, Plan plan);

std::int64_t clock_ns(void*) {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1000000000 + now.tv_nsec;
}

/// One seed's frames, for all plans.
void run_one_seed(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  std::vector<BoxVariant> variants;
  std::vector<BoxSummary*> summaries;
  std::vector<FrameRow*> rows;
  for (std::size_t k = 0; k < job.plans.size(); ++k) {
    const std::size_t run = k * static_cast<std::size_t>(job.choices->seeds) + static_cast<std::size_t>(index);
    variants.push_back({rendered_config(*job.choices, job.plans[k]), job.plans[k]});
    summaries.push_back(job.summaries + run);
    rows.push_back(job.rows + run * static_cast<std::size_t>(job.choices->box.frames));
  }
  run_rendered_box(job.choices->box, variants, job.choices->first_seed + static_cast<std::uint64_t>(index), summaries,
                   rows);
}

void run_one(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  const int seeds = job.choices->seeds;
  job.summaries[index] =
      run_box(job.choices->box, job.config, job.plans[static_cast<std::size_t>(index / seeds)],
              job.choices->first_seed + static_cast<std::uint64_t>(index % seeds),
              job.rows + static_cast<std::size_t>(index) * static_cast<std::size_t>(job.choices->box.frames));
}

pf_config_t config_of(const Choices& c) {
  pf_config_t config;
  pf_config_default(&config);
  const double f = 320 / std::tan(c.fov_deg * 3.14159265358979323846 / 360);
  config.camera = {PF_CAMERA_PINHOLE,  640, 480, f, f, 319.5, 239.5, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,   0,   0, {}};
  config.measurement.sigma_px = c.sigma_px;
  config.first_depth.depth = kDepth;
  config.capacity.max_features = kBoxSides * c.box.points_on_side;
  config.capacity.max_observations = std::min(200, config.capacity.max_features);
  config.capacity.max_state_dim = 60 + 6 * config.capacity.max_features;
  c.motion.apply(config);
  return config;
}

/// What the window has not of what is asked for; empty: nothing.
std::string refused_by_window(const Choices& c) {
  if (c.geometric) return "--geometric pushes points, and the window takes pictures alone";
  if (c.no_points) return "--no-points measures patches on walls, which the window has not";
  if (c.box.gross > 0) return "--gross moves patches on walls, which the window has not";
  for (const std::string& name : c.cases)
    if (name == "ungated") return "case ungated measures patches on walls, which the window has not";
  return "";
}

/// Patches on the walls beside points, or alone. Without walls there are points alone.
pf_config_t rendered_config(const Choices& c, Plan plan) {
  pf_config_t config;
  pf_config_default(&config);
  const double f = 320 / std::tan(c.fov_deg * 3.14159265358979323846 / 360);
  config.camera = {PF_CAMERA_PINHOLE,  640, 480, f, f, 319.5, 239.5, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,   0,   0, {}};
  config.first_depth.depth = kDepth;
  config.capacity.max_state_dim = 500;
  config.clock_ns = clock_ns;
  c.backend.apply(config);
  c.motion.apply(config);
  if (plan == Plan::kNone) return config;
  config.capacity.max_patches = c.patches;
  config.capacity.max_cameras = c.cameras;
  config.capacity.patch_side_px = c.patch_side_px;
  if (c.no_points) config.map.features_in_view = 0;
  if (plan == Plan::kUngated) {
    pf_research_t research;
    pf_research_default(&research);
    research.gate_patches = 0;
    pf_config_set_research(&config, &research);
  }
  return config;
}

json walls_json(const BoxSummary* summaries, int seeds) {
  double plan_deg = 0, plan_m = 0, end_deg = 0, end_m = 0, nees = 0, points = 0, worst_deg = 0;
  int count = 0, doubted = 0;
  for (int s = 0; s < seeds; ++s)
    for (int k = 0; k < summaries[s].walls; ++k, ++count) {
      const BoxSummary& r = summaries[s];
      plan_deg += r.plan_deg[k];
      plan_m += r.plan_m[k];
      end_deg += r.end_deg[k];
      end_m += r.end_m[k];
      worst_deg = std::max(worst_deg, r.end_deg[k]);
      nees += r.end_nees[k];
      points += r.points[k];
      doubted += k == 0 ? r.doubted : 0;
    }
  if (count == 0) return nullptr;
  return {{"count", count},
          {"plan_angle_deg", plan_deg / count},
          {"plan_offset_m", plan_m / count},
          {"angle_deg", end_deg / count},
          {"worst_angle_deg", worst_deg},
          {"offset_m", end_m / count},
          {"nees", nees / count},
          {"points", points / count},
          {"doubted", doubted}};
}

json of_sides(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  return {{"median", median(values)}, {"worst", *std::max_element(values.begin(), values.end())}};
}

/// Sides that the plan does not have.
json discovered_json(const BoxSummary* summaries, int seeds) {
  std::vector<double> deg, m;
  int missing = 0, good = 0;
  for (int s = 0; s < seeds; ++s)
    for (int k = 0; k < summaries[s].missing; ++k, ++missing) {
      if (summaries[s].found_deg[k] < 0) continue;
      deg.push_back(summaries[s].found_deg[k]);
      m.push_back(summaries[s].found_m[k]);
      good += summaries[s].found_deg[k] <= kGoodDeg;
    }
  if (missing == 0) return nullptr;
  return {{"missing", missing},
          {"found", deg.size()},
          {"within_2_deg", good},
          {"angle_deg", of_sides(deg)},
          {"offset_m", of_sides(m)}};
}

json summarise_case(const Runs& runs, const BoxSummary* summaries, Plan plan) {
  json out = summarise_frames(runs);
  std::vector<double> worst, seen, to_find;
  int dark = 0, tracked = 0, doubted = 0, most_points = 0, lost = 0, lost_runs = 0;
  double inliers = 0, outliers = 0, missed = 0, patch_s = 0;
  for (int s = 0; s < runs.seeds; ++s) {
    worst.push_back(summaries[s].worst_m);
    tracked += summaries[s].tracked_frames;
    dark += summaries[s].dark_frames;
    to_find.push_back(summaries[s].frames_to_find);
    doubted += summaries[s].wrong_seen_s >= 0;
    if (summaries[s].wrong_seen_s >= 0) seen.push_back(summaries[s].wrong_seen_s);
    lost += summaries[s].lost_frames;
    lost_runs += summaries[s].lost_frames > 0;
    inliers += summaries[s].patch_inliers;
    outliers += summaries[s].patch_outliers;
    missed += summaries[s].patch_missed;
    patch_s += summaries[s].patch_seconds;
    most_points = std::max(most_points, summaries[s].wrong_points);
  }
  out["rmse_m"] = of_seeds(rmse_of(runs));
  out["largest_error_m"] = of_seeds(worst);
  out["tracked_share"] = tracked / std::max(1.0, static_cast<double>(runs.seeds) * runs.frames - dark);
  if (dark > 0) out["dark"] = {{"frames", dark}, {"frames_to_find", of_seeds(to_find)}};
  out["discovered"] = discovered_json(summaries, runs.seeds);
  out["lost"] = {{"frames", lost}, {"runs", lost_runs}};
  const double frames = static_cast<double>(runs.seeds) * runs.frames;
  if (inliers + outliers + missed > 0)
    out["patches"] = {{"inliers", inliers / frames},
                      {"outliers", outliers / frames},
                      {"missed", missed / frames},
                      {"ms", 1e3 * patch_s / frames}};
  out["walls"] = walls_json(summaries, runs.seeds);
  if (Box::wrong_wall(plan) >= 0)
    out["wrong_wall"] = {{"doubted_runs", doubted},
                         {"seen_before_s", seen.empty() ? json() : of_seeds(seen)},
                         {"most_points", most_points}};
  return out;
}

void print_case(const char* name, const json& j) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  std::printf(
      "%s: camera RMSE %.2f cm in the median seed, %.2f in the worst; largest error %.2f, %.2f cm; %.1f %% tracked\n",
      name, 100 * number("/rmse_m/median"), 100 * number("/rmse_m/worst"), 100 * number("/largest_error_m/median"),
      100 * number("/largest_error_m/worst"), 100 * number("/tracked_share"));
  std::printf("  pose NEES %.2f (6 dof; bounds of the run average %.2f %.2f, inside %.1f %% of the frames), state %g\n",
              number("/nees_pose/mean"), number("/nees_pose/bound_low"), number("/nees_pose/bound_high"),
              100 * number("/nees_pose/inside_share"), number("/state_dim/median"));
  if (j.contains("patches"))
    std::printf("  patches: %.2f inliers, %.3f outliers, %.3f missed in a frame, %.2f ms; %g frames lost in %g runs\n",
                number("/patches/inliers"), number("/patches/outliers"), number("/patches/missed"),
                number("/patches/ms"), number("/lost/frames"), number("/lost/runs"));
  if (j.contains("dark"))
    std::printf("  dark: %g frames, tracked again after %g more in the median seed, %g in the worst\n",
                number("/dark/frames"), number("/dark/frames_to_find/median"), number("/dark/frames_to_find/worst"));
  if (!j["discovered"].is_null()) {
    std::printf("  sides that the plan does not have: %g of %g found, %g within 2 deg", number("/discovered/found"),
                number("/discovered/missing"), number("/discovered/within_2_deg"));
    if (number("/discovered/found") > 0)
      std::printf(" (median %.2f, worst %.2f deg; %.1f, %.1f mm)", number("/discovered/angle_deg/median"),
                  number("/discovered/angle_deg/worst"), 1e3 * number("/discovered/offset_m/median"),
                  1e3 * number("/discovered/offset_m/worst"));
    std::printf("\n");
  }
  if (!j["walls"].is_null())
    std::printf(
        "  walls: %.2f deg, %.1f mm in the plan; %.2f deg (worst %.2f), %.1f mm at the end, NEES %.1f (3 dof), %.1f "
        "points, %g rejected\n",
        number("/walls/plan_angle_deg"), 1e3 * number("/walls/plan_offset_m"), number("/walls/angle_deg"),
        number("/walls/worst_angle_deg"), 1e3 * number("/walls/offset_m"), number("/walls/nees"),
        number("/walls/points"), number("/walls/doubted"));
  if (!j.contains("wrong_wall")) return;
  std::printf("  the wrong wall: rejected in %g of %g runs", number("/wrong_wall/doubted_runs"), number("/runs"));
  if (!j["wrong_wall"]["seen_before_s"].is_null())
    std::printf(", after %.2f s of view (worst %.2f)", number("/wrong_wall/seen_before_s/median"),
                number("/wrong_wall/seen_before_s/worst"));
  std::printf("; it had at most %g points\n", number("/wrong_wall/most_points"));
}

int run(Choices c) {
  const std::string refused = c.backend.is_window() ? refused_by_window(c) : "";
  if (!refused.empty()) return fail("--backend window: " + refused);
  if (c.cases.empty()) c.cases = c.backend.is_window() ? std::vector<std::string>{"points"} : kDefaultCases;
  if (c.geometric && c.no_points) return fail("--no-points is for rendered frames: --geometric has nothing but points");
  if (c.box.black_s < 0 || c.box.black_from_s < 0) return fail("--black: from when on, and how long, in seconds");
  if (!(c.box.gross >= 0 && c.box.gross <= 1)) return fail("--gross: a share from 0 to 1");
  if (c.seeds < 1 || c.seeds > 10000 || c.jobs < 1 || c.box.frames < 1 || c.box.frames > 100000)
    return fail("--seeds, --jobs and --frames must be positive");
  if (!(c.box.rate_hz > 0 && c.box.rate_hz <= 1000))
    return fail("--rate must be above 0 and at most 1000 frames a second");
  Job job{&c, config_of(c), {}, nullptr, nullptr};
  for (const std::string& name : c.cases) {
    const auto* found =
        std::find_if(std::begin(kCases), std::end(kCases), [&](const Case& x) { return name == x.name; });
    if (found == std::end(kCases))
      return fail("no case " + name + "; they are refined exact points absent shifted missing half");
    job.plans.push_back(found->plan);
  }
  const char* field = nullptr;
  const pf_config_t config = c.geometric ? job.config : rendered_config(c, job.plans.front());
  if (pf_config_check(&config, &field) != PF_OK) return fail(std::string("option out of range: ") + field);
  const auto seeds = static_cast<std::size_t>(c.seeds), frames = static_cast<std::size_t>(c.box.frames);
  const std::size_t count = seeds * job.plans.size();
  job.summaries = static_cast<BoxSummary*>(shared_memory(count * sizeof(BoxSummary)));
  job.rows = static_cast<FrameRow*>(shared_memory(count * frames * sizeof(FrameRow)));
  if (!job.summaries || !job.rows) return fail("no memory");
  if (!in_processes(c.geometric ? static_cast<int>(count) : c.seeds, c.jobs, "box",
                    c.geometric ? run_one : run_one_seed, &job))
    return fail("a run did not come to its end");
  json out = {{"experiment", "box"},
              {"settings",
               {{"backend", c.backend.name},
                {"geometric", c.geometric},
                {"points", !c.no_points},
                {"motion", c.motion.name},
                {"first_seed", c.first_seed},
                {"frames", c.box.frames},
                {"points_on_side", c.box.points_on_side},
                {"max_angle_deg", c.box.max_angle_deg},
                {"sigma_offset_m", c.box.sigma_offset},
                {"sigma_px", c.sigma_px},
                {"fov_deg", c.fov_deg},
                {"rate_hz", c.box.rate_hz},
                {"black_s", c.box.black_s},
                {"gross", c.box.gross}}}};
  for (std::size_t k = 0; k < job.plans.size(); ++k) {
    const Runs runs{c.seeds, c.box.frames, c.first_seed, job.rows + k * seeds * frames};
    json& numbers = out["cases"][c.cases[k]] = summarise_case(runs, job.summaries + k * seeds, job.plans[k]);
    print_case(c.cases[k].c_str(), numbers);
    if (!c.csv.empty() && !write_csv(runs, c.csv, "box_" + c.cases[k])) return fail("cannot write to " + c.csv);
  }
  if (!c.json_file.empty() && !write_json(c.json_file, out)) return fail("cannot write " + c.json_file);
  return 0;
}

}  // namespace

void add_box(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand("box", "A box with posters and a wrong plan of its sides, circled by hand");
  c->backend.add_to(*command);
  c->motion.add_to(*command);
  command->add_flag("--geometric", c->geometric, "points of the posters and no pictures");
  command->add_flag("--no-points", c->no_points, "patches on the walls alone, without points");
  command->add_option("--patches", c->patches, "that are followed at a time, at most");
  command->add_option("--cameras", c->cameras, "reference cameras of patches, at most");
  command->add_option("--patch-side", c->patch_side_px, "of a patch [px]");
  command->add_option("--black-from", c->box.black_from_s, "when black frames begin, of rendered ones [s]");
  command->add_option("--black", c->box.black_s, "for how long frames are black [s]");
  command->add_option("--gross", c->box.gross,
                      "share of patches that are moved in a rendered frame, so that they are found there");
  command->add_option("--cases", c->cases,
                      "one or more: refined, exact, ungated (exact, and every patch is taken in), points; absent, "
                      "shifted (a wrong wall), missing (without it) and half (two "
                      "walls of four)");
  command->add_option("--seeds", c->seeds, "how many runs of each case");
  command->add_option("--first-seed", c->first_seed, "seed of the first run");
  command->add_option("--frames", c->box.frames, "of each run");
  command->add_option("--rate", c->box.rate_hz, "frames per second");
  command->add_option("--loop", c->box.loop_seconds, "once around [s]");
  command->add_option("--points", c->box.points_on_side, "on each side");
  command->add_option("--angle", c->box.max_angle_deg, "of the plan's normals: largest error [deg]");
  command->add_option("--offset", c->box.sigma_offset, "of the plan's walls: standard deviation [m]");
  command->add_option("--sigma-px", c->sigma_px, "noise of a pixel");
  command->add_option("--fov", c->fov_deg, "horizontal, of a camera of 640 x 480 [deg]");
  command->add_option("--jobs", c->jobs, "processes at a time");
  command->add_option("--json", c->json_file, "report to write")->check(pf::tools::writable_file());
  command->add_option("--csv", c->csv, "folder for per-frame tables")->check(pf::tools::writable_folder());
  command->callback([c, &result] { result = run(*c); });
}

}  // namespace pfsim
