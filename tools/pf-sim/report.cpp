#include "report.h"

#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "statistics.h"

namespace pfsim {

using nlohmann::json;

namespace {

/// Mean over the runs that are valid at a frame, and how many these are.
struct RunMean {
  double value = 0;
  int runs = 0;
};

template <typename Get>
RunMean run_mean(const Runs& x, int frame, Get get) {
  RunMean mean;
  for (int s = 0; s < x.seeds; ++s) {
    const double v = static_cast<double>(get(x.row(s, frame)));
    if (!(v >= 0) || !std::isfinite(v)) continue;
    mean.value += v;
    ++mean.runs;
  }
  if (mean.runs > 0) mean.value /= mean.runs;
  return mean;
}

/// Whether a run's time mean lies below what 95 % of single errors of a perfect filter lie below.
auto below_95(double dof) {
  return [limit = chi_square_quantile(0.95, dof)](double mean) { return mean < limit; };
}

/// Time mean of a normalised error, and how its run averages lie against the chi-square bounds of a run average.
template <typename Get>
json nees_json(const Runs& x, int dof, Get get) {
  double sum = 0;
  int above = 0, below = 0, frames = 0;
  for (int f = 0; f < x.frames; ++f) {
    const RunMean mean = run_mean(x, f, get);
    if (mean.runs == 0) continue;
    sum += mean.value;
    ++frames;
    const double n = mean.runs;
    above += mean.value > chi_square_quantile(0.975, dof * n) / n;
    below += mean.value < chi_square_quantile(0.025, dof * n) / n;
  }
  // Each run's own time mean, for the spread that the mean over runs has by chance.
  double square = 0;
  std::vector<double> means, all;
  for (int s = 0; s < x.seeds; ++s) {
    double total = 0;
    int count = 0;
    for (int f = 0; f < x.frames; ++f) {
      const double v = static_cast<double>(get(x.row(s, f)));
      if (v >= 0 && std::isfinite(v)) {
        total += v;
        ++count;
        all.push_back(v);
      }
    }
    if (count > 0) means.push_back(total / count);
  }
  const double n = std::max(1, frames), mean = sum / n;
  for (const double m : means) square += (m - mean) * (m - mean);
  const double runs = std::max<double>(2, static_cast<double>(means.size()));
  return {{"mean", mean},
          {"standard_error", std::sqrt(square / (runs - 1) / runs)},
          {"median", median(all)},
          {"median_of_runs", median(means)},
          {"seeds", means},
          {"seeds_below_95", std::count_if(means.begin(), means.end(), below_95(dof))},
          {"above_share", above / n},
          {"below_share", below / n},
          {"inside_share", 1 - (above + below) / n},
          {"bound_low", chi_square_quantile(0.025, dof * x.seeds) / x.seeds},
          {"bound_high", chi_square_quantile(0.975, dof * x.seeds) / x.seeds},
          {"dof", dof}};
}

/// Of windows that do not overlap: NEES of the motion per degree of freedom, and the bounds between which it lies with probability 95 %
/// where the windows' errors are independent. Null without windows.
json motion_json(const Runs& x) {
  double sum = 0, rotation = 0, translation = 0;
  std::vector<double> all;
  for (int s = 0; s < x.seeds; ++s)
    for (int f = 0; f < x.frames; ++f) {
      const FrameRow& row = x.row(s, f);
      if (!(row.nees_position >= 0 && row.nees_motion >= 0)) continue;
      all.push_back(static_cast<double>(row.nees_motion) / 6);
      sum += static_cast<double>(row.nees_motion);
      rotation += static_cast<double>(row.nees_motion_rotation);
      translation += static_cast<double>(row.nees_motion_translation);
    }
  const double n = static_cast<double>(all.size());
  if (all.empty()) return nullptr;
  return {{"windows", n},
          {"nees_per_dof", sum / (6 * n)},
          {"nees_per_dof_median", median(all)},
          {"rotation_nees_per_dof", rotation / (3 * n)},
          {"translation_nees_per_dof", translation / (3 * n)},
          {"bound_low", chi_square_quantile(0.025, 6 * n) / (6 * n)},
          {"bound_high", chi_square_quantile(0.975, 6 * n) / (6 * n)}};
}

struct Job {
  const Experiment* experiment;
  RunSummary* summaries;
  FrameRow* rows;
};

void run_one(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  const Experiment& x = *job.experiment;
  job.summaries[index] = run_once(x.bed, x.config, x.run, x.first_seed + static_cast<std::uint64_t>(index),
                                  job.rows + static_cast<std::size_t>(index) * static_cast<std::size_t>(x.frames));
}

}  // namespace

std::vector<double> rmse_of(const Runs& runs) {
  std::vector<double> all;
  for (int s = 0; s < runs.seeds; ++s) {
    double square = 0, count = 0;
    for (int f = 0; f < runs.frames; ++f) {
      const FrameRow& row = runs.row(s, f);
      if (!(row.nees_position >= 0)) continue;
      square += static_cast<double>(row.error_m) * static_cast<double>(row.error_m);
      count += 1;
    }
    all.push_back(std::sqrt(square / std::max(1.0, count)));
  }
  return all;
}

json of_seeds(const std::vector<double>& values) {
  return {{"median", median(values)}, {"worst", *std::max_element(values.begin(), values.end())}, {"seeds", values}};
}

bool run_all(Experiment& x, int processes, const char* title) {
  x.frames = x.bed.frames;
  const auto seeds = static_cast<std::size_t>(x.seeds), frames = static_cast<std::size_t>(x.frames);
  Job job{&x, static_cast<RunSummary*>(shared_memory(seeds * sizeof(RunSummary))),
          static_cast<FrameRow*>(shared_memory(seeds * frames * sizeof(FrameRow)))};
  if (!job.summaries || !job.rows) return false;
  const bool good = in_processes(x.seeds, processes, title, run_one, &job);
  x.summaries = job.summaries;
  x.rows = job.rows;
  return good;
}

json summarise_frames(const Runs& x) {
  std::vector<double> inliers;
  double square = 0, claimed = 0, frames = 0, nis = 0, nis_dof = 0;
  for (int s = 0; s < x.seeds; ++s) {
    for (int f = 0; f < x.frames; ++f) {
      const FrameRow& row = x.row(s, f);
      if (!(row.nees_position >= 0)) continue;
      square += static_cast<double>(row.error_m) * static_cast<double>(row.error_m);
      claimed += static_cast<double>(row.sigma_m) * static_cast<double>(row.sigma_m);
      frames += 1;
      nis += static_cast<double>(row.nis);
      nis_dof += static_cast<double>(row.nis_dof);
      inliers.push_back(static_cast<double>(row.inliers));
    }
  }
  const auto dims_of = [&](auto get) {
    std::vector<double> all, last;
    for (int s = 0; s < x.seeds; ++s) {
      for (int f = 0; f < x.frames; ++f)
        if (x.row(s, f).nees_position >= 0) all.push_back(static_cast<double>(get(x.row(s, f))));
      last.push_back(static_cast<double>(get(x.row(s, x.frames - 1))));
    }
    return json{{"median", median(all)}, {"end", median(last)}};
  };
  json out;
  out["nees_position"] = nees_json(x, 3, [](const FrameRow& r) { return r.nees_position; });
  out["nees_pose"] = nees_json(x, 6, [](const FrameRow& r) { return r.nees_pose; });
  out["motion"] = motion_json(x);
  out["state_dim"] = dims_of([](const FrameRow& r) { return r.state_dim; });
  out["active_dim"] = dims_of([](const FrameRow& r) { return r.active_dim; });
  out["state_dim_points_only"] = dims_of([](const FrameRow& r) { return r.points_only_dim; });
  out["plane_points"] = dims_of([](const FrameRow& r) { return r.plane_points; });
  out["camera_rmse_m"] = std::sqrt(square / std::max(1.0, frames));
  out["camera_sigma_m"] = std::sqrt(claimed / std::max(1.0, frames));
  out["nis_per_dof"] = nis / std::max(1.0, nis_dof);
  out["inliers_median"] = median(inliers);
  out["runs"] = x.seeds;
  out["frames"] = x.frames;
  out["frames_judged"] = frames;
  return out;
}

json summarise(const Experiment& x) {
  double seconds = 0, map_square = 0, map_count = 0, map_nees = 0, pose = 0, scale = 0, scale_step = 0, beyond = -1,
         lens_nees = 0;
  int lost = 0, tracked = 0;
  RunSummary sum;
  for (int s = 0; s < x.seeds; ++s) {
    const RunSummary& r = x.summaries[s];
    lost += r.lost || !r.done;
    sum.unsound += r.unsound;
    lens_nees += r.lens_nees;
    sum.folded_nees_sum += r.folded_nees_sum;
    sum.folded_count += r.folded_count;
    sum.fixed_count += r.fixed_count;
    sum.plane_nees_sum += r.plane_nees_sum;
    sum.planes_judged += r.planes_judged;
    sum.planes_true += r.planes_true;
    sum.planes_mixed += r.planes_mixed;
    sum.planes_false += r.planes_false;
    sum.planes_duplicate += r.planes_duplicate;
    sum.planes_ever += r.planes_ever;
    sum.planes_ever_true += r.planes_ever_true;
    sum.planes_ever_false += r.planes_ever_false;
    sum.walls_seen += r.walls_seen;
    sum.walls_found += r.walls_found;
    tracked += r.frames_tracked;
    seconds += r.cpu_seconds;
    map_square += r.map_square_sum;
    map_count += r.map_count;
    map_nees += r.map_nees_sum;
    pose = std::max(pose, r.gauge_pose_growth);
    scale = std::max(scale, r.gauge_scale_growth);
    beyond = std::max(beyond, r.gauge_scale_beyond_priors);
    scale_step = std::max(scale_step, r.gauge_scale_step_growth);
  }
  json out = summarise_frames(x);
  out["map_rmse_m"] = std::sqrt(map_square / std::max(1.0, map_count));
  out["map_nees"] = map_nees / std::max(1.0, map_count);
  if (lens_nees > 0) out["lens_nees"] = lens_nees / x.seeds;
  out["planes"] = {{"true", sum.planes_true},
                   {"mixed", sum.planes_mixed},
                   {"false", sum.planes_false},
                   {"duplicate", sum.planes_duplicate},
                   {"ever", sum.planes_ever},
                   {"ever_true", sum.planes_ever_true},
                   {"ever_false", sum.planes_ever_false},
                   {"walls_seen_well", sum.walls_seen},
                   {"walls_found", sum.walls_found},
                   {"nees", sum.plane_nees_sum / std::max(1, sum.planes_judged)}};
  out["folded_points"] = {{"nees", sum.folded_nees_sum / std::max(1.0, sum.folded_count)},
                          {"per_run", sum.folded_count / x.seeds},
                          {"fixed_per_run", sum.fixed_count / x.seeds}};
  std::vector<double> update, frame;
  for (int s = 0; s < x.seeds; ++s) {
    if (!(x.summaries[s].cost.update_us > 0)) continue;
    update.push_back(x.summaries[s].cost.update_us);
    frame.push_back(x.summaries[s].cost.frame_us);
  }
  const double rows = out["state_dim"]["end"].get<double>();
  out["cost"] = {{"covariance_bytes", rows * (rows + 1) / 2 * sizeof(double)},
                 {"update_20_rows_us", update.empty() ? 0 : median(update)},
                 {"frame_20_rows_us", frame.empty() ? 0 : median(frame)}};
  out["covariance_unsound"] = sum.unsound;
  out["gauge_growth"] = {{"translation_rotation", pose},
                         {"scale", scale},
                         {"scale_beyond_depth_priors", beyond},
                         {"scale_one_frame_without_births", scale_step}};
  out["tracked_share"] = tracked / (static_cast<double>(x.seeds) * x.frames);
  out["lost_runs"] = lost;
  out["frames_per_second"] = out["frames_judged"].get<double>() / std::max(1e-9, seconds);
  return out;
}

bool claim_files(const std::string& directory, const std::vector<std::string>& names) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  char message[PF_SEQUENCE_MESSAGE] = "";
  for (const std::string& name : names) {
    if (pf_add_output_file(directory.c_str(), name.c_str(), message) == 0) continue;
    std::fprintf(stderr, "pf-sim: %s\n", message);
    return false;
  }
  return true;
}

