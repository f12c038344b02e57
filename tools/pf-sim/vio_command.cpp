// pf-sim vio: a hand-held walk with an inertial unit, from rest and with nothing else known, against geometric truth.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "../lib/command_line.h"
#include "backend_option.h"
#include "commands.h"
#include "phone.h"
#include "planefold_platform/sim.h"
#include "report.h"
#include "statistics.h"
#include "vio_run.h"

namespace pfsim {
namespace {

using nlohmann::json;

constexpr double kSigmaMountRad = 2 * 3.14159265358979 / 180, kSigmaMountM = 0.02, kSigmaDelayS = 0.01,
                 kSigmaReadoutS = 0.01;
// Of what nobody tells, as pf-capture takes it.
constexpr double kUsualMountRad = 0.052, kUsualMountM = 0.03, kUsualDelayS = 0.06, kUsualReadoutS = 0.015,
                 kUsualScale = 0.01;
constexpr double kAnyMountRad = 3, kAnyMountM = 0.1;

struct Choices {
  BackendOption backend;
  VioOptions vio;
  int seeds = 20, jobs = 2;
  std::uint64_t first_seed = 1;
  double turn_deg_s = 0, vertical_deg = 0;
  bool no_imu = false, still = false;
  std::vector<std::string> estimate;   ///< of the unit: mount, delay
  std::vector<std::string> imu_exact;  ///< likewise, taken as told
  std::string unit = "laboratory";
  std::vector<std::string> parts;  ///< of a phone's unit
  double noise_scale = 1;
  std::string json_file, csv, fault = "none", start = "rest";
};

struct Job {
  const Choices* choices;
  FrameRow* rows;
  VioSummary* summaries;
};

int fail(const std::string& what, int code = 2) {
  std::fprintf(stderr, "pf-sim vio: %s\n", what.c_str());
  return code;
}

void run_one(int index, void* context) {
  const Job& job = *static_cast<Job*>(context);
  const auto frames = static_cast<std::size_t>(vio_frames(job.choices->vio));
  job.summaries[index] = run_vio(job.choices->vio, job.choices->first_seed + static_cast<std::uint64_t>(index),
                                 job.rows + static_cast<std::size_t>(index) * frames);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return -1;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

/// Of the runs that have the number; judged says how many these are.
json of_all(const VioSummary* s, int seeds, double VioSummary::*field) {
  std::vector<double> values;
  for (int i = 0; i < seeds; ++i)
    if (s[i].*field >= 0) values.push_back(s[i].*field);
  return {{"median", quantile(values, 0.5)},
          {"p95", quantile(values, 0.95)},
          {"max", quantile(values, 1)},
          {"judged", values.size()}};
}

/// Share of the run averages of the pose NEES above the 97.5 % bound, by frame.
double share_above(const Choices& c, const FrameRow* rows) {
  const int frames = vio_frames(c.vio);
  int above = 0, judged = 0;
  for (int f = 0; f < frames; ++f) {
    double sum = 0;
    int n = 0;
    for (int s = 0; s < c.seeds; ++s) {
      const float nees =
          rows[static_cast<std::size_t>(s) * static_cast<std::size_t>(frames) + static_cast<std::size_t>(f)].nees_pose;
      if (!(nees >= 0)) continue;
      sum += nees;
      ++n;
    }
    if (n == 0) continue;
    ++judged;
    above += sum > chi_square_quantile(0.975, 6.0 * n);
  }
  return judged > 0 ? static_cast<double>(above) / judged : -1;
}

/// Starts from a moving camera. Wrong: by over 5 % in scale or 2 degrees in gravity when it was believed.
json of_starts(const VioSummary* s, int seeds) {
  constexpr double kScale = 0.05, kTilt = 2 * 3.14159265358979 / 180;
  int good = 0, accepted = 0, wrong = 0, poor = 0;
  double nees = 0;
  std::vector<double> at, scale, tilt;
  for (int i = 0; i < seeds; ++i) {
    const bool yes = s[i].start_s >= 0;
    good += s[i].poor == 0;
    accepted += yes && s[i].poor == 0;
    poor += yes && s[i].poor != 0;
    if (!yes) continue;
    wrong += s[i].start_scale_error > kScale || s[i].start_tilt_rad > kTilt;
    at.push_back(s[i].start_s);
    if (s[i].start_scale_error >= 0) {  // features enough have a depth
      nees += std::pow(s[i].start_scale_error / s[i].start_scale_sigma, 2);
      scale.push_back(s[i].start_scale_error);
    }
    tilt.push_back(s[i].start_tilt_rad * 180 / 3.14159265358979);
  }
  return {
      {"tried", seeds},
      {"good", good},
      {"accepted", accepted},
      {"accepted_poor", poor},
      {"wrong", wrong},
      {"scale_nees", nees / std::max(1, static_cast<int>(scale.size()))},
      {"at_s", {{"median", quantile(at, 0.5)}, {"max", quantile(at, 1)}}},
      {"scale_error", {{"median", quantile(scale, 0.5)}, {"p95", quantile(scale, 0.95)}, {"max", quantile(scale, 1)}}},
      {"tilt_deg", {{"median", quantile(tilt, 0.5)}, {"p95", quantile(tilt, 0.95)}, {"max", quantile(tilt, 1)}}}};
}

json summarise_vio(const Choices& c, const FrameRow* rows, const VioSummary* s) {
  Runs runs;
  runs.seeds = c.seeds;
  runs.frames = vio_frames(c.vio);
  runs.first_seed = c.first_seed;
  runs.rows = rows;
  json out = summarise_frames(runs);
  double gravity = 0, gyro = 0, accel = 0, frames = 0, growth = 0, imu = 0, whole = 0;
  std::vector<double> drift, again, doubted_at, metric_at;
  double doubted_s = 0, maps = 0;
  int lost = 0, started = 0, refused = 0;
  double tracked = 0;
  for (int i = 0; i < c.seeds; ++i) {
    gravity += s[i].nees_gravity;
    gyro += s[i].nees_gyro_bias;
    accel += s[i].nees_accel_bias;
    frames += s[i].unit_frames;
    growth = std::max(growth, s[i].gauge_growth);
    imu += s[i].imu_seconds;
    whole += s[i].frame_seconds;
    drift.push_back(s[i].end_error_m / s[i].path_m);
    lost += s[i].lost;
    refused += s[i].refused;
    started += s[i].metric_frame >= 0;
    if (s[i].metric_frame >= 0) metric_at.push_back(s[i].metric_frame / c.vio.rate_hz);
    tracked += s[i].frames_tracked;
    if (s[i].doubted_at_s >= 0) doubted_at.push_back(s[i].doubted_at_s);
    doubted_s += s[i].doubted_s;
    maps += s[i].maps;
    if (s[i].tracked_again_frame >= 0) again.push_back(s[i].tracked_again_frame - s[i].dark_end_frame + 1);
  }
  frames = std::max(1.0, frames);
  out["nees_pose"]["above_share"] = share_above(c, rows);
  out["nees_gravity"] = gravity / frames;
  out["nees_gyro_bias"] = gyro / frames;
  out["nees_accel_bias"] = accel / frames;
  out["drift_share"] = {{"median", quantile(drift, 0.5)}, {"p95", quantile(drift, 0.95)}};
  out["metric_at_s"] = {{"median", quantile(metric_at, 0.5)}, {"max", quantile(metric_at, 1)}};
  out["path_m"] = of_all(s, c.seeds, &VioSummary::path_m);
  out["scale_error_5s"] = of_all(s, c.seeds, &VioSummary::scale_error_5s);
  out["scale_error"] = of_all(s, c.seeds, &VioSummary::scale_error_end);
  out["wander_m"] = of_all(s, c.seeds, &VioSummary::wander_m);
  std::vector<VioSummary> in_degrees(s, s + c.seeds);
  for (VioSummary& one : in_degrees) one.wander_rad *= 180 / 3.14159265358979;
  out["wander_deg"] = of_all(in_degrees.data(), c.seeds, &VioSummary::wander_rad);
  out["worst_bias_sigmas"] = of_all(s, c.seeds, &VioSummary::worst_bias_sigmas);
  out["worst_sigmas"] = of_all(s, c.seeds, &VioSummary::worst_sigmas);
  double resting = 0;
  for (int i = 0; i < c.seeds; ++i) resting += s[i].resting_frames;
  out["resting_share"] = resting / (static_cast<double>(c.seeds) * runs.frames);
  out["gauge_growth"] = growth;
  std::vector<VioSummary> units(s, s + c.seeds);
  for (VioSummary& one : units) {
    if (one.mount_error_rad >= 0) one.mount_error_rad *= 180 / 3.14159265358979;
    if (one.delay_error_s >= 0) one.delay_error_s *= 1e3;
  }
  if (c.vio.told_mount_rad > 0) {
    out["mount_error_deg"] = of_all(units.data(), c.seeds, &VioSummary::mount_error_rad);
    out["mount_error_m"] = of_all(s, c.seeds, &VioSummary::mount_error_m);
  }
  if (c.vio.told_delay_s > 0) out["delay_error_ms"] = of_all(units.data(), c.seeds, &VioSummary::delay_error_s);
  if (c.vio.sigma_readout_s > 0) {
    std::vector<VioSummary> readouts(s, s + c.seeds);
    for (VioSummary& one : readouts)
      if (one.readout_error_s >= 0) one.readout_error_s *= 1e3;
    out["readout_error_ms"] = of_all(readouts.data(), c.seeds, &VioSummary::readout_error_s);
    out["readout_sigmas"] = of_all(readouts.data(), c.seeds, &VioSummary::readout_sigmas);
  }
  if (c.vio.told_mount_rad > 0 || c.vio.told_delay_s > 0)
    out["mount_sigmas"] = of_all(s, c.seeds, &VioSummary::mount_sigmas);
  for (VioSummary& one : units) {
    one.tilt_rad *= 180 / 3.14159265358979;
    one.tilt_rms_rad *= 180 / 3.14159265358979;
  }
  out["tilt_deg"] = of_all(units.data(), c.seeds, &VioSummary::tilt_rad);
  out["tilt_rms_deg"] = of_all(units.data(), c.seeds, &VioSummary::tilt_rms_rad);
  VioPlanes planes;
  for (int i = 0; i < c.seeds; ++i) {
    const VioPlanes& p = s[i].planes;
    planes.right += p.right;
    planes.wrong += p.wrong;
    planes.unknown += p.unknown;
    planes.ever_wrong += p.ever_wrong;
    planes.early += p.early;
    planes.told += p.told;
    planes.refused += p.refused;
  }
  if (c.vio.rendered)
    out["planes"] = {{"right", planes.right},          {"wrong", planes.wrong},
                     {"unknown", planes.unknown},      {"wrong_in_frames", planes.ever_wrong},
                     {"before_gravity", planes.early}, {"told_vertical", planes.told},
                     {"refused", planes.refused}};
  out["starts"] = {{"tried", c.seeds}, {"accepted", started}};
  if (c.vio.moving) out["starts"] = of_starts(s, c.seeds);
  out["doubt"] = {{"runs", doubted_at.size()},
                  {"at_s", {{"median", quantile(doubted_at, 0.5)}, {"max", quantile(doubted_at, 1)}}},
                  {"mean_s", doubted_s / c.seeds},
                  {"maps_per_run", maps / c.seeds}};
  out["lost_runs"] = lost;
  out["refused"] = refused;
  out["tracked_share"] = tracked / (static_cast<double>(c.seeds) * runs.frames);
  out["imu_us_per_frame"] = 1e6 * imu / (static_cast<double>(c.seeds) * runs.frames);
  out["imu_share_of_frame"] = whole > 0 ? imu / whole : 0;
  if (c.vio.blackout_s > 0)
    out["frames_until_tracked_again"] = {
        {"median", quantile(again, 0.5)}, {"max", quantile(again, 1)}, {"runs", again.size()}};
  return out;
}

void print_vio(const json& j, bool with_imu) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  std::printf("vio: pose NEES %.2f (6 dof, %.1f %% of frames above their bound), position %.2f (3 dof)\n",
              number("/nees_pose/mean"), 100 * number("/nees_pose/above_share"), number("/nees_position/mean"));
  if (with_imu)
    std::printf("  NEES of gravity %.2f (2), gyro bias %.2f (3), accelerometer bias %.2f (3); gauge grew %.1e\n",
                number("/nees_gravity"), number("/nees_gyro_bias"), number("/nees_accel_bias"),
                number("/gauge_growth"));
  std::printf(
      "  drift %.3f %% of %.1f m (95 %%: %.3f %%); scale off by %.2f %% after 5 s (95 %%: %.2f), %.2f %% at the end\n",
      100 * number("/drift_share/median"), number("/path_m/median"), 100 * number("/drift_share/p95"),
      100 * number("/scale_error_5s/median"), 100 * number("/scale_error_5s/p95"), 100 * number("/scale_error/median"));
  std::printf(
      "  error at most %.1f of its sigma (median of runs %.1f); %g lost, %.1f %% tracked; samples %.0f us a frame\n",
      number("/worst_sigmas/max"), number("/worst_sigmas/median"), number("/lost_runs"), 100 * number("/tracked_share"),
      number("/imu_us_per_frame"));
  if (with_imu)
    std::printf("  gravity off by %.3f degrees at the end (largest %.3f), %.3f over the run (%.3f)\n",
                number("/tilt_deg/median"), number("/tilt_deg/max"), number("/tilt_rms_deg/median"),
                number("/tilt_rms_deg/max"));
  if (j.contains("planes"))
    std::printf(
        "  planes at the end: %g of the right class, %g wrong, %g unknown; wrong in %g frames, %g had one before "
        "gravity "
        "was known; %g constrained to be vertical, %g rejected\n",
        number("/planes/right"), number("/planes/wrong"), number("/planes/unknown"), number("/planes/wrong_in_frames"),
        number("/planes/before_gravity"), number("/planes/told_vertical"), number("/planes/refused"));
  if (j.contains("mount_error_deg"))
    std::printf("  mounting off by %.3f degrees (largest %.3f) and %.1f mm (%.1f) at the end\n",
                number("/mount_error_deg/median"), number("/mount_error_deg/max"),
                1e3 * number("/mount_error_m/median"), 1e3 * number("/mount_error_m/max"));
  if (j.contains("delay_error_ms"))
    std::printf("  delay off by %.3f ms (largest %.3f)\n", number("/delay_error_ms/median"),
                number("/delay_error_ms/max"));
  if (j.contains("readout_error_ms"))
    std::printf("  readout off by %.3f ms (largest %.3f) 10 s after the scale is known, at most %.1f of its sigma\n",
                number("/readout_error_ms/median"), number("/readout_error_ms/max"), number("/readout_sigmas/max"));
  if (j.contains("mount_sigmas"))
    std::printf("  of these an axis is at most %.1f of its sigma off (median of runs %.1f)\n",
                number("/mount_sigmas/max"), number("/mount_sigmas/median"));
  if (number("/doubt/runs") > 0)
    std::printf(
        "  the unit was rejected in %g runs, first at %.2f s (at the latest %.2f), for %.1f s a run; %g maps a run\n",
        number("/doubt/runs"), number("/doubt/at_s/median"), number("/doubt/at_s/max"), number("/doubt/mean_s"),
        number("/doubt/maps_per_run"));
  if (j.contains("frames_until_tracked_again"))
    std::printf("  tracked again in frame %g with light (at most %g), in %g runs\n",
                number("/frames_until_tracked_again/median"), number("/frames_until_tracked_again/max"),
                number("/frames_until_tracked_again/runs"));
}

/// A camera that rests to the end: how far it wanders. True where it stays within 2 mm and 0.1 degrees, with biases inside of 3 sigma; on
/// a turntable, where it is never held.
bool print_still(const json& j, bool turns) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  const bool stays = number("/wander_m/max") < 0.002 && number("/wander_deg/max") < 0.1;
  const bool inside = number("/worst_bias_sigmas/max") < 3;
  const bool good = turns ? number("/resting_share") == 0 : stays && inside;
  std::printf(
      "still: position wanders by %.2f mm (largest %.2f), rotation by %.3f degrees (largest %.3f), biases at most %.1f "
      "sigma off (NEES %.2f, %.2f); held in %.1f %% of frames\nverdict: %s\n",
      1e3 * number("/wander_m/median"), 1e3 * number("/wander_m/max"), number("/wander_deg/median"),
      number("/wander_deg/max"), number("/worst_bias_sigmas/max"), number("/nees_gyro_bias"),
      number("/nees_accel_bias"), 100 * number("/resting_share"), good ? "yes" : "no");
  return good;
}

bool print_starts(const json& j) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  const double accepted = number("/starts/accepted"), poor = number("/starts/accepted_poor");
  const bool good = accepted >= 0.88 * number("/starts/good") && number("/starts/wrong") <= 0.05 * (accepted + poor) &&
                    poor <= 0.1 * (number("/starts/tried") - number("/starts/good"));
  std::printf(
      "starts while it moves: accepted in %g of %g, and in %g of %g whose motion does not show the scale; %g of them "
      "wrong; after %.2f s "
      "(at the "
      "latest %.2f), scale off by %.2f %% (95 %%: %.2f, largest %.2f; NEES %.2f of 1), gravity by %.2f degrees (%.2f, "
      "%.2f)\nverdict: %s\n",
      accepted, number("/starts/good"), poor, number("/starts/tried") - number("/starts/good"), number("/starts/wrong"),
      number("/starts/at_s/median"), number("/starts/at_s/max"), 100 * number("/starts/scale_error/median"),
      100 * number("/starts/scale_error/p95"), 100 * number("/starts/scale_error/max"), number("/starts/scale_nees"),
      number("/starts/tilt_deg/median"), number("/starts/tilt_deg/p95"), number("/starts/tilt_deg/max"),
      good ? "yes" : "no");
  return good;
}

