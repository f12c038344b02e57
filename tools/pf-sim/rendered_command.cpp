// pf-sim rendered: Monte Carlo runs of the whole library on rendered frames, in the truth's own frame.

#include <planefold/planefold_research.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "../lib/command_line.h"
#include "backend_option.h"
#include "commands.h"
#include "context.h"
#include "motion_option.h"
#include "rendered_run.h"
#include "report.h"

namespace pfsim {
namespace {

using nlohmann::json;

struct Choices {
  std::string scene = "desk", json_file, csv;
  BackendOption backend;
  MotionOption motion;
  std::vector<std::string> starts{"rectangle"};
  std::vector<double> sigma_pixels{0};
  int seeds = 20, frames = 300, jobs = 2, blur = 2, relative = 0;
  std::uint64_t first_seed = 1;
  double noise = 2, exposure_s = 0.008, readout_s = 0;
  bool as_global = false;
  std::vector<std::string> lenses{"right"}, masks{"none"};
  double focal_error = 0, k1 = 0;
  bool draw_lens = false;
  bool no_planes = false;
  int max_features = 0, max_state_dim = 0, max_planes = 0;
};

struct Job {
  const RenderedOptions* options;
  std::uint64_t first_seed;
  std::size_t seeds;
  RenderedSummary* summaries;  // seed by seed within each variant; rows likewise

