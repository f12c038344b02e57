#pragma once

#include <cstddef>
#include <cstdint>

#include "base/scalar.h"

/// Numbers and sections of a saved map as bytes: little-endian, whatever the processor (lib/docs/reference/map_format.md).

namespace pf {

constexpr std::uint32_t kMapVersion = 0;
constexpr std::uint32_t kPortableMap = 1, kContinuedMap = 2;  ///< kinds: PF_MAP_PORTABLE, PF_MAP_CONTINUE
constexpr std::size_t kMapHeader = 32, kSectionHeader = 24;
constexpr std::uint8_t kMapMagic[8] = {0x89, 'P', 'F', 'M', 'A', 'P', 0x0d, 0x0a};

constexpr std::uint32_t section_tag(const char (&name)[5]) {
  std::uint32_t tag = 0;
  for (int i = 0; i < 4; ++i) tag |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(name[i])) << (8 * i);
  return tag;
}

/// Writes into a buffer, or only counts where there is none or it is full.
class MapWriter {
 public:
  MapWriter(std::uint8_t* buffer, std::size_t bytes) : buffer_(buffer), bytes_(bytes) {}

  void u32(std::uint32_t value) { put(value, 4); }
  void u64(std::uint64_t value) { put(value, 8); }
  void real(double value);
  template <typename T>
  void reals(const T* values, int count) {
    for (int i = 0; i < count; ++i) real(static_cast<double>(values[i]));
  }
  void bytes(const std::uint8_t* from, std::size_t count);
  /// Leaves room for what the caller writes before the section ends. Null where it does not fit, or is only counted.
  std::uint8_t* take(std::size_t count) {
    used_ += count;
    return fits() ? buffer_ + used_ - count : nullptr;
  }

  /// The header, whose numbers end() fills in.
  void begin(std::uint32_t kind);
  void end();
  void begin_section(std::uint32_t tag);
  void end_section();

  std::size_t used() const { return used_; }
  bool fits() const { return buffer_ != nullptr && used_ <= bytes_; }

 private:
  void put(std::uint64_t value, int count);
  void set(std::size_t at, std::uint64_t value, int count);

  std::uint8_t* buffer_;
  std::size_t bytes_;
  std::size_t used_ = 0, section_ = 0;
  std::uint32_t sections_ = 0;
};

/// Reads numbers one after the other. What lies behind the end is zero, and sets failed().
class MapReader {
 public:
  MapReader(const std::uint8_t* buffer, std::size_t bytes) : at_(buffer), left_(bytes) {}

  std::uint32_t u32() { return static_cast<std::uint32_t>(get(4)); }
  std::uint64_t u64() { return get(8); }
  double real();
  /// False: one of them is not finite, or beyond `most` in size. The scalar of the library holds them.
  template <typename T>
  bool reals(T* values, int count, double most) {
    bool good = true;
    for (int i = 0; i < count; ++i) {
      const double value = real();
      const bool within = value >= -most && value <= most;  // NaN is not
      good = good && within;
      values[i] = within ? static_cast<T>(value) : T(0);
    }
    return good;
  }
  void bytes(std::uint8_t* to, std::size_t count);

  bool failed() const { return failed_; }
  std::size_t left() const { return left_; }

 private:
  std::uint64_t get(int count);

  const std::uint8_t* at_;
  std::size_t left_;
  bool failed_ = false;
};

/// One section.
struct MapSection {
  std::uint32_t tag = 0;
  const std::uint8_t* bytes = nullptr;
  std::size_t count = 0;
};

constexpr int kMaxSections = 16;

/// Checks header, lengths and CRCs of a whole map, and lists its sections. Null, or what is wrong with it.
const char* open_map(const std::uint8_t* buffer, std::size_t bytes, std::uint32_t kind, MapSection* sections,
                     int* count);

/// Kind of a map, whatever else is wrong with it; 0: it is none.
std::uint32_t map_kind(const std::uint8_t* buffer, std::size_t bytes);

}  // namespace pf
