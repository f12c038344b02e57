#include "api/context.h"

#include <new>

#include "api/stack_budget.h"

/// Layout of a context: over an empty arena to count the bytes, over the caller's block to place the parts.
std::size_t pf::bytes_needed(const pf::Settings& settings) {
  pf::Arena arena;
  arena.take<pf_slam>(1);
  pf::Session session;
  session.layout(arena, settings);
  return arena.used();
}

pf_status_t pf_memory_query(const pf_config_t* config, pf_memory_t* memory) {
  if (config == nullptr || memory == nullptr) return PF_ERROR_NULL;
  pf::Settings settings;
  const pf::Status status = pf::settings_from(*config, &settings, nullptr);
  if (status != pf::Status::kOk) return pf::to_c(status);
  memory->bytes = pf::bytes_needed(settings);
  memory->alignment = pf::Arena::kAlignment;
  memory->stack_bytes = pf::kStackBudget;
  return PF_OK;
}

pf_status_t pf_create(const pf_config_t* config, void* block, size_t bytes, pf_slam_t** slam) {
  if (slam == nullptr) return PF_ERROR_NULL;
  *slam = nullptr;
  if (config == nullptr || block == nullptr) return PF_ERROR_NULL;
  const pf_config_t copy = *config;  // the config may lie in the block
  pf::Settings settings;
  const pf::Status status = pf::settings_from(copy, &settings, nullptr);
  if (status != pf::Status::kOk) return pf::to_c(status);
  if (reinterpret_cast<std::uintptr_t>(block) % pf::Arena::kAlignment != 0) return PF_ERROR_ALIGNMENT;
  if (bytes < pf::bytes_needed(settings)) return PF_ERROR_MEMORY;
  pf::Arena arena(block, bytes);
  pf_slam* context = new (arena.take<pf_slam>(1)) pf_slam();
  context->session.layout(arena, settings);
  context->config = copy;
  context->self = context;
  context->magic = pf::kMagic;
  *slam = context;
  return pf_reset(context);
}

pf_status_t pf_reset(pf_slam_t* slam) {
  PF_BEGIN_CHANGE(slam);
  slam->session.init();
  slam->is_told = false;
  return PF_OK;
}

const char* pf_status_text(pf_status_t status) {
  switch (status) {
    case PF_OK:
      return "done";
    case PF_NOTE_STARTING:
      return "starting: there is no pose yet that known depths support";
    case PF_NOTE_COASTING:
      return "coasting: too few features were found, the pose is a prediction";
    case PF_NOTE_LOST:
      return "lost: the map is searched for in every frame";
    case PF_NOTE_UNUSABLE:
      return "the image has no usable content; the pose coasts";
    case PF_NOTE_TRUNCATED:
      return "there is more than the array holds";
    case PF_NOTE_NOTHING:
      return "there is nothing there";
    case PF_ERROR_NULL:
      return "a pointer is null that must not be";
    case PF_ERROR_CONFIG:
      return "a field of the config is out of its range; pf_config_check names it";
    case PF_ERROR_VERSION:
      return "the config was made with another release of the header; call pf_config_default";
    case PF_ERROR_SCALAR:
      return "the config was made for the other library (planefold: double, planefoldf: float)";
    case PF_ERROR_MEMORY:
      return "the block is smaller than pf_memory_query says";
    case PF_ERROR_ALIGNMENT:
      return "the block does not begin at a multiple of the alignment that pf_memory_query says";
    case PF_ERROR_SIZE:
      return "the image does not have the size of the calibration";
    case PF_ERROR_TIME:
      return "the timestamp is not after the last one";
    case PF_ERROR_NONFINITE:
      return "a number is NaN or infinite";
    case PF_ERROR_STATE:
      return "not possible in this state";
    case PF_ERROR_RANGE:
      return "a number is outside of its domain";
    case PF_ERROR_CONTEXT:
      return "not a planefold context, or its block was overwritten or moved";
    case PF_ERROR_FULL:
      return "there is no room for more rows of the state, planes, places or anchors";
    case PF_ERROR_MAP:
      return "no saved map, or one that is damaged or of another format";
  }
  return "unknown status";
}
