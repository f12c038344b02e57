#include "vision/descriptor.h"

#include <cmath>

namespace pf {
namespace {

constexpr int kRadius = 10;  ///< [px] of the places that are compared
constexpr int kBits = 64 * Descriptor::kWords;

struct Pair {
  std::int8_t ax, ay, bx, by;
};

/// Pairs of places in the circle, drawn once and for all by the compiler; denser towards the middle.
struct Pattern {
  Pair pair[kBits] = {};

  constexpr Pattern() {
    std::uint32_t state = 20070831u;
    for (Pair& p : pair) {
      do {
        p.ax = draw(&state);
        p.ay = draw(&state);
        p.bx = draw(&state);
        p.by = draw(&state);
      } while (!is_inside(p.ax, p.ay) || !is_inside(p.bx, p.by) || (p.ax == p.bx && p.ay == p.by));
    }
  }

  static constexpr bool is_inside(int x, int y) { return x * x + y * y <= kRadius * kRadius; }
  /// Sum of two uniform numbers, from -kRadius to kRadius.
  static constexpr std::int8_t draw(std::uint32_t* state) {
    int sum = 0;
    for (int k = 0; k < 2; ++k) {
      *state = *state * 1664525u + 1013904223u;
      sum += static_cast<int>((*state >> 8) % static_cast<std::uint32_t>(kRadius + 1));
    }
    return static_cast<std::int8_t>(sum - kRadius);
  }
};

constexpr Pattern kPattern;

int sum_of_9(const ImageView& image, int x, int y) {
  int sum = 0;
  for (int v = y - 1; v <= y + 1; ++v) {
    const std::uint8_t* row = image.pixel(x, v);
    sum += row[-1] + row[0] + row[1];
  }
  return sum;
}

/// Cosine and sine of the direction from the middle to the centroid of the grey levels.
void find_orientation(const ImageView& image, int x, int y, float* c, float* s) {
  int mx = 0, my = 0;
  for (int v = -kRadius; v <= kRadius; ++v) {
    const std::uint8_t* row = image.pixel(x, y + v);
    for (int u = -kRadius; u <= kRadius; ++u) {
      if (!Pattern::is_inside(u, v)) continue;
      mx += u * row[u];
      my += v * row[u];
    }
  }
  const float fx = static_cast<float>(mx), fy = static_cast<float>(my), length = std::sqrt(fx * fx + fy * fy);
  *c = length > 0.0f ? fx / length : 1.0f;
  *s = length > 0.0f ? fy / length : 0.0f;
}

int nearest(float x) { return static_cast<int>(std::floor(x + 0.5f)); }

}  // namespace

bool describe(const ImageView& image, const Vec2& pixel, Descriptor* out) {
  // Written so that NaN fails.
  if (!(pixel.x() >= Scalar(0) && pixel.y() >= Scalar(0) && pixel.x() < static_cast<Scalar>(image.width) &&
        pixel.y() < static_cast<Scalar>(image.height)))
    return false;
  const int x = nearest(static_cast<float>(pixel.x())), y = nearest(static_cast<float>(pixel.y()));
  if (!image.contains(x, y, kDescriptorMargin)) return false;
  float c, s;
  find_orientation(image, x, y, &c, &s);
  const auto mean_at = [&](int u, int v) {
    const float fu = static_cast<float>(u), fv = static_cast<float>(v);
    return sum_of_9(image, x + nearest(c * fu - s * fv), y + nearest(s * fu + c * fv));
  };
  for (int w = 0; w < Descriptor::kWords; ++w) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i) {
      const Pair& p = kPattern.pair[64 * w + i];
      bits |= static_cast<std::uint64_t>(mean_at(p.ax, p.ay) < mean_at(p.bx, p.by)) << i;
    }
    out->word[w] = bits;
  }
  return true;
}

bool describe(const SourcePatch& patch, Descriptor* out) {
  constexpr int kLevel = 1;
  const int left = patch.begin_x[kLevel], top = patch.begin_y[kLevel];
  const ImageView inside = {patch.pixels[kLevel] + top * SourcePatch::kSize + left, patch.end_x[kLevel] - left,
                            patch.end_y[kLevel] - top, SourcePatch::kSize};
  const Vec2 at(static_cast<Scalar>(patch.centre_x[kLevel]) - static_cast<Scalar>(left),
                static_cast<Scalar>(patch.centre_y[kLevel]) - static_cast<Scalar>(top));
  return describe(inside, at, out);
}

int distance(const Descriptor& a, const Descriptor& b) {
  // Bits are counted in pairs, fours and bytes: the instruction for it is not in every processor.
  std::uint64_t bytes = 0;
  for (int w = 0; w < Descriptor::kWords; ++w) {
    std::uint64_t x = a.word[w] ^ b.word[w];
    x -= x >> 1 & 0x5555555555555555u;
    x = (x & 0x3333333333333333u) + (x >> 2 & 0x3333333333333333u);
    bytes += (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  }
  const std::uint64_t pairs = (bytes & 0x00ff00ff00ff00ffu) + (bytes >> 8 & 0x00ff00ff00ff00ffu);
  return static_cast<int>((pairs * 0x0001000100010001u) >> 48);
}

}  // namespace pf
