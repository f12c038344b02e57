// pf-digest SOURCE [OPTIONS]: tracks the images of a source, for the digest of what comes out. Sources are sim:NAME and those of
// pf_open_sequence. It starts at the source's target where there is one, unless --auto is given.

#include <planefold_platform/sequence.h>
#include <planefold_platform/sim.h>
#include <planefold_platform/version.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "../lib/calibration_options.h"
#include "../lib/command_line.h"
#include "context.h"

namespace {

int fail(const std::string& what) {
  std::fprintf(stderr, "pf-digest: %s\n", what.c_str());
  return 1;
}

struct Options {
  std::int64_t frames = INT64_MAX;
  std::int64_t black_from = INT64_MAX, black_frames = 0;
  int places = -1;
  bool start_auto = false, window = false, masks = false, imu = false, lens = false;
  pf::tools::CalibrationOptions calibration;  ///< of a sequence
};

pf_config_t config_for(const pf_camera_t& camera, const Options& options) {
  pf_config_t config;
  pf_config_default(&config);
  config.camera = camera;
  config.capacity.max_imu_samples = 100;
  config.capacity.max_places = options.places;
  if (options.window) config.backend = PF_BACKEND_WINDOW;
  if (options.masks) config.map.masks = PF_MASKS_PARTIAL;
  if (options.lens) {
    config.camera.estimate = PF_CAMERA_ESTIMATE;
    config.camera.sigma_focal = 0.01;
    config.camera.sigma_aspect = 0.001;
    config.camera.sigma_centre_px = 5;
  }
  return config;
}

void use_imu(pf_config_t* config, const pf_imu_model_t& model) {
  config->motion.model = PF_MOTION_INERTIAL;
  config->capacity.max_imu_samples = 2000;
  config->imu = model;
}

/// Pushes a source's frames, some of them with the lens covered.
class Frames {
 public:
  Frames(pf_slam_t* slam, const Options& options) : slam_(slam), options_(options) {}

  bool push(std::int64_t index, pf_image_t image) {
    if (index >= options_.black_from && index - options_.black_from < options_.black_frames) {
      black_.assign(static_cast<std::size_t>(image.stride) * static_cast<std::size_t>(image.height), 0);
      black_[0] = static_cast<std::uint8_t>(index & 1);  // an image that repeats the last one is not measured
      image.pixels = black_.data();
    }
    return pf_push_frame(slam_, &image) >= 0;
  }

