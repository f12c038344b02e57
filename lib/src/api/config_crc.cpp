#include <cstddef>

#include "api/context.h"
#include "session/live_map.h"

namespace pf {
namespace {

/// Fields of a config that lie one behind the other without a gap.
struct Span {
  std::size_t begin, end;
};

#define PF_SPAN(first, last) \
  { offsetof(pf_config_t, first), offsetof(pf_config_t, last) + sizeof(pf_config_t::last) }

constexpr Span kSpans[] = {
    PF_SPAN(version, scalar),
    PF_SPAN(camera.model, camera.height),
    PF_SPAN(camera.fx, camera.sigma_distortion),
    PF_SPAN(backend, window.points),
    PF_SPAN(motion.model, motion.model),
    PF_SPAN(motion.linear_acceleration_density, first_depth.from_map),
    PF_SPAN(first_depth.relative_sigma, map.masks),
    PF_SPAN(map.max_misfit, plane.fix),
    PF_SPAN(imu, research),
};

#undef PF_SPAN

/// Between two spans is nothing but the kernels or padding, so that a new field is in one.
constexpr bool are_all() {
  std::size_t at = offsetof(pf_config_t, version);
  bool all = true;
  for (const Span& span : kSpans) {
    all = all && span.begin >= at && span.begin - at <= sizeof(std::int32_t);
    at = span.end;
  }
  return all && at == offsetof(pf_config_t, clock_ns);
}
static_assert(are_all());

}  // namespace

std::uint32_t config_crc(const pf_config_t& config) {
  std::uint32_t crc = 0;
  for (const Span& span : kSpans)
    crc = add_to_crc(crc, reinterpret_cast<const char*>(&config) + span.begin, span.end - span.begin);
  return crc;
}

}  // namespace pf
