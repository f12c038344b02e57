#pragma once

#include <cstddef>
#include <cstdint>

#include "base/status.h"
#include "memory/map_bytes.h"

/// A session as it stands between two frames, as a saved map of its own kind (lib/docs/reference/map_format.md).

namespace pf {

class Session;

/// What a session and the one that goes on with its bytes have in common. Between the same, the next frames give the same bits.
struct LiveOrigin {
  std::uint32_t library = 0;  ///< its version
  std::uint32_t scalar = 0;   ///< bytes of a number
  std::uint32_t kernels = 0;  ///< kernels_id
  std::uint32_t config = 0;   ///< CRC-32C of what it says
  std::uint64_t block = 0;    ///< bytes of a context, by which builds differ
};

/// CRC-32C of more bytes of what a config says.
std::uint32_t add_to_crc(std::uint32_t before, const void* bytes, std::size_t count);

/// kState: a number of the session is not in its domain.
Status write_live(const LiveOrigin& origin, Session& session, MapWriter* out);

/// Into a session that init() has left. Null, or what is wrong with the bytes; then the session has to be initialised again, unless
/// *is_changed is false.
const char* read_live(const LiveOrigin& origin, const std::uint8_t* buffer, std::size_t bytes, Session* session,
                      bool* is_changed);

}  // namespace pf
