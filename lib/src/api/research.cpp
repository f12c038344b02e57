#include "api/research.h"

#include <cstring>

#include "api/context.h"

namespace pf {
namespace {

constexpr std::uint64_t kMark = 0x706672657332ULL;  // grows with the layout of pf_research_t

static_assert(sizeof(pf_research_t) + sizeof(kMark) <= sizeof(pf_config_t::research));

}  // namespace

bool holds_research(const pf_config_t& config) { return config.research[0] != 0; }

Status research_from(const pf_config_t& config, pf_research_t* research) {
  *research = {1, PF_FOLD_CONDITION, 0.1, 0.2, 1};
  if (!holds_research(config)) return Status::kOk;
  if (config.research[0] != kMark) return Status::kVersion;
  std::memcpy(research, &config.research[1], sizeof *research);
  return Status::kOk;
}

}  // namespace pf

pf_status_t pf_research_default(pf_research_t* research) {
  if (research == nullptr) return PF_ERROR_NULL;
  return pf::to_c(pf::research_from(pf_config_t(), research));
}

pf_status_t pf_config_set_research(pf_config_t* config, const pf_research_t* research) {
  if (config == nullptr) return PF_ERROR_NULL;
  std::memset(config->research, 0, sizeof config->research);
  if (research == nullptr) return PF_OK;
  config->research[0] = pf::kMark;
  std::memcpy(&config->research[1], research, sizeof *research);
  return PF_OK;
}

pf_status_t pf_config_get_research(const pf_config_t* config, pf_research_t* research) {
  if (config == nullptr || research == nullptr) return PF_ERROR_NULL;
  return pf::to_c(pf::research_from(*config, research));
}

pf_status_t pf_get_gauge_information(const pf_slam_t* slam, double* scratch, size_t scratch_count,
                                     double information[49]) {
  PF_REQUIRE_CONTEXT(slam);
  if (scratch == nullptr || information == nullptr) return PF_ERROR_NULL;
  if (!slam->session.view().has_state()) return PF_ERROR_STATE;
  const size_t n = static_cast<size_t>(slam->session.view().counts().state_dim);
  if (scratch_count < n * (n + 8)) return PF_ERROR_MEMORY;
  return slam->session.view().gauge_information(scratch, information) ? PF_OK : PF_ERROR_RANGE;
}