void print_fault(const json& j) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  std::printf(
      "  fault %s: from 5 s after its beginning on %.1f %% tracked, %.1f %% in metres with pose NEES %.2f and error at "
      "most "
      "%.1f of its sigma; %g samples rejected\n",
      j.at("fault").at("name").get<std::string>().c_str(), 100 * number("/fault/tracked_after"),
      100 * number("/fault/metric_after"), number("/fault/nees_after"), number("/fault/worst_sigmas_after"),
      number("/fault/refused_samples"));
}

/// Bounds that the simulated unit should meet: lib/docs/theory/inertial.md.
bool verdict(const Choices& c, const json& j) {
  const auto number = [&](const char* path) { return j.at(json::json_pointer(path)).get<double>(); };
  const double nees = number("/nees_pose/mean");
  const bool honest = nees >= 4.6 && nees <= 7.6 && number("/nees_pose/above_share") <= 0.1;
  const bool scaled = number("/scale_error_5s/p95") >= 0 && number("/scale_error_5s/p95") < 0.01;
  const bool stays = number("/drift_share/median") < 0.003;
  const bool all = number("/lost_runs") == 0 && number("/starts/accepted") == c.seeds;
  std::printf("verdict: %s (pose NEES %s, scale %s, drift %s, starts %s)\n",
              honest && scaled && stays && all ? "yes" : "no", honest ? "yes" : "no", scaled ? "yes" : "no",
              stays ? "yes" : "no", all ? "yes" : "no");
  return honest && scaled && stays && all;
}

