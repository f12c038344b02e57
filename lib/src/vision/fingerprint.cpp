#include "vision/fingerprint.h"

namespace pf {
namespace {

constexpr int kLanes = 4;  ///< independent chains, since one multiplication has to wait for the one before
constexpr std::uint64_t kFactors[kLanes] = {0x9e3779b97f4a7c15u, 0xbf58476d1ce4e5b9u, 0x94d049bb133111ebu,
                                            0xd6e8feb86659fd93u};

std::uint64_t rotate(std::uint64_t x, int bits) { return x << bits | x >> (64 - bits); }

/// One to one in each argument, so that images that differ in one word always differ.
std::uint64_t mix(std::uint64_t state, std::uint64_t word, std::uint64_t factor) {
  return rotate((state ^ word) * factor, 29);
}

std::uint64_t word_at(const std::uint8_t* bytes, int count) {
  std::uint64_t word = 0;
  __builtin_memcpy(&word, bytes, static_cast<std::size_t>(count));
  return word;
}

}  // namespace

std::uint64_t fingerprint(const ImageView& image) {
  constexpr int kWord = 8;
  std::uint64_t state[kLanes] = {static_cast<std::uint64_t>(image.width), static_cast<std::uint64_t>(image.height), 0,
                                 0};
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row = image.row(y);
    int x = 0;
    for (; x + kLanes * kWord <= image.width; x += kLanes * kWord)
      for (int i = 0; i < kLanes; ++i) state[i] = mix(state[i], word_at(row + x + i * kWord, kWord), kFactors[i]);
    for (; x < image.width; x += kWord) {
      const int rest = image.width - x;
      state[0] = mix(state[0], word_at(row + x, rest < kWord ? rest : kWord), kFactors[0]);
    }
  }
  for (int i = 1; i < kLanes; ++i) state[0] = mix(state[0], state[i], kFactors[i]);
  return state[0];
}

}  // namespace pf
