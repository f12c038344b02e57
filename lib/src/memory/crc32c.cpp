#include "memory/crc32c.h"

namespace pf {
namespace {

struct Table {
  std::uint32_t of[256] = {};

  constexpr Table() {
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t crc = i;
      for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? crc >> 1 ^ 0x82f63b78u : crc >> 1;
      of[i] = crc;
    }
  }
};

constexpr Table kTable;

}  // namespace

std::uint32_t crc32c(const std::uint8_t* bytes, std::size_t count, std::uint32_t before) {
  std::uint32_t crc = ~before;
  for (std::size_t i = 0; i < count; ++i) crc = kTable.of[(crc ^ bytes[i]) & 255u] ^ crc >> 8;
  return ~crc;
}

}  // namespace pf