  FrameRow* rows;
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

void run_one(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  const std::size_t variants = job.options->variants.size(), frames = static_cast<std::size_t>(job.options->sim.frames);
  const auto seed = static_cast<std::size_t>(index);
  std::vector<RenderedSummary*> summaries;
  std::vector<FrameRow*> rows;
  for (std::size_t v = 0; v < variants; ++v) {
    const std::size_t at = v * job.seeds + seed;
    summaries.push_back(job.summaries + at);
    rows.push_back(job.rows + at * frames);
  }
  run_rendered(*job.options, job.first_seed + seed, summaries, rows);
}

json innovations_json(const InnovationSums& s) {
  const double n = std::max(1.0, s.count), matches = std::max(1.0, s.match_count);
  return {{"inliers", s.count},
          {"nis_per_dof", s.nis / (2 * n)},
          {"lag_one", s.innovation.value()},
          {"rms_px", std::sqrt(s.square / (2 * n))},
          {"match_rms_px", std::sqrt(s.match_square / (2 * matches))},
          {"match_lag_one", s.match.value()},
          {"match_far_share", s.match_far / std::max(1.0, s.match_count + s.match_far)}};
}

/// Of fx, fy, cx, cy and k1 at the end: root mean square of the errors, of the standard deviations, and the largest ratio of both in any
/// run. Null where the lens was taken as exact.
json lens_json(int seeds, const RenderedSummary* summaries) {
  if (seeds < 1 || summaries[0].lens_sigma[0] <= 0) return nullptr;
  constexpr const char* kNames[5] = {"fx", "fy", "cx", "cy", "k1"};
  json out;
  for (int i = 0; i < 5; ++i) {
    double error = 0, sigma = 0, worst = 0;
    for (int s = 0; s < seeds; ++s) {
      const double e = summaries[s].lens_error[i], d = summaries[s].lens_sigma[i];
      error += e * e / seeds;
      sigma += d * d / seeds;
      worst = std::max(worst, std::fabs(e) / std::max(d, 1e-300));
    }
    out[kNames[i]] = {{"rmse", std::sqrt(error)}, {"sigma", std::sqrt(sigma)}, {"worst_ratio", worst}};
  }
  return out;
}

json summarise_runs(const Runs& runs, const RenderedSummary* summaries) {
  json out = summarise_frames(runs);
  int lost_frames = 0, lost_runs = 0, tracked = 0, coasting = 0, starting = 0;
  InnovationSums sums[kTrackKinds], all;
  FoldSums folds;
  json each = json::array();
  double track_length = 0;
  for (int s = 0; s < runs.seeds; ++s) {
    const RenderedSummary& r = summaries[s];
    folds.add(r.folds);
    track_length += r.track_length / runs.seeds;
    lost_frames += r.lost_frames;
    const bool lost = r.lost_frames > 0 || !r.done;
    lost_runs += lost;
    tracked += r.tracked_frames;
    coasting += r.coasting_frames;
    starting += r.starting_frames;
    for (int k = 0; k < kTrackKinds; ++k) sums[k].add(r.innovations[k]);
    const Runs one{1, runs.frames, runs.first_seed, &runs.row(s, 0)};
    const json numbers = summarise_frames(one);
    each.push_back({{"seed", runs.first_seed + static_cast<std::uint64_t>(s)},
                    {"lost_frames", r.lost_frames},
                    {"tracked_share", static_cast<double>(r.tracked_frames) / runs.frames},
                    {"nees_position", numbers["nees_position"]["mean"]},
                    {"nees_pose", numbers["nees_pose"]["mean"]},
                    {"camera_rmse_m", numbers["camera_rmse_m"]},
                    {"track_length", r.track_length},
                    {"motion", numbers["motion"]},
                    {"folds", folds_json(r.folds)},
                    {"lens_error", r.lens_error},
                    {"lens_sigma", r.lens_sigma}});
  }
  const double frames = static_cast<double>(runs.seeds) * runs.frames;
  out["track_length"] = track_length;
  out["lost_runs"] = lost_runs;
  out["lost_frames"] = lost_frames;
  out["tracked_share"] = tracked / frames;
  out["coasting_share"] = coasting / frames;
  out["starting_share"] = starting / frames;
  out["claimed_over_real"] = out["camera_sigma_m"].get<double>() / std::max(1e-12, out["camera_rmse_m"].get<double>());
  for (int k = 0; k < kTrackKinds; ++k) {
    out["innovations"][kTrackKindName[static_cast<std::size_t>(k)]] = innovations_json(sums[k]);
    all.add(sums[k]);
  }
  out["innovations"]["all"] = innovations_json(all);
  out["each_run"] = each;
  out["lens"] = lens_json(runs.seeds, summaries);
  std::vector<const PlanesVerdict*> planes;
  for (int s = 0; s < runs.seeds; ++s) planes.push_back(&summaries[s].planes);
  out["planes"] = planes_json(planes);
  out["folds"] = folds_json(folds);
  return out;
}

void print_runs(const json& j) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  for (const json& r : j["each_run"])
    std::printf("  seed %3d: position NEES %6.2f, pose NEES %6.2f, RMSE %.4f m, tracked %5.1f %%, lost frames %d\n",
                r["seed"].get<int>(), r["nees_position"].get<double>(), r["nees_pose"].get<double>(),
                r["camera_rmse_m"].get<double>(), 100 * r["tracked_share"].get<double>(), r["lost_frames"].get<int>());
  std::printf("position NEES %.3f +- %.3f, median %.3f (3 dof); pose NEES %.3f, median %.3f (6 dof)\n",
              number("/nees_position/mean"), number("/nees_position/standard_error"), number("/nees_position/median"),
              number("/nees_pose/mean"), number("/nees_pose/median"));
  std::printf(
      "camera RMSE %.4f m, claimed %.4f m, so claimed over real %.2f; state %g, %g inliers; joint NIS/dof %.3f\n",
      number("/camera_rmse_m"), number("/camera_sigma_m"), number("/claimed_over_real"), number("/state_dim/median"),
      number("/inliers_median"), number("/nis_per_dof"));
  print_motion(j["motion"]);
  std::printf(
      "%g runs of %g frames: %g lost runs, %g lost frames, %.2f %% tracked, %.2f %% coasting; tracks of %.1f frames\n",
      number("/runs"), number("/frames"), number("/lost_runs"), number("/lost_frames"), 100 * number("/tracked_share"),
      100 * number("/coasting_share"), number("/track_length"));
  std::printf(
      "planes: %g true (NEES %.1f, median %.1f, 3 dof), %g false (%g of them as far off as they say), %g twice; of %g "
      "surfaces seen well %g found, %g "
      "within 2 deg and 2 cm (worst %.2f "
      "deg, "
      "%.3f m), %g with a good outline (least covered %.2f, most overstepped %.2f)\n",
      number("/planes/true"), number("/planes/nees_mean"), number("/planes/nees_median"), number("/planes/false"),
      number("/planes/explained"), number("/planes/duplicate"), number("/planes/wanted"), number("/planes/found"),
      number("/planes/within_2_deg_2_cm"), number("/planes/worst_normal_deg"), number("/planes/worst_offset_m"),
      number("/planes/outlined"), number("/planes/least_covered"), number("/planes/most_overstep"));
  std::printf(
      "points: %g were with %d of their surface for %d frames, %.1f %% of them folded into it by then (%g still "
      "without "
      "depth, %g of no plane, %g waiting); %.2f %% of those on planes are on a wrong one\n",
      number("/folds/due"), kTogether, kTogetherFrames, 100 * number("/folds/share"), number("/folds/young"),
      number("/folds/missing"), number("/folds/waiting"), 100 * number("/folds/wrong_share"));
  std::printf("innovations      inliers  NIS/dof  lag 1   rms px | match against truth: rms px  lag 1  far %%\n");
  if (!j["lens"].is_null())
    for (const char* name : {"fx", "fy", "cx", "cy", "k1"}) {
      const json& l = j["lens"][name];
      std::printf("lens %s: error %.4g, claimed %.4g, worst error over sigma %.2f\n", name, l["rmse"].get<double>(),
                  l["sigma"].get<double>(), l["worst_ratio"].get<double>());
    }
  for (const char* kind : {"inverse_depth", "point", "target", "all"}) {
    const json& i = j["innovations"][kind];
    const auto of = [&](const char* name) { return i[name].get<double>(); };
    std::printf("  %-14s %8.0f  %7.3f  %5.2f  %7.3f | %28.3f  %5.2f  %5.2f\n", kind, of("inliers"), of("nis_per_dof"),
                of("lag_one"), of("rms_px"), of("match_rms_px"), of("match_lag_one"), 100 * of("match_far_share"));
  }
}

/// pf_masks_t by its name; -1: there is none.
int masks_by_name(const std::string& name) {
  return name == "none" ? PF_MASKS_NONE : name == "partial" ? PF_MASKS_PARTIAL : name == "whole" ? PF_MASKS_WHOLE : -1;
}

/// What a filter is told of a camera when its calibration is wrong: the focal length, and nothing of the distortion.
pf_camera_t wrong_camera(const pf_camera_t& truth, double focal_error, const std::string& lens) {
  pf_camera_t camera = truth;
  camera.model = PF_CAMERA_PINHOLE;
  camera.distortion[0] = 0;
  camera.fx *= 1 + focal_error;
  camera.fy *= 1 + focal_error;
  camera.estimate = lens == "estimate" ? PF_CAMERA_ESTIMATE : lens == "consider" ? PF_CAMERA_CONSIDER : PF_CAMERA_EXACT;
  return camera;
}

bool prepare(const Choices& c, RenderedOptions& o) {
  o.scene = c.scene;
  o.motion_frames = c.relative;
  o.draw_lens = c.draw_lens;
  if (pf_sim_options_default(c.scene.c_str(), &o.sim) != PF_OK) return false;
  o.sim.frames = c.frames;
  o.sim.noise_grey = c.noise;
  o.sim.exposure_s = c.exposure_s;
  o.sim.blur_samples = c.blur;
  o.sim.readout_s = c.readout_s;
  if (c.k1 != 0) {
    o.sim.camera.model = PF_CAMERA_RADTAN;
    o.sim.camera.distortion[0] = c.k1;
  }
  for (const std::string& start : c.starts)
    for (const std::string& lens : c.lenses)
      for (const double sigma : c.sigma_pixels)
        for (const std::string& masks : c.masks) {
          Variant v;
          pf_config_default(&v.config);
          v.lens = lens;
          v.masks = masks;
          v.config.map.masks = masks_by_name(masks);
          if (v.config.map.masks == PF_MASKS_WHOLE) allow_research(&v.config);
          v.config.camera = lens == "right" ? o.sim.camera : wrong_camera(o.sim.camera, c.focal_error, lens);
          v.config.camera.readout_s = c.as_global ? 0 : c.readout_s;
          if (sigma > 0) v.config.measurement.sigma_px = sigma;
          c.backend.apply(v.config, c.max_features);
          c.motion.apply(v.config);
          if (c.no_planes) v.config.plane.enabled = 0;
          if (c.max_state_dim > 0) v.config.capacity.max_state_dim = c.max_state_dim;
          if (c.max_planes > 0) v.config.capacity.max_planes = c.max_planes;
          v.start = start == "rectangle" ? RenderedStart::kRectangle
                    : start == "points"  ? RenderedStart::kPoints
                                         : RenderedStart::kPose;
          o.variants.push_back(v);
        }
  return true;
}

/// The scene's name alone where there is nothing to choose from.
std::string label_of(const Choices& c, const Variant& variant, const std::string& start) {
  std::string label = c.scene;
  const double sigma = variant.config.measurement.sigma_px;
  if (c.starts.size() > 1) label += "_" + start;
  if (c.lenses.size() > 1) label += "_" + variant.lens;
  if (c.sigma_pixels.size() > 1) {
    char text[32];
    std::snprintf(text, sizeof text, "_%g_px", sigma);
    label += text;
  }
  if (c.masks.size() > 1) label += "_" + variant.masks;
  return label;
}

int run(const Choices& c) {
  for (const std::string& start : c.starts)
    if (start != "rectangle" && start != "points" && start != "pose")
      return refuse("the start is rectangle, points or pose");
  for (const std::string& lens : c.lenses)
    if (lens != "right" && lens != "exact" && lens != "consider" && lens != "estimate")
      return refuse("the lens is right, exact, consider or estimate");
  for (const std::string& masks : c.masks)
    if (masks_by_name(masks) < 0) return refuse("--masks is none, partial or whole");
  if (c.seeds < 1 || c.seeds > 10000 || c.jobs < 1 || c.frames < 1 || c.frames > 100000)
    return refuse("--seeds, --jobs and --frames must be positive");
  if (c.as_global && c.readout_s == 0) return refuse("--as-global is of rows that differ in time: add --readout S");
  if (c.focal_error != 0 && c.lenses == std::vector<std::string>{"right"})
    return refuse("--focal-error is of a wrong calibration: add --lens exact, consider or estimate");
  if (c.draw_lens && (c.focal_error != 0 || c.k1 != 0 || c.as_global || c.readout_s != 0))
    return refuse("--draw-lens draws the whole lens: leave --focal-error, --k1, --readout and --as-global away");
  RenderedOptions options;
  if (!prepare(c, options)) return refuse(no_scene(c.scene));
  const char* field = nullptr;
  for (const Variant& v : options.variants)
    if (pf_config_check(&v.config, &field) != PF_OK) return refuse(std::string("option out of range: ") + field);
  pf_sim_t* probe = pf_sim_open(c.scene.c_str(), &options.sim);
  pf_target_t target;
  const bool possible = probe && pf_sim_target(probe, PF_TARGET_RECTANGLE, &target) == PF_OK;
  pf_sim_close(probe);
  if (!possible)
    return refuse("--scene " + c.scene + ": shows no target to start at, or --exposure is longer than a frame");

  const auto seeds = static_cast<std::size_t>(c.seeds), frames = static_cast<std::size_t>(c.frames);
  const std::size_t count = seeds * options.variants.size();
  Job job{&options, c.first_seed, seeds, static_cast<RenderedSummary*>(shared_memory(count * sizeof(RenderedSummary))),
          static_cast<FrameRow*>(shared_memory(count * frames * sizeof(FrameRow)))};
  if (!job.summaries || !job.rows) return fail("no memory");
  if (!in_processes(c.seeds, c.jobs, "rendered", run_one, &job)) return fail("a run did not come to its end");
  json out = {{"experiment", "rendered"},
              {"settings",
               {{"scene", c.scene},
                {"backend", c.backend.name},
                {"first_seed", c.first_seed},
                {"noise_grey", c.noise},
                {"exposure_s", c.exposure_s},
                {"blur_samples", c.blur},
                {"readout_s", c.readout_s},
                {"relative", c.relative},
                {"draw_lens", c.draw_lens},
                {"focal_error", c.focal_error},
                {"k1", c.k1}}}};
  for (std::size_t v = 0; v < options.variants.size(); ++v) {
    const double sigma = options.variants[v].config.measurement.sigma_px;
    const std::string start = c.starts[v / (c.sigma_pixels.size() * c.lenses.size() * c.masks.size())];
    const std::string label = label_of(c, options.variants[v], start);
    const Runs runs{c.seeds, c.frames, c.first_seed, job.rows + v * seeds * frames};
    json& numbers = out["cases"][label] = summarise_runs(runs, job.summaries + v * seeds);
    numbers["start"] = start;
    numbers["sigma_pixel"] = sigma;
    std::printf("%s: start %s, sigma_pixel %g\n", label.c_str(), start.c_str(), sigma);
    print_runs(numbers);
    if (!c.csv.empty() && !write_csv(runs, c.csv, "rendered_" + label)) return fail("cannot write to " + c.csv);
  }
  if (!c.json_file.empty() && !write_json(c.json_file, out)) return fail("cannot write " + c.json_file);
  return 0;
}

}  // namespace

void add_rendered(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand("rendered", "NEES and errors of the whole library on rendered frames");
  command->add_option("--scene", c->scene, "desk room corridor wall person exposure repeat bushes road");
  c->backend.add_to(*command);
  c->motion.add_to(*command);
  command->add_option("--start", c->starts,
                      "rectangle: found by itself; points: its corners, about a pose from its prior");
  command->add_option("--seeds", c->seeds, "how many runs");
  command->add_option("--first-seed", c->first_seed, "seed of the first run");
  command->add_option("--frames", c->frames, "of each run");
  command->add_option("--jobs", c->jobs, "processes at a time");
  command->add_option("--json", c->json_file, "report to write")->check(pf::tools::writable_file());
  command->add_option("--csv", c->csv, "folder for per-frame tables")->check(pf::tools::writable_folder());
  command->add_option("--noise", c->noise, "standard deviation of a pixel [grey levels]")
      ->check(pf::capture::number_in(0.0, 50.0));
  command->add_option("--exposure", c->exposure_s, "[s]")->check(pf::capture::number_in(0.0, 1.0));
  command->add_option("--blur", c->blur, "views averaged over the exposure")
      ->check(pf::capture::whole_number_in(1, 64));
  command->add_option("--readout", c->readout_s, "rolling shutter, first to last row [s]");
  command->add_flag("--as-global", c->as_global, "the filter takes the shutter as global, for comparison");
  command->add_option(
      "--lens", c->lenses,
      "one or more: right, or with a wrong calibration that the library takes as exact, considers or estimates");
  command->add_option("--masks", c->masks, "one or more of map.masks: none, partial, whole");
  command->add_option("--focal-error", c->focal_error, "of a wrong calibration, relative");
  command->add_flag("--draw-lens", c->draw_lens,
                    "each run's true lens is drawn from the prior (1 %, centre 1 % of the width, k1 0.05); only lens "
                    "right has its numbers");
  command->add_option("--k1", c->k1, "radial distortion of the camera, which a wrong calibration does not name");
  command->add_option("--relative", c->relative, "frames of a window over which the motion is judged, 0: none");
  command->add_flag("--no-planes", c->no_planes, "points only, for comparison");
  command->add_option("--max-features", c->max_features, "of the map; 0: the library's default");
  command->add_option("--max-state-dim", c->max_state_dim, "rows of the covariance; 0: the library's default");
  command->add_option("--max-planes", c->max_planes, "planes of the map; 0: the library's default");
  command->add_option("--sigma-px", c->sigma_pixels,
                      "one or more: the filter's own floor of a match's noise [px]; 0: its default");
  command->callback([c, &result] { result = run(*c); });
}

}  // namespace pfsim
