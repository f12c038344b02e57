// pf-bench SUITE [--json FILE]: kernels and whole frames against their limits and peers, as ratios in one run.
// pf-bench computes in double; pf-benchf beside it is the same program in float.
#include <CLI/CLI.hpp>
#include <map>

#include "../lib/command_line.h"
#include "planefold_platform/version.h"
#include "suite.h"

int main(int argc, char** argv) {
  CLI::App app("Measure kernels and whole frames against their limits and peers, single-threaded.");
  app.require_subcommand(1);
  app.set_version_flag("--version", "pf-bench " PF_VERSION_TEXT);
  bench::SuiteOptions options;
  std::map<const CLI::App*, const bench::Suite*> suites;
  for (const bench::Suite* s = bench::Suite::first(); s != nullptr; s = s->next) {
    CLI::App* sub = app.add_subcommand(s->name, s->description);
    sub->add_option("--json", options.json, "write the rows to this file")->check(pf::tools::writable_file());
    const bool has_patch = s->input == bench::Suite::kPatch;
    if (has_patch) {
      sub->add_option("--source", options.sources,
                      "stored frames in place of drawn ones: images:DIR, euroc:DIR, tum:DIR or video:FILE");
      sub->add_option("--patch", options.patch,
                      "of stored frames: X,Y,W,H in the first one [px]; the square in its middle is followed");
      sub->add_option("--truth", options.truth,
                      "of stored frames: file with nine numbers a line, row by row the homography from the first "
                      "frame's pixels to this one's");
      sub->add_option("--hidden", options.hidden, "of drawn frames: share of the patch that something passes before")
          ->check(pf::capture::number_in(0.0, 0.9))
          ->capture_default_str();
      options.calibration.add_to(*sub);
    }
    if (has_patch || s->input == bench::Suite::kSeeds) {
      sub->add_option("--seeds", options.seeds, "runs of each kind")
          ->check(pf::capture::whole_number_in(1, 1000))
          ->capture_default_str();
      sub->add_option("--frames", options.frames, "at most N of every run")
          ->check(pf::capture::whole_number_in(2, 100000));
    } else if (s->input == bench::Suite::kSequences) {
      sub->add_option("--source", options.sources,
                      "video:FILE, images:DIR, euroc:DIR, tum:DIR or sim:NAME (default: what lies in $PLANEFOLD_DATA)");
      sub->add_option(
          "--start", options.start,
          "auto, pose:FILE, target:FILE or rectangle:WxH (default: target.yaml beside the images, else auto)");
      options.calibration.add_to(*sub);
      CLI::Option* walls =
          sub->add_option("--walls", options.walls, "file of walls known beforehand, in the frame of the start");
      sub->add_option("--patches", options.patches, "capacity for patches of these walls")
          ->needs(walls)
          ->check(pf::capture::whole_number_in(0, 32))
          ->capture_default_str();
      sub->add_flag("--window", options.window, "the back end with keyframes");
      sub->add_flag(
          "--no-planes", [&](std::int64_t count) { options.planes = count == 0; }, "points only");
      sub->add_option("--masks", options.masks, "map.masks: 0 none, 1 partial, 2 whole")
          ->check(pf::capture::whole_number_in(0, 2));
      sub->add_option("--features", options.features, "map.features_in_view (default: the library's)")
          ->check(pf::capture::whole_number_in(0, 1000));
      sub->add_option("--passes", options.passes, "through every sequence")
          ->check(pf::capture::whole_number_in(1, 1000))
          ->capture_default_str();
      sub->add_option("--frames", options.frames, "at most N of every sequence")
          ->check(pf::capture::whole_number_in(2, 100000));
    } else {
      sub->add_option("--repetitions", options.repetitions, "interleaved repetitions; medians are reported")
          ->check(pf::capture::whole_number_in(3, 100000))
          ->capture_default_str();
    }
    sub->add_option("--kernels", options.kernels,
                    "kernel set: reference, portable, avx2, avx512, neon (default: the fastest)")
        ->check(CLI::IsMember({"auto", "reference", "portable", "avx2", "avx512", "neon"}));
    suites[sub] = s;
  }
  int code = 0;
  if (!pf::tools::parse_command_line(app, "pf-bench", argc, argv, code)) return code;
  return suites.at(app.get_subcommands().front())->run(options);
}
