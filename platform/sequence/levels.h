#ifndef PLANEFOLD_PLATFORM_SEQUENCE_LEVELS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_LEVELS_H

#include <cstdint>
#include <string>
#include <vector>

namespace pf::sequence {

/// Which numbers of 16 bits become black and white.
struct Levels {
  int32_t black = 0;
  int32_t white = 0;       ///< 0: 65535, as the file says
  bool stretched = false;  ///< to what the images hold: numbers outside are black or white
  std::string note;        ///< why, for the user; empty where the file is believed
};

constexpr size_t kNumbersOf16Bits = 65536;

/// By the numbers of some images of a sequence: data of 8, 10, 12 or 14 bits are scaled up, and raw thermal images, whose numbers all
/// lie in a narrow band, are stretched.
/// histogram  kNumbersOf16Bits counts
/// image      for the note
Levels levels_of(const std::vector<uint32_t>& histogram, const std::string& image);

/// The white of the fewest bits that hold a number; 0 for 16 bits.
int32_t white_for(int32_t brightest);

}  // namespace pf::sequence

#endif
