#include "levels.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace pf::sequence {

namespace {

constexpr int32_t kLargest = 65535;
constexpr int kBits[] = {8, 10, 12, 14};
constexpr double kTail = 0.001;        ///< share of the pixels that may lie outside of the band at each end: dead ones
constexpr int32_t kBandOfThermal = 3;  ///< a band narrower than a third of its upper end is no picture of light
constexpr int32_t kMinBand = 64;       ///< a narrower one holds nothing but noise

/// The number below which a share of the counts lies.
int32_t quantile(const std::vector<uint32_t>& histogram, double share) {
  const double total = std::accumulate(histogram.begin(), histogram.end(), 0.0);
  double sum = 0.0;
  for (size_t i = 0; i < histogram.size(); ++i) {
    sum += histogram[i];
    if (sum >= share * total && sum > 0.0) {
      return static_cast<int32_t>(i);
    }
  }
  return kLargest;
}

}  // namespace

int32_t white_for(int32_t brightest) {
  for (const int bits : kBits) {
    if (brightest < (1 << bits)) {
      return (1 << bits) - 1;
    }
  }
  return 0;
}

Levels levels_of(const std::vector<uint32_t>& histogram, const std::string& image) {
  Levels levels;
  const auto last = std::find_if(histogram.rbegin(), histogram.rend(), [](uint32_t count) { return count > 0; });
  const auto brightest = static_cast<int32_t>(histogram.rend() - last) - 1;
  if (brightest <= 0) {
    return levels;  // black, or no number of 16 bits
  }
  char text[320];
  const int32_t low = quantile(histogram, kTail);
  const int32_t high = quantile(histogram, 1.0 - kTail);
  const int32_t band = high - low;
  if (band >= kMinBand && kBandOfThermal * band < high) {
    levels.black = std::max(0, low - band / 2);
    levels.white = std::min(kLargest, high + band / 2);
    levels.stretched = true;
    std::snprintf(text, sizeof(text),
                  ": has 16 bits, and its numbers lie between %d and %d, as those of raw thermal images: %d to %d "
                  "become black to "
                  "white; to choose yourself, give images of 8 bits (ImageMagick: mogrify -level %d,%d -depth 8)",
                  low, high, levels.black, levels.white, low, high);
    levels.note = image + text;
    return levels;
  }
  levels.white = white_for(brightest);
  if (levels.white > 0) {
    std::snprintf(text, sizeof(text),
                  ": has 16 bits, but no number above %d: taken as data of fewer bits, so that %d becomes white; to "
                  "choose yourself, "
                  "scale them up to 65535 (ImageMagick: mogrify -evaluate multiply %d)",
                  brightest, levels.white, (kLargest + 1) / (levels.white + 1));
    levels.note = image + text;
  }
  return levels;
}

}  // namespace pf::sequence
