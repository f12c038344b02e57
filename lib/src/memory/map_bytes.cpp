#include "memory/map_bytes.h"

#include <cstring>

#include "memory/crc32c.h"

namespace pf {
namespace {

static_assert(sizeof(double) == 8, "IEEE 754 binary64");

constexpr std::size_t kTotalAt = 16, kSectionsAt = 24, kHeaderCrcAt = 28;
constexpr std::size_t kLengthAt = 8, kSectionCrcAt = 16;

std::uint32_t header_crc(const std::uint8_t* header) { return crc32c(header, kHeaderCrcAt); }

/// Of a section's header up to its CRC, and of what it holds.
std::uint32_t section_crc(const std::uint8_t* section, std::size_t length) {
  return crc32c(section + kSectionHeader, length, crc32c(section, kSectionCrcAt));
}

}  // namespace

void MapWriter::put(std::uint64_t value, int count) {
  const std::size_t at = used_;
  used_ += static_cast<std::size_t>(count);
  set(at, value, count);
}

void MapWriter::set(std::size_t at, std::uint64_t value, int count) {
  if (buffer_ == nullptr || at + static_cast<std::size_t>(count) > bytes_) return;
  for (int i = 0; i < count; ++i)
    buffer_[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (8 * i));
}

void MapWriter::real(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  u64(bits);
}

void MapWriter::bytes(const std::uint8_t* from, std::size_t count) {
  if (buffer_ != nullptr && used_ + count <= bytes_) std::memcpy(buffer_ + used_, from, count);
  used_ += count;
}

void MapWriter::begin(std::uint32_t kind) {
  bytes(kMapMagic, sizeof kMapMagic);
  u32(kMapVersion);
  u32(kind);
  u64(0);
  u32(0);
  u32(0);
}

void MapWriter::end() {
  set(kTotalAt, used_, 8);
  set(kSectionsAt, sections_, 4);
  if (fits()) set(kHeaderCrcAt, header_crc(buffer_), 4);
}

void MapWriter::begin_section(std::uint32_t tag) {
  section_ = used_;
  ++sections_;
  u32(tag);
  u32(0);
  u64(0);
  u32(0);
  u32(0);
}

void MapWriter::end_section() {
  const std::size_t length = used_ - section_ - kSectionHeader;
  set(section_ + kLengthAt, length, 8);
  if (fits()) set(section_ + kSectionCrcAt, section_crc(buffer_ + section_, length), 4);
}

std::uint64_t MapReader::get(int count) {
  if (left_ < static_cast<std::size_t>(count)) {
    failed_ = true;
    left_ = 0;
    return 0;
  }
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value |= static_cast<std::uint64_t>(at_[i]) << (8 * i);
  at_ += count;
  left_ -= static_cast<std::size_t>(count);
  return value;
}

double MapReader::real() {
  const std::uint64_t bits = u64();
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void MapReader::bytes(std::uint8_t* to, std::size_t count) {
  if (left_ < count) {
    failed_ = true;
    left_ = 0;
    std::memset(to, 0, count);
    return;
  }
  std::memcpy(to, at_, count);
  at_ += count;
  left_ -= count;
}

std::uint32_t map_kind(const std::uint8_t* buffer, std::size_t bytes) {
  if (bytes < kMapHeader || std::memcmp(buffer, kMapMagic, sizeof kMapMagic) != 0) return 0;
  MapReader header(buffer + sizeof kMapMagic, kMapHeader - sizeof kMapMagic);
  header.u32();
  return header.u32();
}

const char* open_map(const std::uint8_t* buffer, std::size_t bytes, std::uint32_t kind, MapSection* sections,
                     int* count) {
  if (bytes < kMapHeader || std::memcmp(buffer, kMapMagic, sizeof kMapMagic) != 0) return "it is no saved map";
  MapReader header(buffer + sizeof kMapMagic, kMapHeader - sizeof kMapMagic);
  if (header.u32() != kMapVersion) return "its format is of another version";
  if (header.u32() != kind) return "it is of another kind";
  const std::uint64_t total = header.u64();
  const std::uint32_t announced = header.u32();
  if (header.u32() != header_crc(buffer)) return "its header is damaged";
  if (total != bytes) return total > bytes ? "its end is missing" : "it goes on behind its end";
  if (announced > kMaxSections) return "it has too many sections";
  *count = 0;
  std::size_t at = kMapHeader;
  for (std::uint32_t s = 0; s < announced; ++s) {
    if (bytes - at < kSectionHeader) return "a section is missing";
    MapReader section(buffer + at, kSectionHeader);
    const std::uint32_t tag = section.u32(), version = section.u32();
    const std::uint64_t length = section.u64();
    const std::uint32_t crc = section.u32(), reserved = section.u32();
    if (length > bytes - at - kSectionHeader) return "a section is longer than the map";
    if (crc != section_crc(buffer + at, static_cast<std::size_t>(length))) return "a section is damaged";
    if (version != 0 || reserved != 0) return "a section is of another version";
    sections[(*count)++] = {tag, buffer + at + kSectionHeader, static_cast<std::size_t>(length)};
    at += kSectionHeader + static_cast<std::size_t>(length);
  }
  return at == bytes ? nullptr : "there are bytes behind its last section";
}

}  // namespace pf
