// pf-sim gee2007 --filter paper: the paper's experiment with the paper's own filter.

#include "command.h"

#include <planefold_platform/sequence.h>

#include <cstdio>
#include <filesystem>
#include <set>

#include "../report.h"
#include "paper_report.h"

namespace pfsim::gee {
namespace {

const char* const kGroup = "The paper's filter";
const std::set<std::string> kShared = {
    "--help", "--case",     "--seeds",           "--first-seed", "--frames", "--jobs", "--json",        "--csv",
    "--fov",  "--sigma-px", "--linearity-index", "--slant",      "--height", "--look", "--first-birth", "--filter"};

struct Job {
  WorldOptions world;
  SlamOptions slam;
  std::uint64_t first_seed;
  std::string figure;
  PaperRow* rows;
  PaperSummary* summaries;
};

void run_one(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  job.summaries[index] =
      run_paper(job.world, job.slam, job.first_seed + static_cast<std::uint64_t>(index), index == 0 ? job.figure : "",
                job.rows + static_cast<std::size_t>(index) * static_cast<std::size_t>(job.world.frames));
}

int fail(const std::string& what) {
  std::fprintf(stderr, "pf-sim: %s\n", what.c_str());
  return 1;
}

/// Of a command line that is wrong.
int refuse(const std::string& what) {
  fail(what);
  return 2;
}

nlohmann::json describe(const WorldOptions& w, const SlamOptions& s) {
  return {{"look", w.look_inward ? "inward" : "outward"},
          {"upright", w.upright},
          {"fov_deg", w.fov_deg},
          {"half_height_m", w.half_height},
          {"nearest_m", w.nearest},
          {"frames_per_loop", w.frames_per_loop},
          {"sigma_pixel", s.sigma_px},
          {"sigma_turn_rad", s.sigma_turn},
          {"sigma_step_m", s.sigma_step},
          {"rho", s.rho},
          {"sigma_rho", s.sigma_rho},
          {"linearity_index", s.linearity},
          {"first_birth", s.first_birth},
          {"hypotheses", s.discovery.hypotheses},
          {"d_T_m", s.discovery.d_T},
          {"d_max_m", s.discovery.d_max},
          {"l_T", s.discovery.l_T},
          {"lambda_T_m2", s.discovery.lambda_T}};
}

}  // namespace

std::shared_ptr<PaperChoices> add_paper_options(CLI::App* command) {
  auto p = std::make_shared<PaperChoices>();
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command->add_option(name, value, help)->group(kGroup);
  };
  command->add_option("--filter", p->filter, "paper: as it was published; library: the library's, with points only");
  add("--frames-per-loop", p->world.frames_per_loop, "of the circle")->capture_default_str();
  add("--nearest", p->world.nearest, "points nearer than this are not seen [m]")->capture_default_str();
  add("--clear-radius", p->world.clear_radius, "about the middle, without points that lie on no wall [m]")
      ->capture_default_str();
  add("--target-distance", p->world.target_distance, "of the known square [m]")->capture_default_str();
  add("--target-size", p->world.target_size, "its side [m]")->capture_default_str();
  add("--target-frames", p->world.target_frames, "after so many the known square is taken away; 0: it stays")
      ->capture_default_str();
  add("--sigma-turn", p->slam.sigma_turn, "of the random walk in one frame [rad]")->capture_default_str();
  add("--sigma-step", p->slam.sigma_step, "of its translation in one frame [m]")->capture_default_str();
  add("--rho", p->slam.rho, "prior of inverse depth [1/m]")->capture_default_str();
  add("--sigma-rho", p->slam.sigma_rho, "its standard deviation [1/m]")->capture_default_str();
  add("--hypotheses", p->slam.discovery.hypotheses, "of RANSAC in each frame")->capture_default_str();
  command->add_flag("--upright", p->world.upright, "the world's y is the vertical: the pole of eq. 5 in every wall")
      ->group(kGroup);
  return p;
}

