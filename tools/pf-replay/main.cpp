// pf-replay record FILE, then pf-replayf follow FILE: a session of many frames, once in double and, on the observations that were
// accepted there, once in float. Each program can do both, so that a run can also be held against itself.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "../lib/command_line.h"
#include "planefold_platform/version.h"
#include "record.h"

namespace {

nlohmann::ordered_json of_both(const replay::Distance& d, double (replay::Quality::*number)() const) {
  return {{"recorded", (d.recorded.*number)()}, {"here", (d.here.*number)()}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"One session in double, and the same one in float"};
  app.require_subcommand(1);
  app.set_version_flag("--version", "pf-replay " PF_VERSION_TEXT);
  std::string file, json;
  int frames = 50000;
  std::uint64_t seed = 1;
  bool planes = false;

  CLI::App* record = app.add_subcommand("record", "run the session and write what was accepted and estimated");
  record->add_option("file", file, "tape to write")->required();
  record->add_option("--frames", frames, "length of the session")
      ->check(pf::capture::whole_number_in(1, 10000000))
      ->capture_default_str();
  record->add_option("--seed", seed, "of the world, the motion and the noise")->capture_default_str();
  record->add_flag("--planes", planes, "fold points into planes");
  double sigma_px = 0;
  CLI::App* follow = app.add_subcommand("follow", "run on the accepted observations and compare");
  follow->add_option("file", file, "tape to read")->required();
  follow->add_option("--json", json, "file for the result")->check(pf::tools::writable_file());
  follow->add_option("--noise-px", sigma_px, "standard deviation of noise that the pixels get beside their own")
      ->check(CLI::Range(0.0, 100.0));
  int code = 0;
  if (!pf::tools::parse_command_line(app, "pf-replay", argc, argv, code)) return code;

  if (record->parsed()) {
    std::error_code failed;
    if (std::filesystem::exists(file, failed)) {
      std::fprintf(stderr, "pf-replay: '%s' exists and is left as it is; give another name, or remove it\n",
                   file.c_str());
      return 1;
    }
    if (replay::record(file, frames, seed, planes)) return 0;
    std::fprintf(stderr, "pf-replay: the session could not be run or '%s' not be written\n", file.c_str());
    return 1;
  }
  replay::Distance d;
  if (!replay::follow(file, sigma_px, &d)) {
    std::fprintf(stderr, "pf-replay: '%s' is no tape; pf-replay record FILE writes one\n", file.c_str());
    return 1;
  }
  const nlohmann::ordered_json result = {{"scalar", PF_REPLAY_SCALAR},
                                         {"frames", d.frames},
                                         {"tracked", d.tracked},
                                         {"not_tracked", d.not_tracked},
                                         {"starts_again", d.starts_again},
                                         {"observations", d.offered},
                                         {"refused", d.refused},
                                         {"refused_again", d.refused_again},
                                         {"frames_with_another_map", d.other_map},
                                         {"frames_with_another_state", d.other_state},
                                         {"longest_run_of_them", d.longest_other},
                                         {"another_state_at_the_end", d.other_end},
                                         {"open_depths", d.open_depths},
                                         {"converted_apart", d.converted_apart},
                                         {"places", d.places},
                                         {"folded_apart", d.folded_apart},
                                         {"position_in_sigma", d.position},
                                         {"rotation_in_sigma", d.rotation},
                                         {"sigma_relative", d.sigma},
                                         {"map_points", d.map_points},
                                         {"map_points_folded", d.folded},
                                         {"map_points_of_another_kind", d.other_kind},
                                         {"map_position_in_sigma", d.map_position},
                                         {"map_sigma_relative", d.map_sigma},
                                         {"nees_pose", of_both(d, &replay::Quality::nees_pose)},
                                         {"camera_rmse_m", of_both(d, &replay::Quality::camera_rmse_m)},
                                         {"camera_rmse_rad", of_both(d, &replay::Quality::camera_rmse_rad)},
                                         {"map_rmse_m", of_both(d, &replay::Quality::map_rmse_m)},
                                         {"us_per_frame", d.us_per_frame}};
  std::printf("%s\n", result.dump(2).c_str());
  if (!json.empty()) {
    std::error_code error;  // that the file cannot be opened says enough
    std::filesystem::create_directories(std::filesystem::path(json).parent_path(), error);
    std::FILE* out = std::fopen(json.c_str(), "w");
    if (out == nullptr) return 1;
    std::fputs(result.dump(2).c_str(), out);
    std::fclose(out);
  }
  return 0;
}
