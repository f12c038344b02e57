#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run.h"

namespace pfsim {

/// Frames of all runs, frame by frame within each run.
struct Runs {
  int seeds = 0, frames = 0;
  std::uint64_t first_seed = 1;
  const FrameRow* rows = nullptr;

  const FrameRow& row(int seed, int frame) const {
    return rows[static_cast<std::size_t>(seed) * static_cast<std::size_t>(frames) + static_cast<std::size_t>(frame)];
  }
};

/// All runs of one case against geometric truth.
struct Experiment : Runs {
  BedOptions bed;
  pf_config_t config;
  RunOptions run;
  const RunSummary* summaries = nullptr;
};

/// nees_position, nees_pose, camera_rmse_m, state_dim, NIS and inliers of the frames that have a valid covariance.
nlohmann::json summarise_frames(const Runs& runs);

/// Root mean square of the positions' errors of each run.
std::vector<double> rmse_of(const Runs& runs);

/// Median and worst of one value per seed, and all of them.
nlohmann::json of_seeds(const std::vector<double>& values);

/// Runs all seeds, in that many processes. False when one of them died.
bool run_all(Experiment& experiment, int processes, const char* title);

/// The case's numbers under the names of the project's reports.
nlohmann::json summarise(const Experiment& experiment);

/// DIR/LABEL.csv: per frame the run averages and the bounds; DIR/LABEL_runs.csv: position NEES of every run.
/// Makes the folder and puts names of files on its list of what was written there; false, after one line, where one of them is a file of
/// the user's.
bool claim_files(const std::string& directory, const std::vector<std::string>& names);
bool write_csv(const Runs& runs, const std::string& directory, const std::string& label);

/// One line on summarise_frames()'s "motion"; nothing where there are no windows.
void print_motion(const nlohmann::json& motion);

/// The few lines that a person reads.
void print(const std::string& label, const nlohmann::json& numbers);

bool write_json(const std::string& path, const nlohmann::json& json);

}  // namespace pfsim
