#include "vision/plane_patch.h"

#include <cmath>
#include <cstring>

#include "vision/tuning.h"

namespace pf {
namespace {

constexpr int kBins = 512;  ///< of |gx| + |gy|, doubled central differences

struct Gradient {
  int x, y;
};

/// Twice the gradient of a pixel that has neighbours.
Gradient doubled_gradient(const std::uint8_t* at, int stride) { return {at[1] - at[-1], at[stride] - at[-stride]}; }

int strength(const Gradient& g) { return (g.x < 0 ? -g.x : g.x) + (g.y < 0 ? -g.y : g.y); }

/// Calls f(x, y, gradient) for the pixels of level 0 that have neighbours.
template <typename F>
void for_each_inner(const PlanePatch& patch, F&& f) {
  for (int y = 1; y < patch.side - 1; ++y)
    for (int x = 1; x < patch.side - 1; ++x) f(x, y, doubled_gradient(patch.pixels + y * patch.side + x, patch.side));
}

/// Takes all pixels above a threshold, and of those on it as many as fit, evenly.
void choose(PlanePatch* patch) {
  int bin[kBins] = {};
  for_each_inner(*patch, [&](int, int, const Gradient& g) { ++bin[strength(g)]; });
  int threshold = kBins, above = 0;
  while (threshold > 0 && above + bin[threshold - 1] <= PlanePatch::kMaxSamples) above += bin[--threshold];
  const int on = threshold > 0 ? bin[threshold - 1] : 1, room = PlanePatch::kMaxSamples - above;
  int share = 0;
  std::memset(patch->chosen, 0, sizeof patch->chosen);
  for_each_inner(*patch, [&](int x, int y, const Gradient& g) {
    bool take = strength(g) >= threshold;
    if (strength(g) == threshold - 1) {
      share += room;
      take = share >= on;
      if (take) share -= on;
    }
    const int at = y * patch->side + x;
    if (take) patch->chosen[at / 8] = static_cast<std::uint8_t>(patch->chosen[at / 8] | 1 << (at % 8));
  });
}

/// The weaker eigenvalue of the mean of g g^T over all pixels, against what alignment needs.
bool has_texture(const PlanePatch& patch) {
  float xx = 0, xy = 0, yy = 0;
  for_each_inner(patch, [&](int, int, const Gradient& g) {
    xx += static_cast<float>(g.x * g.x);
    xy += static_cast<float>(g.x * g.y);
    yy += static_cast<float>(g.y * g.y);
  });
  const float difference = xx - yy;
  const float weakest = 0.5f * (xx + yy - std::sqrt(difference * difference + 4.0f * xy * xy));
  const float needed = 2.0f * tuning::plane_patch::kMinGradient;
  return weakest >= needed * needed * static_cast<float>((patch.side - 2) * (patch.side - 2));
}

}  // namespace

bool extract_plane_patch(const ImageView& image, int left, int top, int side, PlanePatch* patch) {
  if (side < PlanePatch::kMinSide || side > PlanePatch::kMaxSide || left < 0 || top < 0 || left > image.width - side ||
      top > image.height - side)
    return false;
  patch->left = static_cast<std::int16_t>(left);
  patch->top = static_cast<std::int16_t>(top);
  patch->side = static_cast<std::int16_t>(side);
  int sum = 0;
  for (int y = 0; y < side; ++y) {
    std::memcpy(patch->pixels + y * side, image.pixel(left, top + y), static_cast<std::size_t>(side));
    for (int x = 0; x < side; ++x) sum += image.at(left + x, top + y);
  }
  patch->mean = static_cast<float>(sum) / static_cast<float>(side * side);
  if (!has_texture(*patch)) return false;
  std::uint8_t* to = patch->pixels;
  for (patch->levels = 1; patch->levels < PlanePatch::kLevels; ++patch->levels) {
    const int l = patch->levels;
    if (patch->side_of(l) < PlanePatch::kMinSide) break;
    const ImageView from{to, patch->side_of(l - 1), patch->side_of(l - 1), patch->side_of(l - 1)};
    to += from.width * from.width;
    halve(from, to, patch->side_of(l));
  }
  choose(patch);
  return true;
}

}  // namespace pf
