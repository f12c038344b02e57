#include "gross_patches.h"

#include <algorithm>
#include <cmath>

namespace pfsim {
namespace {

constexpr std::uint64_t kStream = 61;
constexpr std::size_t kMaxPatches = 32;
constexpr double kLeast = 4, kMost = 10;  // that a patch is moved by [px]
constexpr double kMargin = 12;            // around a patch that moves with it [px]
constexpr double kTurn = 6.283185307179586;

}  // namespace

GrossPatches::GrossPatches(double share, std::uint64_t seed) : share_(share), random_(seed, kStream) {}

pf_image_t GrossPatches::spoil(const pf_slam_t* slam, const pf_image_t& image) {
  pf_image_t spoilt = image;
  if (share_ <= 0) return spoilt;
  pixels_.assign(image.pixels, image.pixels + static_cast<std::size_t>(image.stride * image.height));
  spoilt.pixels = pixels_.data();
  pf_patch_t patches[kMaxPatches];
  std::size_t count = 0;
  if (pf_get_patches(slam, patches, kMaxPatches, &count) < PF_OK) return spoilt;
  for (std::size_t i = 0; i < std::min(count, kMaxPatches); ++i)
    if (patches[i].status == PF_MATCH_INLIER && random_.uniform() < share_) move(patches[i], image);
  return spoilt;
}

void GrossPatches::move(const pf_patch_t& patch, const pf_image_t& image) {
  const double by = random_.uniform(kLeast, kMost), direction = random_.uniform(0, kTurn);
  const int dx = static_cast<int>(std::lround(by * std::cos(direction)));
  const int dy = static_cast<int>(std::lround(by * std::sin(direction)));
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  for (const double* corner : patch.corners_px)
    for (int a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], corner[a] - kMargin);
      high[a] = std::max(high[a], corner[a] + kMargin);
    }
  const auto limit = [](double at, int size) { return static_cast<int>(std::clamp(at, 0.0, size - 1.0)); };
  for (int y = limit(low[1], image.height); y <= limit(high[1], image.height); ++y)
    for (int x = limit(low[0], image.width); x <= limit(high[0], image.width); ++x) {
      const int from_x = std::clamp(x - dx, 0, image.width - 1), from_y = std::clamp(y - dy, 0, image.height - 1);
      pixels_[static_cast<std::size_t>(y * image.stride + x)] = image.pixels[from_y * image.stride + from_x];
    }
}

}  // namespace pfsim
