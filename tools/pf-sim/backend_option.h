#pragma once

#include <planefold/planefold.h>

#include <CLI/CLI.hpp>
#include <string>

#include "context.h"

namespace pfsim {

/// Which back end of the library an experiment runs: --backend.
struct BackendOption {
  std::string name = "filter";

  void add_to(CLI::App& command) {
    command.add_option("--backend", name, "filter or window")
        ->check(CLI::IsMember({"filter", "window"}))
        ->capture_default_str();
  }
  bool is_window() const { return name == "window"; }

  /// max_features: of the map; 0: the default of the back end.
  void apply(pf_config_t& config, int max_features = 0) const {
    if (max_features > 0) (is_window() ? config.window.points : config.capacity.max_features) = max_features;
    if (is_window()) use_window(config);
  }
};

}  // namespace pfsim
