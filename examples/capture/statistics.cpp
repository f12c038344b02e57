#include "statistics.h"

#include <planefold/planefold_research.h>
#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "plane_outputs.h"

namespace pf::capture {

namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kFoldingFrom = 60;  ///< frame: a map needs that long to have planes

double rounded(double value) { return std::round(value * 1e5) / 1e5; }

/// Fewer than four grey levels between the darkest and the brightest hundredth.
bool is_flat(const std::vector<uint8_t>& pixels) {
  size_t counts[256] = {};
  for (uint8_t pixel : pixels) {
    ++counts[pixel];
  }
  const size_t share = pixels.size() / 100;
  const auto level = [&](bool from_dark) {
    size_t sum = 0;
    int at = from_dark ? 0 : 255;
    while (at >= 0 && at < 256 && (sum += counts[at]) <= share) {
      at += from_dark ? 1 : -1;
    }
    return at;
  };
  return level(false) - level(true) < 4;
}

/// What the system calls it, and how many of them there are: "model name" on x86, "Model" of a board, or the architecture.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  std::string name;
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.find(':');
    if (colon != std::string::npos && (line.rfind("model name", 0) == 0 || line.rfind("Model", 0) == 0)) {
      name = line.substr(std::min(line.size(), colon + 2));
    }
  }
  utsname system{};
  if (name.empty() && uname(&system) == 0) {
    name = system.machine;
  }
  return name + " x " + std::to_string(std::thread::hardware_concurrency());
}

const char* kernels_name(int32_t kernels) {
  constexpr const char* kNames[] = {"auto", "reference", "portable", "avx2", "avx512", "neon"};
  return kernels >= 0 && kernels < 6 ? kNames[kernels] : "unknown";
}

Json camera_json(const pf_camera_t& camera) {
  constexpr const char* kModels[] = {"unknown", "pinhole", "radtan", "equidistant", "division"};
  return {{"model", kModels[camera.model >= 1 && camera.model <= 4 ? camera.model : 0]},
          {"width", camera.width},
          {"height", camera.height},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"readout_s", camera.readout_s},
          {"timestamps", camera.timestamps == PF_TIMESTAMPS_NOMINAL ? "nominal" : "real"}};
}

/// The calibration as the filter knows it at the end, with standard deviations; null where it was taken as exact.
Json lens_json(const pf_slam_t* slam) {
  pf_camera_t camera{};
  double covariance[100];
  if (pf_get_camera(slam, &camera, covariance) != PF_OK || camera.estimate == PF_CAMERA_EXACT) {
    return nullptr;
  }
  Json json = camera_json(camera);
  json["estimate"] = camera.estimate == PF_CAMERA_ESTIMATE ? "estimate" : "consider";
  json["distortion"] = std::vector<double>(camera.distortion, camera.distortion + 5);
  const auto sigma = [&](int i) { return std::sqrt(covariance[11 * i]); };
  json["sigma"] = {{"fx", sigma(0)},
                   {"fy", sigma(1)},
                   {"cx", sigma(2)},
                   {"cy", sigma(3)},
                   {"distortion", {sigma(4), sigma(5), sigma(6), sigma(7), sigma(8)}}};
  return json;
}

}  // namespace