/// What became of a fault, over all runs.
json of_fault(const Choices& c, const VioSummary* s) {
  double nees = 0, frames = 0, judged = 0, tracked = 0, worst = 0, refused = 0;
  for (int i = 0; i < c.seeds; ++i) {
    nees += s[i].nees_after;
    frames += s[i].frames_after;
    judged += s[i].judged_after;
    tracked += s[i].tracked_after;
    worst = std::max(worst, s[i].worst_sigmas_after);
    refused += s[i].refused_samples;
  }
  frames = std::max(1.0, frames);
  return {{"name", c.fault},
          {"at_s", c.vio.fault_at_s},
          {"nees_after", judged > 0 ? nees / judged : -1},
          {"metric_after", judged / frames},
          {"worst_sigmas_after", worst},
          {"tracked_after", tracked / frames},
          {"refused_samples", refused}};
}

/// "" when all is well. Near what is told where --estimate says so, as told where --imu-exact does, and else as people know it.
std::string choose_unit(Choices* c) {
  const auto has = [](const std::vector<std::string>& list, const char* what) {
    return std::find(list.begin(), list.end(), what) != list.end();
  };
  VioOptions& o = c->vio;
  for (const std::string& what : c->estimate)
    if (what != "mount" && what != "delay" && what != "readout" && what != "scale")
      return "--estimate " + what + ": write mount, delay, readout, scale or some of them, as mount,delay";
  for (const std::string& what : c->imu_exact) {
    if (what != "mount" && what != "delay" && what != "scale")
      return "--imu-exact " + what + ": write mount, delay, scale or some of them, as mount,delay";
    if (has(c->estimate, what.c_str()))
      return "--imu-exact " + what + " and --estimate " + what + " exclude each other";
  }
  if (c->unit != "laboratory" && c->unit != "phone") return "--unit " + c->unit + ": write laboratory or phone";
  if (o.axes > 23) return "--axes is 0 to 23";
  if (o.axes >= 0 && (has(c->imu_exact, "mount") || has(c->estimate, "mount")))
    return "--axes are not given to the filter: leave mount out of --imu-exact and --estimate";
  o.phone = c->unit == "phone";
  if (!o.phone && !c->parts.empty()) return "--parts are those of --unit phone; add that";
  const std::string no_part = choose_parts(c->parts, &o.phone_parts);
  if (!no_part.empty()) return "--parts " + no_part + ": write some of scale, cross, noise, delay, jitter, mount, rows";
  const bool usual = c->estimate.empty();
  if (has(c->estimate, "mount")) {
    o.sigma_mount_rad = o.told_mount_rad = kSigmaMountRad;
    o.sigma_mount_m = o.told_mount_m = kSigmaMountM;
  } else if (o.axes >= 0 || (usual && !has(c->imu_exact, "mount"))) {
    o.told_mount_rad = o.axes >= 0 ? kAnyMountRad : kUsualMountRad;
    o.told_mount_m = o.axes >= 0 ? kAnyMountM : kUsualMountM;
  }
  if (has(c->estimate, "delay"))
    o.sigma_delay_s = o.told_delay_s = kSigmaDelayS;
  else if (usual && !has(c->imu_exact, "delay"))
    o.told_delay_s = kUsualDelayS;
  if (has(c->estimate, "scale") || (usual && !has(c->imu_exact, "scale"))) o.told_scale = kUsualScale;
  if (has(c->estimate, "readout")) o.sigma_readout_s = kSigmaReadoutS;
  if (!o.phone || !o.phone_parts.rows) return "";
  if (o.sigma_readout_s > 0 || o.as_global || o.readout_s > 0)
    return "--unit phone has rows of its own; leave --readout, --as-global and --estimate readout away";
  o.readout_s = kPhoneReadout;
  o.told_readout_s = 0;
  o.sigma_readout_s = kUsualReadoutS;
  return "";
}