bool write_csv(const Runs& x, const std::string& directory, const std::string& label) {
  if (!claim_files(directory, {label + ".csv", label + "_runs.csv"})) return false;
  std::ofstream means(directory + "/" + label + ".csv"), runs(directory + "/" + label + "_runs.csv");
  means << "frame,nees_position,nees_pose,bound_low,bound_high,rmse_m,sigma_m,state_dim,inliers,runs\n";
  runs << "seed,frame,nees_position,nees_pose,error_m,sigma_m,state_dim,inliers,x,y,z,true_x,true_y,true_z\n";
  for (int f = 0; f < x.frames; ++f) {
    const RunMean position = run_mean(x, f, [](const FrameRow& r) { return r.nees_position; });
    const double n = std::max(1, position.runs);
    means << f << ',' << position.value << ',' << run_mean(x, f, [](const FrameRow& r) { return r.nees_pose; }).value
          << ',' << chi_square_quantile(0.025, 3 * n) / n << ',' << chi_square_quantile(0.975, 3 * n) / n << ','
          << std::sqrt(run_mean(x, f, [](const FrameRow& r) { return r.error_m * r.error_m; }).value) << ','
          << std::sqrt(run_mean(x, f, [](const FrameRow& r) { return r.sigma_m * r.sigma_m; }).value) << ','
          << run_mean(x, f, [](const FrameRow& r) { return r.state_dim; }).value << ','
          << run_mean(x, f, [](const FrameRow& r) { return r.inliers; }).value << ',' << position.runs << '\n';
  }
  for (int s = 0; s < x.seeds; ++s)
    for (int f = 0; f < x.frames; ++f) {
      const FrameRow& r = x.row(s, f);
      runs << x.first_seed + static_cast<std::uint64_t>(s) << ',' << f << ',' << r.nees_position << ',' << r.nees_pose
           << ',' << r.error_m << ',' << r.sigma_m << ',' << r.state_dim << ',' << r.inliers;
      for (const float p : r.p_W) runs << ',' << p;
      for (const float p : r.true_W) runs << ',' << p;
      runs << '\n';
    }
  return means.good() && runs.good();
}

