#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "paper_run.h"

namespace pfsim::gee {

/// Options of `pf-sim gee2007` that are the paper filter's own.
struct PaperChoices {
  std::string filter = "paper";
  WorldOptions world;
  SlamOptions slam;
};

/// Options that `pf-sim gee2007` shares between its two filters; 0 and empty where the filter chooses.
struct SharedChoices {
  std::string cases, look, json, csv;
  int seeds, frames, jobs;
  std::uint64_t first_seed;
  double fov, sigma_px, half_height, slant, linearity;
  int first_birth;
};

std::shared_ptr<PaperChoices> add_paper_options(CLI::App* command);

/// The first option of the paper's filter that was given; "": none.
std::string given_paper_option(const CLI::App& command);

/// Runs the cases and reports; the program's exit code. Options of the other filter are rejected.
int run_paper_command(const CLI::App& command, const PaperChoices& paper, const SharedChoices& shared);

}  // namespace pfsim::gee