void Statistics::add(const FrameView& view) {
  const pf_report_t& report = view.report;
  duplicates_ += report.duplicates > last_report_.duplicates ? 1 : 0;  // the library counts anew after a reset
  repairs_ += report.covariance_repairs > last_report_.covariance_repairs ? 1 : 0;  // likewise
  flat_ += is_flat(view.pixels) ? 1 : 0;
  if (view.tracked) {
    ++tracked_;
    last_tracked_ = view.index;
    const auto is_it = [&](const MapCount& count) { return count.map == view.map; };
    auto map = std::find_if(maps_.begin(), maps_.end(), is_it);
    if (map == maps_.end()) {
      map = maps_.insert(map, {view.map, view.index, 0});
    }
    ++map->tracked;
    start_frame_ = start_frame_ < 0 ? view.index : start_frame_;
    inliers_.add(report.inliers);
    attempts_.add(report.attempts);
    state_dim_.add(report.state_dim);
    add_folding(view);
  }
  add_patches(view);
  const bool untracked = !view.tracked;  // the first frames of a start may be tracked already
  starting_ += untracked && report.state == PF_STATE_STARTING ? 1 : 0;
  lost_ += untracked && report.state == PF_STATE_LOST ? 1 : 0;
  coasting_ += untracked && report.state != PF_STATE_STARTING && report.state != PF_STATE_LOST ? 1 : 0;
  losses_ += report.state == PF_STATE_LOST && last_state_ != PF_STATE_LOST ? 1 : 0;
  ++reasons_[std::clamp<int32_t>(report.reason, 0, PF_FRAME_REASON_LENS)];
  unusable_ += view.status == PF_NOTE_UNUSABLE ? 1 : 0;
  evicted_ += report.evicted;
  new_features_ += report.new_features;
  measured_ += report.inliers;
  learning_frames_ += report.templates > 0 ? 1 : 0;
  template_area_ += report.template_area;
  if (report.nis_dof > 0 && report.state == PF_STATE_TRACKING) {
    nis_ += report.nis;
    nis_dof_ += report.nis_dof;
  }
  ms_.add(view.ms);
  for (int i = 0; i < PF_STAGE_COUNT; ++i) {
    stage_ms_[i].add(1e-6 * static_cast<double>(report.stage_ns[i]));
  }
  last_state_ = report.state;
  last_report_ = report;
  last_planes_ = view.planes;
  last_hits_ = view.hits;
  ++frames_;
}

/// A patch is lost where it was found in the frame before, is looked for and not found; found again where that ends.
void Statistics::add_patches(const FrameView& view) {
  std::map<uint32_t, int32_t> now;
  int measured = 0;
  for (const pf_patch_t& patch : view.patches) {
    const auto before = last_patches_.find(patch.id);
    const bool was = before != last_patches_.end();
    const bool is_missed = patch.status == PF_MATCH_MISSED || patch.status == PF_MATCH_OUTLIER;
    measured += patch.status == PF_MATCH_INLIER;
    lost_patches_ += is_missed && was && before->second == PF_MATCH_INLIER;
    refound_patches_ += patch.status == PF_MATCH_INLIER && was && before->second == PF_MATCH_MISSED && patch.frames > 1;
    // What is out of view stays what it was.
    now[patch.id] = is_missed ? PF_MATCH_MISSED : patch.status != 0 || !was ? patch.status : before->second;
  }
  last_patches_ = std::move(now);
  if (view.tracked) {
    patches_.add(measured);
    cameras_.add(view.report.cameras);
  }
}

void Statistics::add_folding(const FrameView& view) {
  const pf_report_t& report = view.report;
  const int32_t folded = report.features_folded + report.features_fixed;
  folding_.first_plane = folding_.first_plane < 0 && report.planes > 0 ? view.index : folding_.first_plane;
  if (view.index < kFoldingFrom || report.features == 0 || report.state_dim_points_only == 0) {
    return;
  }
  ++folding_.frames;
  folding_.frames_plane += report.planes > 0 ? 1 : 0;
  folding_.share_folded += static_cast<double>(folded) / report.features;
  folding_.share_trial += static_cast<double>(report.features_trial) / report.features;
  folding_.share_saved += 1.0 - static_cast<double>(report.state_dim) / report.state_dim_points_only;
  planes_.add(report.planes);
  folded_.add(folded);
}

void Statistics::add_unreadable(const std::string& why) {
  constexpr size_t kNamed = 20;
  ++unreadable_;
  if (unreadable_lines_.size() < kNamed) {
    unreadable_lines_.push_back(why);
  }
}

std::string Statistics::unreadable_line() const {
  if (unreadable_ == 0) {
    return "";
  }
  std::string line = std::to_string(unreadable_) + (unreadable_ == 1 ? " image was" : " images were") +
                     " left out: " + unreadable_lines_[0];
  if (unreadable_ > 1) {
    line += "; report.json names them";
  }
  return line;
}

std::string Statistics::lost_line() const {
  const std::string counts = std::to_string(lost_) + " of " + std::to_string(frames_) + " frames";
  if (2 * lost_ > frames_) {
    return "the camera was lost most of the time, in " + counts + "; frames.csv says where";
  }
  if (tracked_ > 0 && last_state_ == PF_STATE_LOST) {
    return "the camera was lost at the end: frame " + std::to_string(last_tracked_) +
           " is the last that was tracked; frames.csv says where";
  }
  return "";
}

