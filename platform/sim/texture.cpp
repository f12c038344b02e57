#include "sim/texture.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace pf::sim {

Texture::Texture(const Canvas& canvas) : texels_per_m_(static_cast<float>(1.0 / canvas.texel_m)) {
  std::vector<float> grey = canvas.grey;
  int width = canvas.width, height = canvas.height;
  for (;;) {
    Level level{width, height, std::vector<std::uint8_t>(grey.size())};
    std::transform(grey.begin(), grey.end(), level.grey.begin(),
                   [](float g) { return static_cast<std::uint8_t>(std::clamp(g, 0.0f, 255.0f) + 0.5f); });
    levels_.push_back(std::move(level));
    if (std::min(width, height) < 4) break;
    const int w = width / 2, h = height / 2;
    std::vector<float> half(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    for (int j = 0; j < h; ++j)
      for (int i = 0; i < w; ++i) {
        const float* a =
            &grey[static_cast<std::size_t>(2 * j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(2 * i)];
        half[static_cast<std::size_t>(j) * static_cast<std::size_t>(w) + static_cast<std::size_t>(i)] =
            0.25f * (a[0] + a[1] + a[width] + a[width + 1]);
      }
    grey = std::move(half);
    width = w;
    height = h;
  }
}

float Texture::bilinear(const Level& level, float x, float y) {
  x = std::clamp(x - 0.5f, 0.0f, static_cast<float>(level.width - 1));
  y = std::clamp(y - 0.5f, 0.0f, static_cast<float>(level.height - 1));
  const int i = std::min(static_cast<int>(x), level.width - 2);
  const int j = std::min(static_cast<int>(y), level.height - 2);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  const std::uint8_t* p = level.grey.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(level.width) + i;
  const std::uint8_t* q = p + level.width;
  const float top = static_cast<float>(p[0]) + a * static_cast<float>(p[1] - p[0]);
  const float bottom = static_cast<float>(q[0]) + a * static_cast<float>(q[1] - q[0]);
  return top + b * (bottom - top);
}

float Texture::sample(float u_m, float v_m, float footprint_m) const {
  const float x = u_m * texels_per_m_, y = v_m * texels_per_m_;
  const float texels = std::max(footprint_m * texels_per_m_, 1.0f);

  // Level log2(texels), with the mantissa for its fraction: close enough, and without a logarithm per pixel.
  std::uint32_t bits;
  std::memcpy(&bits, &texels, sizeof bits);
  int fine = static_cast<int>(bits >> 23) - 127;
  float share = static_cast<float>(bits & 0x7fffffu) * 0x1p-23f;
  const int last = static_cast<int>(levels_.size()) - 1;
  if (fine >= last) {
    fine = last;
    share = 0;
  }
  const float scale = 1.0f / static_cast<float>(1 << fine);
  const float a = bilinear(levels_[static_cast<std::size_t>(fine)], x * scale, y * scale);
  if (share < 0.05f) return a;
  const float b = bilinear(levels_[static_cast<std::size_t>(fine + 1)], x * scale * 0.5f, y * scale * 0.5f);
  return a + share * (b - a);
}

Four Texture::bilinear(const Level& level, Four x, Four y) {
  const Four zero = four(0.0f);
  const Four right = four(static_cast<float>(level.width - 1)), low = four(static_cast<float>(level.height - 1));
  x -= 0.5f;
  y -= 0.5f;
  x = x < zero ? zero : (right < x ? right : x);
  y = y < zero ? zero : (low < y ? low : y);
  FourInts i = __builtin_convertvector(x, FourInts), j = __builtin_convertvector(y, FourInts);
  const FourInts last_i = four(level.width - 2), last_j = four(level.height - 2);
  i = last_i < i ? last_i : i;
  j = last_j < j ? last_j : j;
  const Four a = x - __builtin_convertvector(i, Four), b = y - __builtin_convertvector(j, Four);
  const auto texel = [&](int k) {
    return level.grey.data() + static_cast<std::size_t>(j[k]) * static_cast<std::size_t>(level.width) + i[k];
  };
  const std::uint8_t *p = texel(0), *q = texel(1), *r = texel(2), *s = texel(3);
  const std::ptrdiff_t w = level.width;
  const FourInts p0 = {p[0], q[0], r[0], s[0]}, p1 = {p[1], q[1], r[1], s[1]};
  const FourInts q0 = {p[w], q[w], r[w], s[w]}, q1 = {p[w + 1], q[w + 1], r[w + 1], s[w + 1]};
  const Four top = __builtin_convertvector(p0, Four) + a * __builtin_convertvector(p1 - p0, Four);
  const Four bottom = __builtin_convertvector(q0, Four) + a * __builtin_convertvector(q1 - q0, Four);
  return top + b * (bottom - top);
}

Four Texture::sample(Four u_m, Four v_m, Four footprint_m) const {
  const Four one = four(1.0f);
  Four texels = footprint_m * texels_per_m_;
  texels = texels < one ? one : texels;
  FourInts bits;
  std::memcpy(&bits, &texels, sizeof bits);
  const FourInts level = (bits >> 23) - 127;
  const int fine = level[0], last = static_cast<int>(levels_.size()) - 1;
  if (!all_equal(level) || fine >= last)
    return Four{sample(u_m[0], v_m[0], footprint_m[0]), sample(u_m[1], v_m[1], footprint_m[1]),
                sample(u_m[2], v_m[2], footprint_m[2]), sample(u_m[3], v_m[3], footprint_m[3])};
  const Four share = __builtin_convertvector(bits & 0x7fffff, Four) * 0x1p-23f;
  const float scale = 1.0f / static_cast<float>(1 << fine);
  const Four x = u_m * texels_per_m_ * scale, y = v_m * texels_per_m_ * scale;
  const Four a = bilinear(levels_[static_cast<std::size_t>(fine)], x, y);
  const FourInts near = share < four(0.05f);
  if (!any(~near)) return a;
  const Four b = bilinear(levels_[static_cast<std::size_t>(fine + 1)], x * 0.5f, y * 0.5f);
  return near ? a : a + share * (b - a);
}

}  // namespace pf::sim
