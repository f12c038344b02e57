// pf-digest SOURCE [--frames N] [--auto]: tracks the images of a source with the default config, for the digest of what comes out.
// Sources are sim:NAME and those of pf_open_sequence. It starts at the source's target where there is one, unless --auto is given.

#include <planefold_platform/sequence.h>
#include <planefold_platform/sim.h>
#include <planefold_platform/version.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "../lib/command_line.h"
#include "context.h"

namespace {

int fail(const std::string& what) {
  std::fprintf(stderr, "pf-digest: %s\n", what.c_str());
  return 1;
}

pf_config_t config_for(const pf_camera_t& camera) {
  pf_config_t config;
  pf_config_default(&config);
  config.camera = camera;
  config.capacity.max_imu_samples = 100;
  return config;
}

int run_sim(const std::string& scene, std::int64_t frames, bool at_target) {
  pf_sim_t* sim = pf_sim_open(scene.c_str(), nullptr);
  if (sim == nullptr) return fail("there is no scene '" + scene + "'");
  pf_camera_t camera;
  pf_sim_camera(sim, &camera);
  const pfsim::Context context(config_for(camera));
  pf_target_t target;
  bool good = context.slam != nullptr;
  if (good && at_target && pf_sim_target(sim, PF_TARGET_RECTANGLE, &target) == PF_OK) {
    good = pf_start_from_target(context.slam, &target) == PF_OK;
  }
  pf_image_t image;
  for (std::int64_t i = 0; good && i < frames && pf_sim_next(sim, &image, nullptr); ++i) {
    good = pf_push_frame(context.slam, &image) >= 0;
  }
  pf_sim_close(sim);
  return good ? 0 : fail("sim:" + scene + " was refused by the library");
}

int run_sequence(const std::string& source, std::int64_t frames, bool at_target) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  pf_sequence_t* sequence = nullptr;
  if (pf_open_sequence(source.c_str(), nullptr, &sequence, message) != 0) return fail(message);
  pf_sequence_info_t info;
  pf_get_sequence_info(sequence, &info);
  const pfsim::Context context(config_for(info.camera));
  bool good = context.slam != nullptr;
  const std::string target_file = std::string(info.folder) + "/target.yaml";
  if (good && at_target && std::filesystem::exists(target_file)) {
    pf_target_t target;
    good = pf_read_target(target_file.c_str(), &target, message) == 0 &&
           pf_start_from_target(context.slam, &target) == PF_OK;
  }
  pf_imu_sample_t* samples = nullptr;
  std::size_t count = 0, next = 0;
  if (good && info.imu_path[0] != '\0') good = pf_read_imu(info.imu_path, &samples, &count, message) == 0;
  pf_image_t image;
  for (std::int64_t i = 0; good && i < std::min(frames, info.count); ++i) {
    good = pf_read_sequence_frame(sequence, i, &image, message) == 0;
    const std::size_t first = next;
    while (next < count && samples[next].t_ns <= image.t_ns) ++next;
    if (good && next > first) good = pf_push_imu(context.slam, samples + first, next - first) >= 0;
    good = good && pf_push_frame(context.slam, &image) >= 0;
  }
  pf_free_imu(samples);
  pf_close_sequence(sequence);
  return good ? 0 : fail(message[0] != '\0' ? message : source + " was refused by the library");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Tracks a source with the default config; PLANEFOLD_DIGEST names the file for the digest"};
  app.set_version_flag("--version", "pf-digest " PF_VERSION_TEXT);
  std::string source;
  std::int64_t frames = INT64_MAX;
  bool start_auto = false;
  app.add_option("source", source, "sim:NAME, video:FILE, images:DIR, euroc:DIR or tum:DIR")->required();
  app.add_option("--frames", frames, "at most so many");
  app.add_flag("--auto", start_auto, "start without the target");
  int code = 0;
  if (!pf::tools::parse_command_line(app, "pf-digest", argc, argv, code)) return code;
  if (source.rfind("sim:", 0) == 0) return run_sim(source.substr(4), frames, !start_auto);
  return run_sequence(source, frames, !start_auto);
}
