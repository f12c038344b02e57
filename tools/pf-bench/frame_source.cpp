#include "frame_source.h"

#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>

#ifdef PF_BENCH_HAVE_SIM
#include <planefold_platform/sim.h>
#endif
#ifdef PF_BENCH_HAVE_WALLS
#include <planefold_platform/walls.h>
#endif

namespace bench {
namespace {

void keep(const pf_image_t& image, Frames& frames) {
  const size_t width = static_cast<size_t>(image.width);
  std::vector<uint8_t> pixels(width * static_cast<size_t>(image.height));
  for (size_t y = 0; y < static_cast<size_t>(image.height); ++y) {
    std::memcpy(&pixels[y * width], image.pixels + y * static_cast<size_t>(image.stride), width);
  }
  frames.pixels.push_back(std::move(pixels));
  frames.t_ns.push_back(image.t_ns);
}

bool load_sim(const std::string& scene, const std::string& start, int limit, Frames& frames, std::string& message) {
#ifdef PF_BENCH_HAVE_SIM
  pf_sim_options_t options;
  if (pf_sim_options_default(scene.c_str(), &options) != PF_OK) {
    message = "sim:" + scene + ": there is no such scene; there are";
    for (int32_t i = 0; pf_sim_scene_name(i) != nullptr; ++i) message += std::string(" ") + pf_sim_scene_name(i);
    return false;
  }
  options.frames = std::min(options.frames, limit);
  const std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim(pf_sim_open(scene.c_str(), &options), pf_sim_close);
  if (!sim) {
    message = "sim:" + scene + ": cannot be opened";
    return false;
  }
  pf_sim_camera(sim.get(), &frames.camera);
  pf_image_t image{};
  while (pf_sim_next(sim.get(), &image, nullptr) != 0) keep(image, frames);
  if (start.empty()) {
    frames.has_target = pf_sim_target(sim.get(), PF_TARGET_RECTANGLE, &frames.target) == PF_OK;
    frames.start = frames.has_target ? "its target" : "auto";
  }
  return true;
#else
  (void)start, (void)limit, (void)frames;
  message = "sim:" + scene + ": this build has no simulator";
  return false;
#endif
}

bool load_sequence(const std::string& source, const std::string& start,
                   const pf::tools::CalibrationOptions& calibration, int limit, Frames& frames, std::string& message) {
  char line[PF_SEQUENCE_MESSAGE] = "";
  pf_sequence_t* opened = nullptr;
  if (pf_open_sequence_of(source.c_str(), calibration.file_or_null(), calibration.camera.c_str(), &opened, line) != 0) {
    message = line;
    return false;
  }
  const std::unique_ptr<pf_sequence_t, void (*)(pf_sequence_t*)> sequence(opened, pf_close_sequence);
  pf_sequence_info_t info{};
  pf_get_sequence_info(opened, &info);
  pf::tools::print_notes("pf-bench", info.warning);
  frames.camera = info.camera;
  const int64_t count = std::min<int64_t>(info.count, limit);
  for (int64_t i = 0; i < count; ++i) {
    pf_image_t image{};
    const int result = pf_read_sequence_frame(opened, i, &image, line);
    if (result == PF_SEQUENCE_END) break;
    if (result != 0) {
      message = line;
      return false;
    }
    keep(image, frames);
  }
  const std::filesystem::path beside = std::filesystem::path(info.folder) / "target.yaml";
  if (start.empty() && std::filesystem::exists(beside)) {
    frames.has_target = pf_read_target(beside.c_str(), &frames.target, line) == 0;
    frames.start = "target.yaml";
    message = line;
    return frames.has_target;
  }
  return true;
}

}  // namespace

bool load_frames(const std::string& source, const std::string& start, const pf::tools::CalibrationOptions& calibration,
                 int limit, Frames& frames, std::string& message) {
  frames = Frames();
  frames.start = start.empty() ? "auto" : start;
  const size_t colon = source.find(':');
  if (colon == std::string::npos) {
    message = source + ": write video:FILE, images:DIR, euroc:DIR, tum:DIR or sim:NAME";
    return false;
  }
  const std::string what = source.substr(colon + 1);
  const bool sim = source.compare(0, colon, "sim") == 0;
  if (!(sim ? load_sim(what, start, limit, frames, message)
            : load_sequence(source, start, calibration, limit, frames, message))) {
    return false;
  }
  const std::filesystem::path folder = std::filesystem::path(what + "/").lexically_normal().parent_path();
  frames.name = sim ? source : folder.filename().string();

  char line[PF_SEQUENCE_MESSAGE] = "";
  if (start.rfind("target:", 0) == 0) {
    frames.has_target = pf_read_target(start.c_str() + 7, &frames.target, line) == 0;
  } else if (start.rfind("rectangle:", 0) == 0) {
    frames.has_target = pf_parse_rectangle(start.c_str() + 10, &frames.target, line) == 0;
  } else if (start.rfind("pose:", 0) == 0) {
    frames.has_pose = pf_read_first_pose(start.c_str() + 5, &frames.pose, line) == 0;
  } else if (!start.empty() && start != "auto") {
    std::snprintf(line, sizeof(line), "--start %s: write auto, pose:FILE, target:FILE or rectangle:WxH", start.c_str());
  }
  if (line[0] != '\0' && !frames.has_target && !frames.has_pose) {
    message = line;
    return false;
  }
  if (frames.pixels.size() < 2) {
    message = source + ": has fewer than two frames";
    return false;
  }
  return true;
}

bool load_walls(const std::string& file, Frames& frames, std::string& message) {
#ifdef PF_BENCH_HAVE_WALLS
  const auto walls = std::make_unique<pf_walls_t>();
  char line[PF_WALLS_MESSAGE] = "";
  if (pf_read_walls(file.c_str(), walls.get(), line) != 0) {
    message = line;
    return false;
  }
  frames.walls.clear();
  for (int32_t i = 0; i < walls->count; ++i) frames.walls.push_back(walls->wall[i].prior);
  return true;
#else
  (void)frames;
  message = "--walls " + file + ": this build cannot read walls";
  return false;
#endif
}

std::vector<std::string> default_sources(const char* folder) {
  std::vector<std::string> sources;
  std::error_code failure;
  if (folder != nullptr && *folder != '\0') {
    for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
      if (std::filesystem::exists(entry.path() / "calib.yaml", failure) &&
          std::filesystem::exists(entry.path() / "times.txt", failure)) {
        sources.push_back("images:" + entry.path().string());
      }
    }
  }
  std::sort(sources.begin(), sources.end());
  if (sources.empty()) sources.push_back("sim:desk");
  return sources;
}

}  // namespace bench