std::string given_paper_option(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && option->get_group() == kGroup) return option->get_name();
  return "";
}

int run_paper_command(const CLI::App& command, const PaperChoices& paper, const SharedChoices& c) {
  if (paper.filter != "paper") return refuse("the filter is paper or library");
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && option->get_group() != kGroup && !kShared.count(option->get_name()))
      return refuse(option->get_name() + " is an option of --filter library");
  Job job{paper.world, paper.slam, c.first_seed, "", nullptr, nullptr};
  if (!c.look.empty() && c.look != "inward" && c.look != "outward") return refuse("the camera looks inward or outward");
  if (c.seeds < 1 || c.seeds > 10000 || c.jobs < 1 || c.frames < 0 || job.world.frames_per_loop < 1)
    return refuse("--seeds, --jobs and --frames must be positive");
  const bool noise = c.sigma_px > 0 && c.sigma_px <= 10, prior = job.slam.rho > 0 && job.slam.sigma_rho > 0;
  if (!noise) return refuse("--sigma-px must be above 0 and at most 10");
  if (!prior) return refuse("--rho and --sigma-rho must be above 0");
  if (c.fov > 150) return refuse("--fov is at most 150 degrees");
  if (job.slam.discovery.hypotheses < 1) return refuse("--hypotheses must be at least 1");
  if (!c.look.empty()) job.world.look_inward = c.look == "inward";
  job.world.frames = c.frames > 0 ? c.frames : 2 * job.world.frames_per_loop;
  job.world.sigma_px = job.slam.sigma_px = c.sigma_px;
  job.world.target_slant_deg = c.slant;
  if (c.fov > 0) job.world.fov_deg = c.fov;
  if (c.half_height > 0) job.world.half_height = c.half_height;
  if (c.linearity > 0) job.slam.linearity = c.linearity;
  job.slam.first_birth = c.first_birth;
  for (const char letter : c.cases)
    if (!choose_case(letter, &job.slam)) return refuse("there is no case " + c.cases + "; cases are A to F");

  if (!c.csv.empty()) {
    std::error_code error;
    std::filesystem::create_directories(c.csv, error);
    char message[PF_SEQUENCE_MESSAGE] = "";
    for (const char letter : c.cases)
      for (const char* end : {".csv", "_trajectory.csv", "_camera.csv", "_points.csv", "_planes.csv"})
        if (pf_add_output_file(c.csv.c_str(), (std::string("gee2007_") + letter + end).c_str(), message) != 0)
          return fail(message);
  }
  const auto seeds = static_cast<std::size_t>(c.seeds), frames = static_cast<std::size_t>(job.world.frames);
  nlohmann::json out;
  out["experiment"] = "gee2007";
  out["filter"] = "paper";
  out["settings"] = describe(job.world, job.slam);
  for (const char letter : c.cases) {
    choose_case(letter, &job.slam);
    const std::string label(1, letter);
    job.figure = c.csv.empty() ? "" : c.csv + "/gee2007_" + label;
    job.rows = static_cast<PaperRow*>(shared_memory(seeds * frames * sizeof(PaperRow)));
    job.summaries = static_cast<PaperSummary*>(shared_memory(seeds * sizeof(PaperSummary)));
    if (!job.rows || !job.summaries) return fail("no memory");
    if (!in_processes(c.seeds, c.jobs, ("gee2007 " + label).c_str(), run_one, &job))
      return fail("a run did not come to its end");
    const PaperRuns runs{c.seeds, job.world.frames, job.world.frames_per_loop, c.first_seed, job.rows, job.summaries};
    out["cases"][label] = summarise(runs);
    print("gee2007 " + label, out["cases"][label]);
    if (!c.csv.empty() && !write_figure2(runs, job.figure + ".csv")) return fail("cannot write to " + c.csv);
    if (!c.json.empty() && !write_json(c.json, out)) return fail("cannot write " + c.json);
  }
  return 0;
}

}  // namespace pfsim::gee
