#include "kidnap_report.h"

#include <algorithm>
#include <cstdio>

#include "statistics.h"

namespace pfsim {
namespace {

using nlohmann::json;

constexpr int kManyInView = 20;  // old features, projected or measured, that make a place one that can be found again
constexpr double kFoundWithin_s = 1;
constexpr double kRounding = 1e-6;  // of a ratio of standard deviations

const char* name_of(Return then) { return then == Return::kOn ? "on" : then == Return::kBack ? "back" : "elsewhere"; }

std::string label_of(const GapCase& c) {
  char text[64];
  std::snprintf(text, sizeof text, "%s_%gs_%s", c.picture == GapPicture::kBlack ? "black" : "elsewhere", c.seconds,
                name_of(c.then));
  return text;
}

bool is_found(const Trial& t, double interval_s) {
  return t.tracked_after >= 0 && t.tracked_after * interval_s <= kFoundWithin_s;
}

json trial_report(const GapCase& gap, int frame, const Trial& t, double interval_s) {
  return {{"case", label_of(gap)},
          {"frame", frame},
          {"tracked_after_frames", t.tracked_after},
          {"found_within_1_s", is_found(t, interval_s)},
          {"wrong", is_wrong(t.worst_deg, t.worst_depths)},
          {"wrong_and_confident", is_wrong_and_confident(t)},
          {"old_features", t.old_ids},
          {"old_in_view", t.old_in_view},
          {"old_measured", t.old_measured},
          {"in_view", t.old_measured >= kManyInView},
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
      in_view = 0, found = 0, measured = 0, found_of_measured = 0;
  double least_growth = 1, least_taken_in = 1;
  double old_ids = 0, kept_ids = 0;
  std::vector<double> delay_s;

  void add(const Trial& t, double interval_s) {
    const double bound = five_sigma_bound();
    if (!t.done) return;
    ++trials;
    tracking_again += t.tracked_after >= 0;
    if (t.tracked_after >= 0) delay_s.push_back(t.tracked_after * interval_s);
    beyond += t.worst_normalised > bound;
    wrong += is_wrong(t.worst_deg, t.worst_depths);
    wrong_and_beyond += is_wrong_and_confident(t);
    shrinks += t.least_growth < 1 - kRounding;
    least_growth = std::min(least_growth, t.least_growth);
    taken_in += t.least_taken_in < 1 - kRounding;
    least_taken_in = std::min(least_taken_in, t.least_taken_in);
    old_ids += t.old_ids;
    kept_ids += t.kept_ids;
    const bool again = is_found(t, interval_s), many = t.old_in_view >= kManyInView;
    in_view += many;
    found += many && again;
    const bool sees = t.old_measured >= kManyInView;
    measured += sees;
    found_of_measured += sees && again;
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
            {"found_within_1_s", found},
            {"many_measured", measured},
            {"found_of_measured", found_of_measured}};
  }
};

void print_row(const std::string& label, const json& j) {
  const auto number = [&](const char* name) { return j[name].is_null() ? -1.0 : j[name].get<double>(); };
  std::printf("%-20s %6.0f %8.0f %7.2f %8.0f %6.0f %6.0f %8.0f %6.3f %6.0f %6.1f %6.0f/%-5.0f %5.0f/%-5.0f\n",
              label.c_str(), number("trials"), number("tracking_again"), number("delay_s_median"),
              number("beyond_5_sigma"), number("wrong"), number("wrong_beyond_5_sigma"), number("covariance_shrinks"),
              number("least_covariance_growth"), number("shrinks_below_prediction"), 100 * number("ids_kept"),
              number("found_within_1_s"), number("many_in_view"), number("found_of_measured"), number("many_measured"));
}

json summarise_random(const KidnapResult& job) {
  const std::size_t starts = job.reference.starts.size();
  int frames = 0, tracking = 0, in_map = 0, judged = 0, right = 0, confident = 0, turns = 0, turns_wrong = 0;
  json wrong = json::array();
  for (int r = 0; r < job.options.random_runs && starts > 0; ++r) {
    frames += job.random[r].frames;
    tracking += job.random[r].tracking;
    in_map += job.random[r].in_map;
    judged += job.random[r].judged;
    right += job.random[r].right;
    confident += job.random[r].confident;
    const int listed = std::min(job.random[r].judged - job.random[r].right, RandomOrder::kMaxWrong);
    for (int k = 0; k < listed; ++k) {
      const RandomOrder::Wrong& w = job.random[r].wrong[k];
      wrong.push_back({{"run", r},
                       {"at", w.at},
                       {"frame", w.frame},
                       {"deg", w.deg},
                       {"depths", w.depths},
                       {"normalised", w.normalised},
                       {"log_odds", w.log_odds}});
    }
    turns += job.random[r].turns;
    turns_wrong += job.random[r].turns_wrong;
  }
  json out = {{"frames", frames},
              {"tracking", tracking},
              {"in_the_old_map", in_map},
              {"judged", judged},
              {"right", right},
              {"wrong_and_confident", confident},
              {"wrong", wrong},
              {"turns", turns},
              {"turns_wrong", turns_wrong},
              {"tracking_share", frames > 0 ? static_cast<double>(tracking) / frames : 0.0}};
  std::printf(
      "random order: %d of %d frames tracking (%.2f %%), %d of them in the old map; %d of %d that can be judged are "
      "where they should be, %d are wrong and confident; %d of %d turns between two of them are wrong\n",
      tracking, frames, frames > 0 ? 100.0 * tracking / frames : 0.0, in_map, right, judged, confident, turns_wrong,
      turns);
  return out;
}

}  // namespace

nlohmann::json summarise_kidnap(const KidnapResult& job) {
  const double interval_s = static_cast<double>(job.film.interval_ns()) * 1e-9;
  const std::vector<GapCase>& cases = gap_cases();
  const std::size_t starts = job.reference.starts.size();
  json out, doubtful = json::array(), gaps = json::array();
  Tally all, second;
  std::printf("%-20s %6s %8s %7s %8s %6s %6s %8s %6s %6s %6s %12s %11s\n", "gap", "trials", "tracking", "after s",
              "5 sigma", "wrong", "both", "shrinks", "least", "taken", "ids %", "found in 1 s", "of measured");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    Tally tally;
    for (std::size_t s = 0; s < starts; ++s) {
      const Trial& trial = job.trials[s * cases.size() + c];
      tally.add(trial, interval_s);
      all.add(trial, interval_s);
      if (!trial.done) continue;
      gaps.push_back(trial_report(cases[c], job.reference.starts[s].frame, trial, interval_s));
      if (is_wrong(trial.worst_deg, trial.worst_depths) || trial.least_growth < 1 - kRounding)
        doubtful.push_back(gaps.back());
      if (cases[c].picture == GapPicture::kBlack && cases[c].seconds == 1.0) second.add(trial, interval_s);
    }
    const std::string label = label_of(cases[c]);
    out["cases"][label] = tally.report();
    print_row(label, out["cases"][label]);
  }
  out["all"] = all.report();
  out["wrong_or_shrinking"] = doubtful;
  out["gaps"] = gaps;
  print_row("all", out["all"]);
  out["after_a_black_second"] = {{"many_in_view", second.in_view}, {"found_within_1_s", second.found}};

  double old_ids = 0, kept_ids = 0;
  for (std::size_t s = 0; s < starts; ++s) {
    old_ids += job.survivals[s].old_ids;
    kept_ids += job.survivals[s].kept_ids;
  }
  out["ids_kept_without_pictures"] = old_ids > 0 ? kept_ids / old_ids : 1.0;
  out["random_order"] = summarise_random(job);
  std::printf(
      "in view, by what the run without a gap measures: %d of %d found within %g s; wrong and confident in %d\n",
      all.found_of_measured, all.measured, kFoundWithin_s, all.wrong_and_beyond);
  std::printf("after a black second with %d old features in view: %d of %d found within %g s\n", kManyInView,
              second.found, second.in_view, kFoundWithin_s);
  std::printf("ids kept over %g s without a picture: %.1f %%\n", job.options.survive_s,
              100 * out["ids_kept_without_pictures"].get<double>());
  return out;
}

}  // namespace pfsim
