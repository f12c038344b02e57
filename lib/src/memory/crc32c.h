#pragma once

#include <cstddef>
#include <cstdint>

namespace pf {

/// CRC-32C of bytes (Castagnoli's polynomial, reflected; "123456789" gives 0xe3069283). before: of the bytes before these, 0: none.
/// It detects damage, and does not prove who wrote the bytes.
std::uint32_t crc32c(const std::uint8_t* bytes, std::size_t count, std::uint32_t before = 0);

}  // namespace pf
