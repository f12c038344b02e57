// pf-sim room, pf-sim gee2007: Monte Carlo runs of the filter against geometric truth, with perfect association.

#include <planefold/planefold_research.h>

#include <cstdio>
#include <memory>

#include "../lib/command_line.h"
#include "commands.h"
#include "gee2007/command.h"
#include "report.h"

namespace pfsim {
namespace {

struct Choices {
  std::string cases = "A", layout, motion = "velocity", look = "inward", json, csv;
  int seeds = 40, frames = 0, jobs = 2, gauge_every = 50, relative = 0;
  std::uint64_t first_seed = 1;
  bool plain = false;
  double fov = 0, linear = 0, angular = 0, relative_sigma = 0, start_depth = 0, linearity = 0, sigma_px = 1;
  double circle_seconds = 180, slant = 35, height = 0;
  double lens_scale = 1, fold_sigma = 0, fix_sigma = -1, roughness = 0, plane_distance = 0, plane_radius = 0;
  std::string fold = "condition", fix = "consider", lens;
  int depth_from_map = -1, in_view = 44, first_birth = 15, target_points = 0, max_state_dim = 0;
};

int fail(const std::string& what) {
  std::fprintf(stderr, "pf-sim: %s\n", what.c_str());
  return 1;
}

/// Of a command line that is wrong.
int refuse(const std::string& what) {
  fail(what);
  return 2;
}

void set_if(double& field, double value) {
  if (value > 0) field = value;
}

/// The paper's cases (Gee 2007, section 4), by sigma_T and sigma_fix [m]; 0: points only, and never fixed.
struct Case {
  char name;
  double fold_sigma, fix_sigma;
};
constexpr Case kCases[] = {{'A', 0, 0},        {'B', 0.02, 0},    {'C', 0.10, 0},
                           {'D', 0.02, 0.001}, {'E', 0.10, 0.01}, {'F', 0.10, 0.001}};

const Case* find_case(char name) {
  for (const Case& one : kCases)
    if (one.name == name) return &one;
  return nullptr;
}

void set_case(const Choices& c, const Case& one, pf_config_t& config) {
  config.plane.enabled = one.fold_sigma > 0;
  config.plane.roughness = 0.001;  // these walls are flat
  set_if(config.plane.fold_sigma, one.fold_sigma);
  config.plane.fix_sigma = one.fix_sigma;
  set_if(config.plane.fold_sigma, c.fold_sigma);
  if (c.fix_sigma >= 0) config.plane.fix_sigma = c.fix_sigma;
  set_if(config.plane.roughness, c.roughness);
  set_if(config.plane.max_distance, c.plane_distance);
  set_if(config.plane.max_radius, c.plane_radius);
  config.plane.fix = c.fix == "inflate" ? PF_FIX_INFLATE : c.fix == "error-free" ? PF_FIX_ERROR_FREE : PF_FIX_CONSIDER;
}

/// Forms for comparison, and a walk for the paper's bed.
pf_research_t research_of(const Choices& c, const BedOptions& bed, bool gee) {
  pf_research_t research;
  pf_research_default(&research);
  research.fold = c.fold == "drop" ? PF_FOLD_DROP : PF_FOLD_CONDITION;
  if (!gee) return research;
  // The circle's own speed, as the steps of a walk: v sqrt(dt).
  const double speed = 2 * 3.14159265358979 / bed.circle_seconds, dt = 1 / bed.rate_hz;
  research.linear_walk = research.angular_walk = speed * std::sqrt(dt);
  set_if(research.linear_walk, c.linear);
  set_if(research.angular_walk, c.angular);
  return research;
}

/// What the two commands share: the filter's settings, and the bed from the options.
Experiment prepare(const Choices& c, bool gee) {
  Experiment x;
  x.seeds = c.seeds;
  x.first_seed = c.first_seed;
  x.run.gauge_every = c.gauge_every;
  x.run.motion_frames = c.relative;
  x.bed.layout = gee || c.layout != "model" ? Layout::kRoom : Layout::kModel;
  x.bed.circle = gee;
  x.bed.look_inward = c.look == "inward";
  x.bed.circle_seconds = c.circle_seconds;
  x.bed.fov_deg = c.fov > 0 ? c.fov : gee ? 43 : 80;
  x.bed.frames = c.frames > 0 ? c.frames : gee ? 10800 : 1800;
  x.bed.points_in_view = c.in_view;
  x.bed.first_birth = c.first_birth;
  x.bed.target_points = c.target_points > 0 ? c.target_points : gee ? 4 : 9;
  x.bed.target_size = gee ? 0.2 : 0.25;
  x.bed.target_slant_deg = c.slant;
  x.bed.room_half_height = c.height > 0 ? c.height : gee ? 1.0 : 0.5;
  if (gee) x.bed.sigma_start_v = x.bed.sigma_start_w = 0.05;

  pf_config_t& config = x.config;
  pf_config_default(&config);
  config.camera = Bed::camera(x.bed.fov_deg);
  if (!c.lens.empty()) {  // drawn anew for each run
    x.bed.draw_lens = true;
    config.camera.estimate = c.lens == "estimate"   ? PF_CAMERA_ESTIMATE
                             : c.lens == "consider" ? PF_CAMERA_CONSIDER
                                                    : PF_CAMERA_EXACT;
    config.camera.sigma_focal = 0.01 * c.lens_scale;
    config.camera.sigma_aspect = 0.001 * c.lens_scale;
    config.camera.sigma_centre_px = c.lens_scale * 0.01 * config.camera.width;
    config.camera.sigma_distortion[0] = 0.05 * c.lens_scale;
  }
  config.measurement.sigma_px = c.sigma_px;
  config.measurement.gate_probability = 0.9999;  // association is perfect: nothing true should be cut off
  config.capacity.max_features = 300;
  config.capacity.max_state_dim = c.max_state_dim > 0 ? c.max_state_dim : 1000;
  config.capacity.max_observations = 100;
  config.motion.coast_s = 10;
  config.first_depth.from_map = x.bed.layout == Layout::kRoom;
  config.first_depth.depth = gee ? (x.bed.look_inward ? 2.0 : 1.2) : x.bed.layout == Layout::kRoom ? 1.6 : 2.0;
  if (x.bed.layout == Layout::kModel) config.first_depth.relative_sigma = 0.3;
  config.capacity.max_planes = 16;
  if (!gee) config.clock_ns = thread_clock;
  if (c.depth_from_map >= 0) config.first_depth.from_map = c.depth_from_map;
  set_if(config.first_depth.depth, c.start_depth);
  set_if(config.first_depth.relative_sigma, c.relative_sigma);
  set_if(config.first_depth.linearity_index, c.linearity);
  if (gee) {
    config.motion.model = c.motion == "walk" ? PF_MOTION_CONSTANT_POSITION : PF_MOTION_CONSTANT_VELOCITY;
    config.motion.linear_acceleration_density = config.motion.angular_acceleration_density = 0.02;
  }
  set_if(config.motion.linear_acceleration_density, c.linear);
  set_if(config.motion.angular_acceleration_density, c.angular);
  return x;
}

nlohmann::json describe(const Experiment& x) {
  const pf_config_t& c = x.config;
  pf_research_t research;
  pf_config_get_research(&c, &research);
  return {{"layout", x.bed.layout == Layout::kRoom ? "room" : "model"},
          {"motion", c.motion.model == PF_MOTION_CONSTANT_POSITION ? "walk" : "velocity"},
          {"fov_deg", x.bed.fov_deg},
          {"sigma_pixel", c.measurement.sigma_px},
          {"linear_acceleration_density", c.motion.linear_acceleration_density},
          {"angular_acceleration_density", c.motion.angular_acceleration_density},
          {"linear_walk", research.linear_walk},
          {"angular_walk", research.angular_walk},
          {"start_depth", c.first_depth.depth},
          {"depth_from_map", c.first_depth.from_map},
          {"inverse_depth_relative_sigma", c.first_depth.relative_sigma},
          {"linearity_index", c.first_depth.linearity_index},
          {"max_state_dim", c.capacity.max_state_dim},
          {"planes", c.plane.enabled},
          {"plane_min_points", c.plane.min_points},
          {"plane_distance", c.plane.max_distance},
          {"plane_radius", c.plane.max_radius},
          {"plane_roughness", c.plane.roughness},
          {"fold_sigma", c.plane.fold_sigma},
          {"fix_sigma", c.plane.fix_sigma},
          {"fold", research.fold == PF_FOLD_DROP ? "drop" : "condition"},
          {"fix", c.plane.fix == PF_FIX_CONSIDER  ? "consider"
                  : c.plane.fix == PF_FIX_INFLATE ? "inflate"
                                                  : "error-free"},
          {"relative", x.run.motion_frames},
          {"first_seed", x.first_seed}};
}

int run(const Choices& c, bool gee) {
  for (const char name : c.cases)
    if (!find_case(name)) return refuse(std::string("there is no case ") + name + "; the cases are A to F");
  if (c.cases.empty()) return refuse("no case was given");
  if (c.fold != "condition" && c.fold != "drop") return refuse("the fold is condition or drop");
  if (c.fix != "consider" && c.fix != "inflate" && c.fix != "error-free")
    return refuse("the form of fixing is consider, inflate or error-free");
  if (!c.layout.empty() && c.layout != "model" && c.layout != "room") return refuse("the layout is model or room");
  if (!c.lens.empty() && c.lens != "exact" && c.lens != "consider" && c.lens != "estimate")
    return refuse("--lens " + c.lens + ": write exact, consider or estimate");
  if (!(c.lens_scale > 0 && c.lens_scale <= 2)) return refuse("--lens-scale must be above 0 and at most 2");
  if (c.motion != "walk" && c.motion != "velocity") return refuse("the motion is walk or velocity");
  if (c.look != "inward" && c.look != "outward") return refuse("the camera looks inward or outward");
  if (c.seeds < 1 || c.seeds > 10000 || c.jobs < 1 || c.frames < 0)
    return refuse("--seeds, --jobs and --frames must be positive");
  if (c.target_points != 0 && c.target_points != 4 && c.target_points != 9 && c.target_points != 16)
    return refuse("--target-points " + std::to_string(c.target_points) + ": write 4, 9 or 16");
  const std::string name = gee ? "gee2007" : "room";
  nlohmann::json out;
  out["experiment"] = name;
  std::vector<bool> keep;
  if (c.plain) {
    keep = {false};
  } else {
    keep = {true};
    if (gee) keep.push_back(false);
  }
  for (const char letter : c.cases) {
    for (const bool keep_gauge : keep) {
      Experiment x = prepare(c, gee);
      set_case(c, *find_case(letter), x.config);
      pf_research_t research = research_of(c, x.bed, gee);
      research.keep_gauge = keep_gauge;
      pf_config_set_research(&x.config, &research);
      const char* field = nullptr;
      if (pf_config_check(&x.config, &field) != PF_OK) return refuse(std::string("option out of range: ") + field);
      const std::string label = std::string(1, letter) + (keep_gauge ? "" : "_plain_ekf");
      if (!run_all(x, c.jobs, (name + " " + label).c_str())) return fail("a run did not come to its end");
      out["settings"][label] = describe(x);
      out["cases"][label] = summarise(x);
      print(name + " " + label, out["cases"][label]);
      if (!c.csv.empty() && !write_csv(x, c.csv, name + "_" + label)) return fail("cannot write to " + c.csv);
    }
  }
  if (!c.json.empty() && !write_json(c.json, out)) return fail("cannot write " + c.json);
  return 0;
}

void add_common(CLI::App* command, Choices& c) {
  command->add_option(
      "--case", c.cases,
      "A: points only; B, C: planes, strong and weak threshold; D, E, F: strong, weak, medium with fixing; "
      "several letters run one after the other on the same seeds");
  command->add_option("--fold", c.fold, "condition, or drop as the paper");
  command->add_option("--fix", c.fix, "consider, inflate, or error-free as the paper");
  command->add_option("--fold-sigma", c.fold_sigma, "sigma_T, in place of the case's [m]");
  command->add_option("--fix-sigma", c.fix_sigma, "sigma_fix, in place of the case's [m]; 0: never");
  command->add_option("--roughness", c.roughness, "of the walls, as the filter has it [m]");
  command->add_option("--plane-distance", c.plane_distance, "d_T [m]");
  command->add_option("--plane-radius", c.plane_radius, "d_max [m]");
  command->add_option("--seeds", c.seeds, "how many runs");
  command->add_option("--first-seed", c.first_seed, "seed of the first run");
  command->add_option("--frames", c.frames, "of each run");
  command->add_option("--jobs", c.jobs, "processes at a time");
  command->add_option("--json", c.json, "report to write")->check(pf::tools::writable_file());
  command->add_option("--csv", c.csv, "folder for per-frame tables")->check(pf::tools::writable_folder());
  command->add_flag("--plain-ekf", c.plain, "the textbook filter, which does not keep the gauge");
  command->add_option("--gauge-every", c.gauge_every, "frames between readings of the gauge information, 0: never");
  command->add_option("--relative", c.relative, "frames of a window over which the motion is judged, 0: none");
  command->add_option("--fov", c.fov, "horizontal field of view [deg]");
  command->add_option("--sigma-px", c.sigma_px, "measurement noise [px]");
  command->add_option(
      "--lens", c.lens,
      "the true camera is drawn for each run: 1 % in focal length and centre, 0.05 in k1; the filter's is "
      "taken as exact, consider or estimate");
  command->add_option("--lens-scale", c.lens_scale, "times those standard deviations");
  command->add_option("--linear-density", c.linear, "white acceleration [m/s^2/sqrt(Hz)], or walk [m/sqrt(s)]");
  command->add_option("--angular-density", c.angular, "the same of rotation [rad/s^2/sqrt(Hz)], [rad/sqrt(s)]");
  command->add_option("--relative-sigma", c.relative_sigma, "of the prior of inverse depth");
  command->add_option("--start-depth", c.start_depth, "of the prior [m]");
  command->add_option("--depth-from-map", c.depth_from_map, "0 or 1: new depths from the map's median");
  command->add_option("--linearity-index", c.linearity, "below it a point becomes 3-D");
  command->add_option("--slant", c.slant, "between the target's normal and the first line of sight [deg]");
  command->add_option("--height", c.height, "half height of the room's points [m]");
  command->add_option("--first-birth", c.first_birth, "frame from which new points begin");
  command->add_option("--target-points", c.target_points, "4, 9 or 16");
  command->add_option("--max-state-dim", c.max_state_dim, "capacity of the state");
}

}  // namespace

void add_room(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand("room", "NEES of the filter when all its models are true, or in a room");
  add_common(command, *c);
  command->add_option(
      "--layout", c->layout,
      "room: points of a 4 m room, half of them on its walls (default); model: depths drawn from the prior, no planes");
  const CLI::Option* in_view =
      command->add_option("--in-view", c->in_view, "points that are kept in view (layout model)");
  command->callback([c, in_view, &result] {
    const bool unused = in_view->count() > 0 && c->layout != "model";
    result = unused ? refuse("--in-view is for --layout model") : run(*c, false);
  });
}

void add_gee2007(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command =
      app.add_subcommand("gee2007", "The paper's room and circle, with its own filter or the library's");
  add_common(command, *c);
  command->add_option("--motion", c->motion, "velocity, or walk as the paper has it");
  command->add_option("--look", c->look, "inward, across the middle (some 20 points in view), or outward (some 5)");
  command->add_option("--seconds-per-loop", c->circle_seconds, "of the circle");
  const auto paper = gee::add_paper_options(command);
  command->callback([c, paper, command, &result] {
    if (paper->filter == "library") {
      const std::string unused = gee::given_paper_option(*command);
      result = unused.empty() ? run(*c, true) : refuse(unused + " is an option of --filter paper");
      return;
    }
    const std::string look = command->count("--look") ? c->look : "";
    result = gee::run_paper_command(*command, *paper,
                                    {c->cases, look, c->json, c->csv, c->seeds, c->frames, c->jobs, c->first_seed,
                                     c->fov, c->sigma_px, c->height, c->slant, c->linearity, c->first_birth});
  });
}

}  // namespace pfsim