 private:
  pf_slam_t* slam_;
  const Options& options_;
  std::vector<std::uint8_t> black_;
};

bool start_sim(const pfsim::Context& context, pf_sim_t* sim, const Options& options) {
  pf_target_t target;
  if (options.start_auto || pf_sim_target(sim, PF_TARGET_RECTANGLE, &target) != PF_OK) return true;
  return pf_start_from_target(context.slam, &target) == PF_OK;
}

int run_sim(const std::string& scene, const Options& options) {
  pf_sim_options_t scene_options;
  if (pf_sim_options_default(scene.c_str(), &scene_options) != PF_OK) return fail("there is no scene '" + scene + "'");
  if (options.imu) scene_options.rest_s = 2;
  pf_sim_t* sim = pf_sim_open(scene.c_str(), &scene_options);
  if (sim == nullptr) return fail("the scene '" + scene + "' could not be opened");
  pf_camera_t camera;
  pf_sim_camera(sim, &camera);
  pf_config_t config = config_for(camera, options);
  pf_sim_imu_options_t unit;
  pf_sim_imu_options_default(&unit);
  if (options.imu) use_imu(&config, unit.model);
  pf_sim_imu_t* imu = options.imu ? pf_sim_imu_open(sim, &unit) : nullptr;
  const pfsim::Context context(config);
  bool good = context.slam != nullptr && start_sim(context, sim, options);
  Frames frames(context.slam, options);
  pf_image_t image;
  for (std::int64_t i = 0; good && i < options.frames && pf_sim_next(sim, &image, nullptr); ++i) {
    while (imu != nullptr && pf_sim_imu_next_ns(imu) <= image.t_ns) {
      pf_imu_sample_t sample;
      pf_sim_imu_next(imu, &sample);
      pf_push_imu(context.slam, &sample, 1);
    }
    good = frames.push(i, image);
  }
  if (imu != nullptr) pf_sim_imu_close(imu);
  pf_sim_close(sim);
  return good ? 0 : fail("sim:" + scene + " was refused by the library");
}

bool start_sequence(pf_slam_t* slam, const std::string& folder, const Options& options, char* message) {
  const std::string file = folder + "/target.yaml";
  if (options.start_auto || !std::filesystem::exists(file)) return true;
  pf_target_t target;
  return pf_read_target(file.c_str(), &target, message) == 0 && pf_start_from_target(slam, &target) == PF_OK;
}

int run_sequence(const std::string& source, const Options& options) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  pf_sequence_t* sequence = nullptr;
  const pf::tools::CalibrationOptions& given = options.calibration;
  if (pf_open_sequence_of(source.c_str(), given.file_or_null(), given.camera.c_str(), &sequence, message) != 0) {
    return fail(message);
  }
  pf_sequence_info_t info;
  pf_get_sequence_info(sequence, &info);
  pf::tools::print_notes("pf-digest", info.warning);
  pf_config_t config = config_for(info.camera, options);
  if (options.imu) {
    pf_imu_model_t model = config.imu;
    const std::string file = std::string(info.folder) + "/calib.yaml";
    if (pf_read_imu_noise(file.c_str(), &model, message) != 0 ||
        pf_read_imu_mount(file.c_str(), &model, message) != 0) {
      return fail(message);
    }
    use_imu(&config, model);
  }
  const pfsim::Context context(config);
  bool good = context.slam != nullptr && start_sequence(context.slam, info.folder, options, message);
  pf_imu_sample_t* samples = nullptr;
  std::size_t count = 0, next = 0;
  if (good && info.imu_path[0] != '\0') good = pf_read_imu(info.imu_path, &samples, &count, message) == 0;
  Frames frames(context.slam, options);
  pf_image_t image;
  for (std::int64_t i = 0; good && i < std::min(options.frames, info.count); ++i) {
    const int result = pf_read_sequence_frame(sequence, i, &image, message);
    if (result == PF_SEQUENCE_END) break;
    good = result == 0;
    const std::size_t first = next;
    while (next < count && samples[next].t_ns <= image.t_ns) ++next;
    if (good && next > first) good = pf_push_imu(context.slam, samples + first, next - first) >= 0;
    good = good && frames.push(i, image);
  }
  pf_free_imu(samples);
  pf_close_sequence(sequence);
  return good ? 0 : fail(message[0] != '\0' ? message : source + " was refused by the library");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Tracks a source; PLANEFOLD_DIGEST names the file for the digest"};
  app.set_version_flag("--version", "pf-digest " PF_VERSION_TEXT);
  std::string source, backend = "filter";
  Options options;
  app.add_option("source", source, "sim:NAME, video:FILE, images:DIR, euroc:DIR or tum:DIR")->required();
  options.calibration.add_to(app);
  app.add_option("--frames", options.frames, "at most so many");
  app.add_flag("--auto", options.start_auto, "start without the target");
  app.add_option("--backend", backend, "filter or window")->check(CLI::IsMember({"filter", "window"}));
  app.add_flag("--masks", options.masks, "templates with masks");
  app.add_flag("--imu", options.imu, "the inertial model: a scene's own unit, or the samples beside the images");
  app.add_option("--places", options.places, "capacity.max_places");
  app.add_flag("--lens", options.lens, "the lens is estimated");
  app.add_option("--black-from", options.black_from, "the first frame with the lens covered");
  app.add_option("--black", options.black_frames, "and for how many frames");
  int code = 0;
  if (!pf::tools::parse_command_line(app, "pf-digest", argc, argv, code)) return code;
  options.window = backend == "window";
  if (source.rfind("sim:", 0) == 0) return run_sim(source.substr(4), options);
  return run_sequence(source, options);
}