std::string Statistics::to_json(const Session& session, const Options& options, const SourceInfo& source,
                                const RelativeMotion& relative, const std::string& live, const std::string& imu,
                                const std::string& ended) const {
  constexpr const char* kStages[] = {"pyramid", "predict", "search", "gate", "update", "map"};
  const bool has_patches = session.config().capacity.max_patches > 0;
  Json stages = Json::object();
  for (int i = 0; i <= PF_STAGE_MAP; ++i) {
    stages[kStages[i]] = rounded(stage_ms_[i].quantile(0.5));
  }
  if (session.config().motion.model == PF_MOTION_INERTIAL) {
    stages["imu"] = rounded(stage_ms_[PF_STAGE_IMU].quantile(0.5));
  }
  if (has_patches) stages["patch"] = rounded(stage_ms_[PF_STAGE_PATCH].quantile(0.5));
  if (session.config().map.masks != PF_MASKS_NONE) {
    stages["template"] = rounded(stage_ms_[PF_STAGE_TEMPLATE].quantile(0.5));
  }
  const bool has_window = session.config().backend == PF_BACKEND_WINDOW;
  if (has_window) stages["adjust"] = rounded(stage_ms_[PF_STAGE_ADJUST].quantile(0.5));
  const auto mean_of = [&](double sum) {
    return folding_.frames > 0 ? Json(rounded(sum / static_cast<double>(folding_.frames))) : Json();
  };
  const pf_config_t& config = session.config();
  Json json;
  const uint32_t version = pf_version();
  json["version"] =
      std::to_string(version >> 16) + "." + std::to_string((version >> 8) & 255) + "." + std::to_string(version & 255);
  json["command"] = options.command;
  json["backend"] = has_window ? "window" : "filter";
  if (has_window) json["keyframes"] = last_report_.keyframes;
  json["processor"] = processor_name();
  json["source"] = options.source;
  json["frames"] = frames_;
  json["tracked"] = tracked_;
  json["lost"] = lost_;
  json["frames_by_state"] = {{"tracked", tracked_}, {"starting", starting_}, {"coasting", coasting_}, {"lost", lost_}};
  json["maps"] = Json::array();
  for (const MapCount& map : maps_) {
    const std::string end = map.map == 1 ? "" : "_" + std::to_string(map.map);
    json["maps"].push_back({{"map", map.map},
                            {"trajectory", "trajectory" + end + ".txt"},
                            {"start_frame", map.start_frame},
                            {"tracked", map.tracked}});
  }
  json["losses"] = losses_;
  json["resets"] = resets_;
  json["start_frame"] = start_frame_;
  json["start"] = session.start();
  json["unusable"] = unusable_ + unreadable_;
  json["unreadable"] = unreadable_lines_;
  json["unreadable_frames"] = unreadable_;
  json["skip"] = options.skip;
  json["flat"] = flat_;
  json["duplicates"] = duplicates_;
  json["covariance_repairs"] = repairs_;
  json["ms_per_frame"] = {
      {"median", rounded(ms_.quantile(0.5))}, {"p95", rounded(ms_.quantile(0.95))}, {"max", rounded(ms_.largest())}};
  json["ms_by_stage"] = stages;
  json["memory_bytes"] = session.memory().bytes;
  json["stack_bytes"] = session.memory().stack_bytes;
  json["features"] = {{"median", inliers_.quantile(0.5)}, {"max", inliers_.largest()}};
  json["features_in_view"] = {{"median", attempts_.quantile(0.5)}, {"max", attempts_.largest()}};
  json["features_in_map"] = {{"points", last_report_.features_point},
                             {"inverse_depth", last_report_.features_inverse_depth},
                             {"folded", last_report_.features_folded},
                             {"fixed", last_report_.features_fixed},
                             {"trial", last_report_.features_trial}};
  Json not_tracked = Json::object();
  for (int32_t reason = PF_FRAME_REASON_NONE + 1; reason <= PF_FRAME_REASON_LENS; ++reason)
    not_tracked[reason_name(reason)] = reasons_[reason];
  json["not_tracked"] = not_tracked;
  json["masked_share"] = rounded(0.001 * static_cast<double>(last_report_.masked_permille));
  json["new_features"] = new_features_;
  json["evicted"] = evicted_;
  json["track_length"] = {
      {"mean", new_features_ > 0 ? Json(rounded(static_cast<double>(measured_) / static_cast<double>(new_features_)))
                                 : Json()}};
  json["templates"] = {
      {"area", learning_frames_ > 0 ? Json(rounded(template_area_ / static_cast<double>(learning_frames_))) : Json()}};
  json["state_dim"] = {
      {"median", state_dim_.quantile(0.5)}, {"max", state_dim_.largest()}, {"end", last_report_.state_dim}};
  json["state_dim_points_only"] = last_report_.state_dim_points_only;
  json["folding"] = {{"from_frame", kFoldingFrom},
                     {"frames", folding_.frames},
                     {"first_plane", folding_.first_plane >= 0 ? Json(folding_.first_plane) : Json()},
                     {"planes_median", planes_.quantile(0.5)},
                     {"folded_median", folded_.quantile(0.5)},
                     {"frames_with_plane", mean_of(static_cast<double>(folding_.frames_plane))},
                     {"share_folded", mean_of(folding_.share_folded)},
                     {"share_trial", mean_of(folding_.share_trial)},
                     {"share_rows_saved", mean_of(folding_.share_saved)}};
  json["state_dim_held"] = last_report_.state_dim_held;
  json["planes"] = planes_json(last_planes_);
  json["walls"] = session.plan().to_json(session.slam());
  json["patches"] = has_patches ? Json{{"median", patches_.quantile(0.5)},
                                       {"max", patches_.largest()},
                                       {"lost", lost_patches_},
                                       {"refound", refound_patches_}}
                                : Json();
  json["cameras"] = has_patches ? Json{{"median", cameras_.quantile(0.5)}, {"max", cameras_.largest()}} : Json();
  json["hits"] = hits_json(last_hits_);
  json["gravity"] = options.has_gravity ? Json(options.gravity_W) : Json();
  json["nis_per_dof"] = nis_dof_ > 0 ? Json(rounded(nis_ / static_cast<double>(nis_dof_))) : Json();
  json["sigma_gate_px"] = rounded(last_report_.sigma_gate_px);
  json["sigma_info_px"] = rounded(last_report_.sigma_info_px);
  json["correlation_frames"] = rounded(last_report_.correlation_frames);
  json["kernels"] = kernels_name(last_report_.kernels);
  json["scalar"] = config.scalar == PF_SCALAR_FLOAT ? "float" : "double";
  json["camera"] = camera_json(config.camera);
  json["lens"] = lens_json(session.slam());
  pf_research_t research;
  pf_config_get_research(&config, &research);
  json["config"] = {
      {"max_state_dim", config.capacity.max_state_dim},       {"max_features", config.capacity.max_features},
      {"max_observations", config.capacity.max_observations}, {"features_in_view", config.map.features_in_view},
      {"sigma_pixel", config.measurement.sigma_px},           {"keep_gauge", research.keep_gauge}};
  json["withdraw_target_after"] = options.withdraw_target_after >= 0 ? Json(options.withdraw_target_after) : Json();
  json["truth"] =
      source.truth_path.empty() ? "" : std::filesystem::absolute(source.truth_path).lexically_normal().string();
  if (turn_images_ > 0) {
    json["there_and_back"] = {{"turn_s", 1e-9 * static_cast<double>(turn_ns_)}, {"images", turn_images_}};
  }
  if (relative.frames() > 0) {
    json["relative"] = {
        {"frames", relative.frames()},
        {"windows", relative.windows()},
        {"untracked", relative.untracked()},
        {"without_room", relative.without_room()},
        {"nees_per_dof", relative.nees_per_dof() >= 0.0 ? Json(rounded(relative.nees_per_dof())) : Json()}};
  }
  if (!live.empty()) {
    json["live"] = Json::parse(live);
  }
  if (!imu.empty()) {
    json["imu"] = Json::parse(imu);
  }
  json["log"] = session.log();
  json["ended_early"] = ended;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string Statistics::summary(const Session& session) const {
  char text[320];
  std::snprintf(text, sizeof(text),
                "tracked %lld of %lld frames (lost %lld), median %.0f features measured per frame, %.2f ms per frame "
                "(p95 %.2f), %.2f MiB",
                static_cast<long long>(tracked_), static_cast<long long>(frames_), static_cast<long long>(lost_),
                inliers_.quantile(0.5), ms_.quantile(0.5), ms_.quantile(0.95),
                static_cast<double>(session.memory().bytes) / 1048576.0);
  return text;
}

}  // namespace pf::capture