/// An option that is given beside none that it belongs to, in one line; "": there is none.
std::string unused_option(const CLI::App& command, const Choices& c) {
  const auto given = [&](const char* name) { return command.count(name) > 0; };
  if (given("--fault-at") && c.fault == name_of(VioFault::kNone)) return "--fault-at needs --fault";
  for (const char* name : {"--scene", "--shake"})
    if (given(name) && !c.vio.rendered) return std::string(name) + " is for --rendered";
  for (const char* name : {"--delay", "--estimate", "--imu-exact", "--unit", "--axes", "--fault"})
    if (given(name) && c.no_imu) return std::string(name) + " is of samples, which --no-imu leaves away";
  return "";
}

int run(Choices c) {
  const VioOptions& o = c.vio;
  c.vio.window = c.backend.is_window();
  if (c.seeds < 1 || c.seeds > 10000) return fail("--seeds is 1 to 10000");
  if (c.jobs < 1) return fail("--jobs is 1 or more");
  if (!(o.seconds > 1 && o.seconds <= 3600)) return fail("--seconds is above 1 and at most 3600");
  if (o.points < 50) return fail("--points is 50 or more");
  if (!(o.rate_hz >= 1 && o.rate_hz <= 200)) return fail("--rate is 1 to 200 frames a second");
  if (!(o.imu.rate_hz >= 20 && o.imu.rate_hz <= 2000)) return fail("--imu-rate is 20 to 2000 samples a second");
  if (!(o.imu.delay_s >= -0.5 && o.imu.delay_s <= 0.5)) return fail("--delay is -0.5 to 0.5 seconds");
  if (!(o.sigma_px >= 0.01 && o.sigma_px <= 10)) return fail("--sigma-px is 0.01 to 10 pixels");
  if (!(c.noise_scale > 0)) return fail("--noise-scale is above 0");
  for (int i = 0; i < static_cast<int>(VioFault::kCount); ++i)
    if (c.fault == name_of(static_cast<VioFault>(i))) c.vio.fault = static_cast<VioFault>(i);
  if (c.fault != name_of(c.vio.fault)) {
    std::string names;
    for (int i = 1; i < static_cast<int>(VioFault::kCount); ++i)
      names += (i > 1 ? ", " : "") + std::string(name_of(static_cast<VioFault>(i)));
    return fail("--fault " + c.fault + ": write one of " + names);
  }
  if (c.vio.fault != VioFault::kNone && !(o.fault_at_s >= 0 && o.fault_at_s + 6 < o.seconds))
    return fail("--fault-at is 0 seconds or more, and at least 6 before the end");
  if (c.start != "rest" && c.start != "moving") return fail("--start " + c.start + ": write rest or moving");
  c.vio.moving = c.start == "moving";
  if (c.vio.moving && c.still) return fail("--start moving does not go with --still");
  if (c.still) c.vio.rest_s = o.seconds + 1;
  c.vio.use_imu = !c.no_imu;
  const std::string wrong = choose_unit(&c);
  if (!wrong.empty()) return fail(wrong);
  if (!(o.readout_s >= 0 && o.readout_s <= 0.1)) return fail("--readout is 0 to 0.1 seconds");
  if (o.as_global && o.sigma_readout_s > 0) return fail("--as-global does not go with --estimate readout");
  if (o.told_readout_s < 0 && o.sigma_readout_s > 0 && o.readout_s <= kSigmaReadoutS)
    return fail(
        "--estimate readout: the rows of a camera that is known to take 10 ms less; add --readout S above 0.01");
  pf_sim_options_t scene;
  if (o.rendered && pf_sim_options_default(o.scene.c_str(), &scene) != PF_OK)
    return fail("--scene: " + no_scene(o.scene));
  if (!(o.shake >= 0 && o.shake <= 10)) return fail("--shake is 0 to 10 times what a scene's hand does");
  if (!(c.vertical_deg >= 0 && c.vertical_deg < 28)) return fail("--vertical is 0 to 28 degrees");
  c.vio.sigma_vertical_rad = c.vertical_deg * 3.14159265358979 / 180;
  c.vio.turn_rad_s = c.turn_deg_s * 3.14159265358979 / 180;
  for (double* density :
       {&c.vio.imu.gyro_density, &c.vio.imu.accel_density, &c.vio.imu.gyro_walk, &c.vio.imu.accel_walk})
    *density *= c.noise_scale;
  const auto frames = static_cast<std::size_t>(vio_frames(o)), seeds = static_cast<std::size_t>(c.seeds);
  Job job{&c, static_cast<FrameRow*>(shared_memory(seeds * frames * sizeof(FrameRow))),
          static_cast<VioSummary*>(shared_memory(seeds * sizeof(VioSummary)))};
  if (job.rows == nullptr || job.summaries == nullptr) return fail("no memory", 1);
  if (!in_processes(c.seeds, c.jobs, "vio", run_one, &job)) return fail("a run did not come to its end", 1);
  for (int i = 0; i < c.seeds; ++i)
    if (job.summaries[i].done == 0) return fail("the library rejected the config of a run", 1);
  json out = summarise_vio(c, job.rows, job.summaries);
  out["experiment"] = "vio";
  out["settings"] = {{"seconds", o.seconds},
                     {"rate_hz", o.rate_hz},
                     {"imu_rate_hz", o.imu.rate_hz},
                     {"noise_scale", c.noise_scale},
                     {"rest_s", o.rest_s},
                     {"sigma_px", o.sigma_px},
                     {"rendered", o.rendered},
                     {"delay_s", o.imu.delay_s},
                     {"estimate", c.estimate},
                     {"imu", c.vio.use_imu},
                     {"backend", c.backend.name},
                     {"first_seed", c.first_seed},
                     {"blackout_at_s", o.blackout_at_s},
                     {"blackout_s", o.blackout_s},
                     {"readout_s", o.readout_s}};
  if (c.vio.fault != VioFault::kNone) out["fault"] = of_fault(c, job.summaries);
  if (!c.still) print_vio(out, c.vio.use_imu);
  if (c.vio.fault != VioFault::kNone) print_fault(out);
  out["verdict"] = c.vio.moving ? print_starts(out)
                   : c.still    ? print_still(out, c.turn_deg_s != 0)
                                : c.vio.use_imu && verdict(c, out);
  Runs runs;
  runs.seeds = c.seeds;
  runs.frames = static_cast<int>(frames);
  runs.first_seed = c.first_seed;
  runs.rows = job.rows;
  if (!c.csv.empty() && !write_csv(runs, c.csv, "vio")) return fail("cannot write to " + c.csv, 1);
  if (!c.json_file.empty() && !write_json(c.json_file, out)) return fail("cannot write " + c.json_file, 1);
  return 0;
}

}  // namespace

