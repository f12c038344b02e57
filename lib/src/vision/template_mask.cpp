#include "vision/template_mask.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "vision/tuning.h"

namespace pf {
namespace {

using namespace tuning::template_mask;

constexpr float kByte = 255.0f;
constexpr float kOddsStep = 0.1f;          ///< log odds of one in a byte
constexpr int kStrideX = 5, kStrideY = 3;  ///< of the pixels from which an image's noise is estimated
constexpr int kBins = 512;                 ///< of |L|, L = [1 -2 1; -2 4 -2; 1 -2 1] * I
constexpr float kNoiseGain = 6.0f;         ///< standard deviation of L, of noise of unit variance
constexpr float kQuarter = 0.31864f;       ///< of |x|, x of unit variance, below which a quarter lies
constexpr int kSide = SourcePatch::kSize;

/// 255 p by log odds, for all bytes.
struct Probabilities {
  std::uint8_t of[256] = {};
  constexpr Probabilities() {
    constexpr double kStep = 1.1051709180756477;  // e^0.1, of kOddsStep
    double odds = 1;
    for (int byte = kMaskUnknown; byte < kMaskFull; ++byte, odds *= kStep) put(byte, odds);
    odds = 1;
    for (int byte = kMaskUnknown; byte > 0; --byte, odds /= kStep) put(byte, odds);
    of[kMaskFull] = kMaskFull;
  }
  constexpr void put(int byte, double odds) {
    const double p = 255 * odds / (1 + odds) + 0.5;
    of[byte] = p < 1 ? std::uint8_t{1} : static_cast<std::uint8_t>(p);
  }
};
constexpr Probabilities kProbability;

int inside(int at) { return std::clamp(at, 0, kSide - 1); }

}  // namespace

std::uint8_t mask_probability(std::uint8_t odds) { return kProbability.of[odds]; }

std::uint8_t updated_odds(std::uint8_t odds, float residual, float sigma_plane, float sigma_other) {
  // On the plane the density falls faster, so the power is never above 0.
  const float power = 0.5f * (1.0f / (sigma_other * sigma_other) - 1.0f / (sigma_plane * sigma_plane));
  const float said = std::log(sigma_other / sigma_plane) + residual * residual * power;
  const float next = static_cast<float>(odds) + said / kOddsStep;
  return static_cast<std::uint8_t>(std::clamp(next, static_cast<float>(kMaskLeast), static_cast<float>(kMaskMost)) +
                                   0.5f);
}

std::uint8_t learn_pixel(std::uint8_t odds, const MaskEvidence& evidence, float sigma_plane, float sigma_other) {
  if (!evidence.valid || odds == 0) return odds;
  const std::uint8_t next = updated_odds(odds, evidence.residual, sigma_plane, sigma_other);
  return next < odds && std::fabs(evidence.residual) <= evidence.slack ? odds : next;
}

float mask_area(const std::uint8_t* mask, int count) {
  int sum = 0;
  for (int i = 0; i < count; ++i) sum += mask_probability(mask[i]);
  return static_cast<float>(sum) / kByte;
}

void begin_template(const SourcePatch& patch, const Vec2& pixel, int side, bool full, float noise, PlanarTemplate* out,
                    std::uint8_t* mask) {
  const int half = side / 2;
  const int x0 = static_cast<int>(patch.centre_x[0] + 0.5f) - half;
  const int y0 = static_cast<int>(patch.centre_y[0] + 0.5f) - half;
  *out = PlanarTemplate();
  // Of the patch's first pixel in the image; its centre is the pixel's place in it.
  const int left = static_cast<int>(std::lround(pixel.x() - static_cast<Scalar>(patch.centre_x[0])));
  const int top = static_cast<int>(std::lround(pixel.y() - static_cast<Scalar>(patch.centre_y[0])));
  out->left = static_cast<std::int16_t>(left + x0);
  out->top = static_cast<std::int16_t>(top + y0);
  out->side = static_cast<std::uint8_t>(side);
  int n = 0;
  float sum = 0, squares = 0, gradients = 0;
  const std::uint8_t* pixels = patch.pixels[0];
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const int x = x0 + i, y = y0 + j;
      const bool there = x >= patch.begin_x[0] && x < patch.end_x[0] && y >= patch.begin_y[0] && y < patch.end_y[0];
      mask[j * side + i] = there ? (full ? kMaskFull : kMaskUnknown) : 0;
      if (!there) continue;
      const float grey = static_cast<float>(pixels[y * kSide + x]);
      const int gx = pixels[y * kSide + inside(x + 1)] - pixels[y * kSide + inside(x - 1)];
      const int gy = pixels[inside(y + 1) * kSide + x] - pixels[inside(y - 1) * kSide + x];
      ++n;
      sum += grey;
      squares += grey * grey;
      gradients += 0.25f * static_cast<float>(gx * gx + gy * gy);
    }
  const float count = static_cast<float>(std::max(n, 1)), mean = sum / count;
  const float variance = std::max(squares / count - mean * mean, 0.0f);
  const float on_plane = 2.0f * noise * noise + kWarpError * kWarpError * gradients / count;
  out->sigma_plane = std::clamp(std::sqrt(on_plane), kMinSigmaPlane, kMaxSigmaPlane);
  out->sigma_other = std::clamp(std::sqrt(2.0f * variance), kMinSigmaOther, kMaxSigmaOther);
  out->area = mask_area(mask, side * side);
}

float image_noise(const ImageView& image) {
  int bin[kBins] = {};
  int count = 0;
  for (int y = 1; y + 1 < image.height; y += kStrideY) {
    const std::uint8_t *above = image.row(y - 1), *row = image.row(y), *below = image.row(y + 1);
    for (int x = 1; x + 1 < image.width; x += kStrideX) {
      if (row[x] <= kDark || row[x] >= kBright) continue;
      const int sides = above[x] + below[x] + row[x - 1] + row[x + 1];
      const int corners = above[x - 1] + above[x + 1] + below[x - 1] + below[x + 1];
      const int l = corners - 2 * sides + 4 * row[x];
      ++bin[std::min(l < 0 ? -l : l, kBins - 1)];
      ++count;
    }
  }
  if (count == 0) return 0.0f;
  const float wanted = 0.25f * static_cast<float>(count);
  float below = 0;
  int at = 0;
  while (at < kBins - 1 && below + static_cast<float>(bin[at]) < wanted) below += static_cast<float>(bin[at++]);
  const float part = bin[at] > 0 ? (wanted - below) / static_cast<float>(bin[at]) : 0.5f;
  // |L| = 0 has half the width of the other values.
  const float level = at == 0 ? 0.5f * part : static_cast<float>(at) - 0.5f + part;
  return level / (kNoiseGain * kQuarter);
}

}  // namespace pf