void print_motion(const json& motion) {
  if (motion.is_null()) return;
  const auto of = [&](const char* name) { return motion[name].get<double>(); };
  std::printf(
      "  motion: NEES per dof %.3f, median %.3f (0.89); rotation %.3f, translation %.3f; %g windows, bounds %.3f "
      "%.3f\n",
      of("nees_per_dof"), of("nees_per_dof_median"), of("rotation_nees_per_dof"), of("translation_nees_per_dof"),
      of("windows"), of("bound_low"), of("bound_high"));
}

void print(const std::string& label, const json& j) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  std::printf("%s: position NEES %.3f +- %.3f (3 dof; run averages inside %.1f %%, above %.1f %%, bounds %.2f %.2f)\n",
              label.c_str(), number("/nees_position/mean"), number("/nees_position/standard_error"),
              100 * number("/nees_position/inside_share"), 100 * number("/nees_position/above_share"),
              number("/nees_position/bound_low"), number("/nees_position/bound_high"));
  std::printf("  pose NEES %.3f (6 dof), NIS per dof %.3f, camera RMSE %.4f m, map RMSE %.4f m, state %g (end %g)\n",
              number("/nees_pose/mean"), number("/nis_per_dof"), number("/camera_rmse_m"), number("/map_rmse_m"),
              number("/state_dim/median"), number("/state_dim/end"));
  print_motion(j["motion"]);
  std::printf(
      "  gauge information grew: translation, rotation %.2e; scale %.2e (less the depth priors %.2e; in "
      "one frame without births %.2e)\n",
      number("/gauge_growth/translation_rotation"), number("/gauge_growth/scale"),
      number("/gauge_growth/scale_beyond_depth_priors"), number("/gauge_growth/scale_one_frame_without_births"));
  if (number("/planes/ever") > 0) {
    std::printf(
        "  active state end %g, the same map unfolded %g; %.1f points folded, %.1f of them fixed, NEES %.2f (3 dof)\n",
        number("/active_dim/end"), number("/state_dim_points_only/end"), number("/folded_points/per_run"),
        number("/folded_points/fixed_per_run"), number("/folded_points/nees"));
    std::printf(
        "  planes at the end: %g true, %g mixed, %g false, %g twice; ever %g, true %g, false %g; %g of %g walls; NEES "
        "%.2f\n",
        number("/planes/true"), number("/planes/mixed"), number("/planes/false"), number("/planes/duplicate"),
        number("/planes/ever"), number("/planes/ever_true"), number("/planes/ever_false"),
        number("/planes/walls_found"), number("/planes/walls_seen_well"), number("/planes/nees"));
  }
  if (number("/cost/update_20_rows_us") > 0)
    std::printf("  at the end: covariance %.0f kB, an update with 20 rows %.0f us, a frame with them %.0f us\n",
                1e-3 * number("/cost/covariance_bytes"), number("/cost/update_20_rows_us"),
                number("/cost/frame_20_rows_us"));
  if (number("/covariance_unsound") > 0)
    std::printf("  P was not positive definite at %g readings\n", number("/covariance_unsound"));
  std::printf("  %g runs of %g frames, %g lost, %.1f %% tracked, %g inliers, %.0f frames a second\n", number("/runs"),
              number("/frames"), number("/lost_runs"), 100 * number("/tracked_share"), number("/inliers_median"),
              number("/frames_per_second"));
}

bool write_json(const std::string& path, const json& j) {
  std::error_code error;  // that the file cannot be opened says enough
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), error);
  json signed_report = j;
  signed_report["written_by"] = "pf-sim";  // so that a later run may take its place (command_line.h)
  std::ofstream out(path);
  out << signed_report.dump(2) << "\n";
  return out.good();
}

}  // namespace pfsim