void add_vio(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  // As on a hand: beside the camera, other axes.
  c->vio.imu.R_BC = pf::sim::rotation_exp({0.02, -0.03, 1.55});
  c->vio.imu.p_BC = {0.05, -0.02, 0.03};
  CLI::App* command = app.add_subcommand("vio", "A hand-held walk with an inertial unit: NEES, scale and drift");
  c->backend.add_to(*command);
  command->add_option("--seeds", c->seeds, "how many runs");
  command->add_option("--first-seed", c->first_seed, "seed of the first run");
  command->add_option("--seconds", c->vio.seconds, "of each run");
  command->add_option("--rate", c->vio.rate_hz, "frames a second");
  command->add_option("--imu-rate", c->vio.imu.rate_hz, "samples a second");
  command->add_option("--noise-scale", c->noise_scale, "times the noise of EuRoC's unit, of truth and filter");
  command->add_option("--delay", c->vio.imu.delay_s, "of frames against samples, known [s]");
  command
      ->add_option("--estimate", c->estimate,
                   "mount, delay: drawn with 2 degrees, 2 cm and 10 ms, and estimated from there on; readout: known as "
                   "10 ms less than --readout, and estimated; scale: estimated from 1 %; the others are given exactly. "
                   "Without it "
                   "mounting and delay are estimated from 3 degrees, 3 cm and any delay within 0.2 s, and the sensors' "
                   "scales and axes from 1 %")
      ->delimiter(',');
  command->add_option("--imu-exact", c->imu_exact, "mount, delay, scale: given exactly, and not estimated")
      ->delimiter(',');
  command->add_option(
      "--unit", c->unit,
      "laboratory; or phone: scales off by 1 %, axes by 0.5 %, three times the noise, 50 ms early with "
      "a jitter of 1 ms, 2 degrees off, and rows read out over 20 ms, of all of which the filter is given nothing");
  command
      ->add_option(
          "--parts", c->parts,
          "of that, scale, cross, noise, delay, jitter, mount, rows or some of them; the others are given exactly")
      ->delimiter(',');
  command->add_option("--axes", c->vio.axes, "0 to 23: the unit's axes, which the filter is not given")
      ->check(pf::capture::whole_number_in(0, 23));
  command->add_option(
      "--start", c->start,
      "rest; or moving: it moves from the first frame on, in every tenth run too evenly to measure the scale");
  command->add_option("--rest", c->vio.rest_s, "at the beginning [s]");
  command->add_option("--readout", c->vio.readout_s, "of a rolling shutter, from the first row to the last [s]");
  command->add_flag("--as-global", c->vio.as_global, "the filter takes the shutter as global, for comparison");
  command->add_option("--sigma-px", c->vio.sigma_px, "measurement noise [px]");
  command->add_option("--points", c->vio.points, "of the room");
  command->add_option("--blackout-at", c->vio.blackout_at_s, "when the lens is covered [s]");
  command->add_option("--blackout", c->vio.blackout_s, "for how long [s]; 0: never");
  command->add_option(
      "--fault", c->fault,
      "gap, stop, late, repeated, disorder, saturated, jitter, scale, clock-jump, frames-stop, reversed or mount");
  command->add_option("--fault-at", c->vio.fault_at_s, "when it begins, where it has a beginning [s]");
  command->add_flag("--rendered", c->vio.rendered, "pictures of a scene, in place of points");
  command->add_option("--scene", c->vio.scene, "of --rendered: room, desk, street, ...");
  command->add_option("--shake", c->vio.shake, "times what the hand of that scene shakes");
  command->add_option("--vertical", c->vertical_deg,
                      "planes found to be vertical are constrained to be so, within this [degrees]; 0: they are not");
  command->add_flag("--still", c->still, "the camera rests to the end");
  command->add_option("--turn", c->turn_deg_s, "of a turntable on which the camera rests otherwise [degrees/s]");
  command->add_flag("--hand", c->vio.hand, "24 points of a hand wave 0.4 m before the lens");
  command->add_flag("--no-imu", c->no_imu, "the same walk with the constant-velocity model, up to scale");
  command->add_option("--jobs", c->jobs, "processes at a time");
  command->add_option("--json", c->json_file, "report to write")->check(pf::tools::writable_file());
  command->add_option("--csv", c->csv, "folder for per-frame tables")->check(pf::tools::writable_folder());
  command->callback([c, command, &result] {
    const std::string unused = unused_option(*command, *c);
    result = unused.empty() ? run(*c) : fail(unused);
  });
}

}  // namespace pfsim
