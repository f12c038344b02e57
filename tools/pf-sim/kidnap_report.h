#pragma once

#include <nlohmann/json.hpp>

#include "kidnap_run.h"

namespace pfsim {

/// All that was played: trials start by start, gap_cases() of each; a survival of each start; options.random_runs runs in random order.
struct KidnapResult {
  const Film& film;
  const KidnapOptions& options;
  const Reference& reference;
  const Trial* trials;
  const Survival* survivals;
  const RandomOrder* random;
};

/// Prints the table and gives the report: counts of each kind of gap, and every gap by itself.
nlohmann::json summarise_kidnap(const KidnapResult& result);

}  // namespace pfsim
