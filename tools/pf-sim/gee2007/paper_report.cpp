#include "paper_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "../statistics.h"

namespace pfsim::gee {
namespace {

using nlohmann::json;

constexpr double kPaperDof = 7;  // that the paper counts of a pose, by its quaternion

template <typename Get>
std::vector<double> at_frame(const PaperRuns& x, int frame, Get get) {
  std::vector<double> values;
  for (int s = 0; s < x.seeds; ++s) {
    const PaperRow& row = x.row(s, frame);
    const double v = static_cast<double>(get(row));
    if (row.state_dim > 0 && v >= 0 && std::isfinite(v)) values.push_back(v);
  }
  return values;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// Mean over runs and the frames [from, to).
template <typename Get>
double mean_over(const PaperRuns& x, int from, int to, Get get) {
  double sum = 0, count = 0;
  for (int f = from; f < to; ++f)
    for (const double v : at_frame(x, f, get)) {
      sum += v;
      count += 1;
    }
  return count > 0 ? sum / count : 0;
}

/// NEES with its bounds: run averages inside the two-sided 95 % of a perfect filter, and single values below its 95 %.
template <typename Get>
json nees_json(const PaperRuns& x, int dof, Get get) {
  int inside = 0, above = 0, frames = 0;
  double below_limit = 0, all = 0, sum = 0;
  std::vector<double> values;
  const double limit = chi_square_quantile(0.95, dof);
  std::vector<double> low(static_cast<std::size_t>(x.seeds) + 1), high(low.size());
  for (int n = 1; n <= x.seeds; ++n) {
    low[static_cast<std::size_t>(n)] = chi_square_quantile(0.025, dof * n) / n;
    high[static_cast<std::size_t>(n)] = chi_square_quantile(0.975, dof * n) / n;
  }
  for (int f = 0; f < x.frames; ++f) {
    const std::vector<double> now = at_frame(x, f, get);
    if (now.empty()) continue;
    const double m = mean(now);
    sum += m;
    ++frames;
    inside += m > low[now.size()] && m < high[now.size()];
    above += m >= high[now.size()];
    for (const double v : now) below_limit += v < limit;
    all += static_cast<double>(now.size());
    values.insert(values.end(), now.begin(), now.end());
  }
  const double n = std::max(1, frames);
  // Each run's own time mean, which the mean over runs hides.
  std::vector<double> means;
  for (int s = 0; s < x.seeds; ++s) {
    std::vector<double> of_run;
    for (int f = 0; f < x.frames; ++f) {
      const PaperRow& row = x.row(s, f);
      const double v = static_cast<double>(get(row));
      if (row.state_dim > 0 && v >= 0 && std::isfinite(v)) of_run.push_back(v);
    }
    if (!of_run.empty()) means.push_back(mean(of_run));
  }
  const auto below = [&](double bound) {
    return std::count_if(means.begin(), means.end(), [&](double m) { return m < bound; });
  };
  return {{"mean", sum / n},
          {"median", median(values)},
          {"seeds", means},
          {"seeds_below_95", below(limit)},
          {"seeds_below_paper_limit", below(chi_square_quantile(0.95, kPaperDof))},
          {"inside_share", inside / n},
          {"above_share", above / n},
          {"below_95_share", below_limit / std::max(1.0, all)},
          {"dof", dof}};
}

}  // namespace

json summarise(const PaperRuns& x) {
  const auto position = [](const PaperRow& r) { return r.nees_position; };
  const auto pose = [](const PaperRow& r) { return r.nees_pose; };
  const auto dimension = [](const PaperRow& r) { return r.state_dim; };
  const auto camera = [](const PaperRow& r) { return r.camera_square; };
  const auto map = [](const PaperRow& r) { return r.map_square; };
  json out;
  out["nees_position"] = nees_json(x, 3, position);
  out["nees_pose"] = nees_json(x, 6, pose);
  std::vector<double> all, ends;
  double measured = 0, frames_done = 0;
  for (int f = 0; f < x.frames; ++f)
    for (const double v : at_frame(x, f, dimension)) all.push_back(v);
  ends = at_frame(x, x.frames - 1, dimension);
  const json dim = {{"median", median(all)}, {"end", mean(ends)}, {"end_median", median(ends)}};
  out["state_dim"] = out["active_dim"] = dim;
  out["camera_rmse_m"] = std::sqrt(mean_over(x, 0, x.frames, camera));
  measured = mean_over(x, 0, x.frames, [](const PaperRow& r) { return r.measured; });
  const int last = x.frames - 1;
  out["map_rmse_m"] = std::sqrt(mean(at_frame(x, last, map)));
  out["measured_mean"] = measured;
  out["end"] = {{"inverse_depths", mean(at_frame(x, last, [](const PaperRow& r) { return r.inverse_depths; }))},
                {"points", mean(at_frame(x, last, [](const PaperRow& r) { return r.points; }))},
                {"planar", mean(at_frame(x, last, [](const PaperRow& r) { return r.planar; }))},
                {"fixed", mean(at_frame(x, last, [](const PaperRow& r) { return r.fixed; }))},
                {"planes", mean(at_frame(x, last, [](const PaperRow& r) { return r.planes; }))}};
  for (int from = 0; from < x.frames; from += x.frames_per_loop) {
    const int to = std::min(x.frames, from + x.frames_per_loop);
    out["loops"].push_back({{"frames", {from, to}},
                            {"nees_position", mean_over(x, from, to, position)},
                            {"nees_pose", mean_over(x, from, to, pose)},
                            {"camera_mse_m2", mean_over(x, from, to, camera)},
                            {"map_mse_m2", mean_over(x, from, to, map)},
                            {"map_mse_m2_end", mean(at_frame(x, to - 1, map))},
                            {"state_dim_end", mean(at_frame(x, to - 1, dimension))}});
  }
  int done = 0, right = 0, wrong = 0, duplicate = 0, unused = 0;
  double seconds = 0, share = 0;
  for (int s = 0; s < x.seeds; ++s) {
    const PaperSummary& r = x.summaries[s];
    done += r.done;
    right += r.planes_true;
    wrong += r.planes_false;
    duplicate += r.planes_duplicate;
    unused += r.planes_unused;
    share += r.wall_share_sum;
    seconds += r.cpu_seconds;
  }
  out["planes"] = {{"true", right},
                   {"false", wrong},
                   {"duplicate", duplicate},
                   {"unused", unused},
                   {"wall_share_mean", share / std::max(1, right + wrong + duplicate)}};
  for (int f = 0; f < x.frames; ++f) frames_done += static_cast<double>(at_frame(x, f, dimension).size());
  out["runs"] = x.seeds;
  out["lost_runs"] = x.seeds - done;
  out["frames"] = x.frames;
  out["frames_judged"] = frames_done;
  out["cpu_seconds_per_run"] = seconds / std::max(1, done);
  return out;
}

bool write_figure2(const PaperRuns& x, const std::string& path) {
  std::ofstream out(path);
  out << "frame,loop,state_dim,nees_position,nees_pose,nees_position_median,nees_pose_median,camera_mse_m2,map_mse_m2,"
         "inverse_depths,points,planar,fixed,planes,measured,runs\n";
  for (int f = 0; f < x.frames; ++f) {
    const auto column = [&](auto get) { return at_frame(x, f, get); };
    const auto nees = column([](const PaperRow& r) { return r.nees_position; });
    const auto nees_pose = column([](const PaperRow& r) { return r.nees_pose; });
    const auto dimension = column([](const PaperRow& r) { return r.state_dim; });
    out << f << ',' << f / x.frames_per_loop << ',' << mean(dimension) << ',' << mean(nees) << ',' << mean(nees_pose)
        << ',' << median(nees) << ',' << median(nees_pose) << ','
        << mean(column([](const PaperRow& r) { return r.camera_square; })) << ','
        << mean(column([](const PaperRow& r) { return r.map_square; })) << ','
        << mean(column([](const PaperRow& r) { return r.inverse_depths; })) << ','
        << mean(column([](const PaperRow& r) { return r.points; })) << ','
        << mean(column([](const PaperRow& r) { return r.planar; })) << ','
        << mean(column([](const PaperRow& r) { return r.fixed; })) << ','
        << mean(column([](const PaperRow& r) { return r.planes; })) << ','
        << mean(column([](const PaperRow& r) { return r.measured; })) << ',' << dimension.size() << '\n';
  }
  return out.good();
}

void print(const std::string& label, const json& j) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  std::printf(
      "%s: state %.0f at the end, position NEES %.2f (3 dof, median %.2f), pose NEES %.2f (6 dof, median %.2f)\n",
      label.c_str(), number("/state_dim/end"), number("/nees_position/mean"), number("/nees_position/median"),
      number("/nees_pose/mean"), number("/nees_pose/median"));
  std::printf("  camera RMSE %.4f m, map RMSE %.4f m at the end; %.1f points seen in a frame\n",
              number("/camera_rmse_m"), number("/map_rmse_m"), number("/measured_mean"));
  std::printf("  map at the end: %.1f inverse depths, %.1f points, %.1f planar, %.1f fixed, %.1f planes\n",
              number("/end/inverse_depths"), number("/end/points"), number("/end/planar"), number("/end/fixed"),
              number("/end/planes"));
  std::printf(
      "  planes of all runs: %g true, %g false, %g twice, %g without points; %g of %g runs lost; %.0f s a run\n",
      number("/planes/true"), number("/planes/false"), number("/planes/duplicate"), number("/planes/unused"),
      number("/lost_runs"), number("/runs"), number("/cpu_seconds_per_run"));
}

}  // namespace pfsim::gee
