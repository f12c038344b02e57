#pragma once

#include "base/status.h"
#include "planefold/planefold_research.h"

/// What planefold_research.h writes into a config.

namespace pf {

/// Whether pf_config_set_research has written into it.
bool holds_research(const pf_config_t& config);

/// What it has written, or the defaults. kVersion: written by something else.
Status research_from(const pf_config_t& config, pf_research_t* research);

}  // namespace pf
