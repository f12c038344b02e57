#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run.h"

namespace pfsim {

/// All runs of one case, rows frame by frame within each run.
struct Experiment {
  BedOptions bed;
  pf_config_t config;
  RunOptions run;
  int seeds = 0;
  std::uint64_t first_seed = 1;
  const RunSummary* summaries = nullptr;
  const FrameRow* rows = nullptr;

  const FrameRow& row(int seed, int frame) const {
    return rows[static_cast<std::size_t>(seed) * static_cast<std::size_t>(bed.frames) +
                static_cast<std::size_t>(frame)];
  }
};

/// Runs all seeds, in that many processes. False when one of them died.
bool run_all(Experiment& experiment, int processes, const char* title);

/// The case's numbers under the names of the project's reports.
nlohmann::json summarise(const Experiment& experiment);

/// DIR/LABEL.csv: per frame the run averages and the bounds; DIR/LABEL_runs.csv: position NEES of every run.
bool write_csv(const Experiment& experiment, const std::string& directory, const std::string& label);

/// The few lines that a person reads.
void print(const std::string& label, const nlohmann::json& numbers);

bool write_json(const std::string& path, const nlohmann::json& json);

}  // namespace pfsim
