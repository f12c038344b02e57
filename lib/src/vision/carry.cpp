#include "vision/carry.h"

#include "vision/image_mask.h"

namespace pf {
namespace {

constexpr int kMaxImageSide = 16384;  ///< of a config's, and more [px]

}  // namespace

void carry(Archive& archive, SourcePatch& patch) {
  auto& [pixels, centre_x, centre_y, begin_x, end_x, begin_y, end_y] = patch;
  for (int l = 0; l < SourcePatch::kLevels; ++l) {
    archive.bytes(pixels[l], sizeof pixels[l]);
    carry_pixels(archive, centre_x[l], centre_y[l]);
    archive.within(begin_x[l], 0, SourcePatch::kSize);
    archive.within(begin_y[l], 0, SourcePatch::kSize);
    archive.within(end_x[l], begin_x[l], SourcePatch::kSize);
    archive.within(end_y[l], begin_y[l], SourcePatch::kSize);
  }
}

void carry(Archive& archive, PlanarTemplate& shape, int max_side) {
  auto& [left, top, side, has_normal, frames, sigma_plane, sigma_other, area, slope, covariance] = shape;
  archive.within(left, -kMaxImageSide, kMaxImageSide);
  archive.within(top, -kMaxImageSide, kMaxImageSide);
  archive.within(side, PlanarTemplate::kMinSide, max_side);
  archive.flags(has_normal);
  archive.within(frames, 0, INT16_MAX);
  archive.numbers(sigma_plane, sigma_other, area, slope, covariance);
}

/// Behind its side squared it holds nothing. No more pixels are chosen than what aligns them has room for.
void carry(Archive& archive, PlanePatch& patch, int max_side) {
  auto& [left, top, side, levels, mean, pixels, chosen] = patch;
  archive.within(left, 0, kMaxImageSide);
  archive.within(top, 0, kMaxImageSide);
  archive.within(side, PlanePatch::kMinSide, max_side);
  archive.within(levels, 1, PlanePatch::kLevels);
  archive.numbers(mean);
  if (archive.failed()) return;
  archive.bytes(pixels, static_cast<std::size_t>(patch.level(levels) - pixels));
  archive.bytes(chosen, static_cast<std::size_t>(side * side + 7) / 8);
  if (!archive.is_reading() || archive.failed()) return;
  int samples = 0;
  for (int y = 1; y < side - 1; ++y)
    for (int x = 1; x < side - 1; ++x) samples += patch.is_chosen(x, y) ? 1 : 0;
  archive.require(samples <= PlanePatch::kMaxSamples && patch.side_of(levels - 1) >= 3);
}

void ImageMask::carry(Archive& archive) {
  for (int w = 0; w < (cells() + 31) / 32; ++w) archive.any(bits_[w]);
  if (!archive.is_reading()) return;
  masked_ = 0;
  for (int i = 0; i < cells(); ++i) masked_ += is_masked(i % columns_, i / columns_) ? 1 : 0;
}

}  // namespace pf
