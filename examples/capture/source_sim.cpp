#include "source.h"

namespace pf::capture {

std::unique_ptr<Source> open_sim_source(const Options& options, std::string& error) {
  error = "source '" + options.source + "': this build has no simulator";
  return nullptr;
}

}  // namespace pf::capture
