#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "paper_run.h"

namespace pfsim::gee {

/// All runs of one case.
struct PaperRuns {
  int seeds = 0, frames = 0, frames_per_loop = 0;
  std::uint64_t first_seed = 1;
  const PaperRow* rows = nullptr;
  const PaperSummary* summaries = nullptr;

  const PaperRow& row(int seed, int frame) const {
    return rows[static_cast<std::size_t>(seed) * static_cast<std::size_t>(frames) + static_cast<std::size_t>(frame)];
  }
};

/// The case's numbers under the names of the project's reports; those that exist per loop are given for each.
nlohmann::json summarise(const PaperRuns& runs);

/// Figure 2: per frame the means over the runs.
bool write_figure2(const PaperRuns& runs, const std::string& path);

void print(const std::string& label, const nlohmann::json& numbers);

}  // namespace pfsim::gee
