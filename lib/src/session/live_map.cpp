#include "session/live_map.h"

#include "base/archive.h"
#include "memory/crc32c.h"
#include "session/session.h"

namespace pf {
namespace {

constexpr std::uint32_t kOrigin = section_tag("ORIG"), kLive = section_tag("LIVE");

const char* check_origin(const LiveOrigin& origin, const MapSection& section) {
  MapReader in(section.bytes, section.count);
  const std::uint32_t library = in.u32(), scalar = in.u32(), kernels = in.u32(), config = in.u32();
  const std::uint64_t block = in.u64();
  if (in.failed() || in.left() != 0) return "ORIG has another length";
  if (library != origin.library) return "it was saved by another release of the library";
  if (scalar != origin.scalar) return "it was saved by the library of the other scalar";
  if (kernels != origin.kernels) return "it was saved with another kernel set";
  if (config != origin.config) return "it was saved with another config";
  return block == origin.block ? nullptr : "it was saved by another build of the library";
}

}  // namespace

std::uint32_t add_to_crc(std::uint32_t before, const void* bytes, std::size_t count) {
  return crc32c(static_cast<const std::uint8_t*>(bytes), count, before);
}

Status write_live(const LiveOrigin& origin, Session& session, MapWriter* out) {
  Archive counting;
  session.carry(counting);
  out->begin(kContinuedMap);
  out->begin_section(kOrigin);
  out->u32(origin.library);
  out->u32(origin.scalar);
  out->u32(origin.kernels);
  out->u32(origin.config);
  out->u64(origin.block);
  out->end_section();
  out->begin_section(kLive);
  std::uint8_t* const at = out->take(counting.used());
  if (at != nullptr) {
    Archive writing = Archive::writing(at, counting.used());
    session.carry(writing);
  }
  out->end_section();
  out->end();
  return counting.failed() ? Status::kState : Status::kOk;
}

const char* read_live(const LiveOrigin& origin, const std::uint8_t* buffer, std::size_t bytes, Session* session,
                      bool* is_changed) {
  MapSection section[kMaxSections];
  int sections = 0;
  *is_changed = false;
  const char* wrong = open_map(buffer, bytes, kContinuedMap, section, &sections);
  if (wrong != nullptr) return wrong;
  if (sections != 2 || section[0].tag != kOrigin || section[1].tag != kLive) return "its sections are others";
  wrong = check_origin(origin, section[0]);
  if (wrong != nullptr) return wrong;
  *is_changed = true;
  Archive reading = Archive::reading(section[1].bytes, section[1].count);
  session->carry(reading);
  return reading.is_at_end() ? nullptr : "LIVE: a number is out of its domain";
}

}  // namespace pf
