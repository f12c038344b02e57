#include "vision/align.h"

#include <cmath>

#include "vision/simd.h"
#include "vision/tuning.h"

namespace pf {

namespace {

using namespace tuning::align;

constexpr int kHalf = kAlignSize / 2;
constexpr int kRow = AlignTemplate::kRow;
constexpr int kVectors = kRow / 4;
constexpr float kPixels = static_cast<float>(kAlignSize * kAlignSize);

/// Grey levels about 128 around the start, wide enough for every place that the window may move to.
struct Region {
  static constexpr int kSlack = 3;  // whole pixels for kAlignReach
  static constexpr int kRows = kAlignSize + 2 * kSlack + 1;
  static constexpr int kStride = (kRow + 2 * kSlack + 1 + 3) / 4 * 4;
  static_assert(kSlack >= kAlignReach, "the window would leave the region");

  int left = 0;
  int top = 0;
  alignas(16) float grey[kRows * kStride];

  void fill(const ImageView& image, int centre_x, int centre_y) {
    left = centre_x - kHalf - kSlack;
    top = centre_y - kHalf - kSlack;
    const bool inside = left >= 0 && top >= 0 && left + kStride <= image.width && top + kRows <= image.height;
    for (int j = 0; j < kRows; ++j) {
      float* to = grey + j * kStride;
      if (inside) {
        const std::uint8_t* from = image.pixel(left, top + j);
        for (int i = 0; i < kStride; ++i) to[i] = static_cast<float>(static_cast<int>(from[i]) - 128);
      } else {
        const std::uint8_t* from = image.row(clamp(top + j, image.height));
        for (int i = 0; i < kStride; ++i) to[i] = static_cast<float>(from[clamp(left + i, image.width)] - 128);
      }
    }
  }

  static int clamp(int at, int size) { return at < 0 ? 0 : at >= size ? size - 1 : at; }
};

float smaller(float a, float b) { return a < b ? a : b; }

struct Sums {
  float v, vv, tv, xv, yv;  // Σ I, Σ I², Σ T I, Σ gx I, Σ gy I
};

/// Window whose first pixel is at (x, y) of the region. Pixels that fill up a row have no weight in any sum.
Sums evaluate(const Region& region, const AlignTemplate& pattern, float x, float y) {
  const int ix = static_cast<int>(x);
  const int iy = static_cast<int>(y);
  const F32x4 zero = {};
  const F32x4 fx = zero + (x - static_cast<float>(ix));
  const F32x4 fy = zero + (y - static_cast<float>(iy));
  F32x4 last = zero;
  for (int k = 0; k < 4; ++k) last[k] = kRow - 4 + k < kAlignSize ? 1.0f : 0.0f;

  F32x4 v = zero;
  F32x4 vv = zero;
  F32x4 tv = zero;
  F32x4 xv = zero;
  F32x4 yv = zero;
  const float* row = region.grey + iy * Region::kStride + ix;
  F32x4 above[kVectors];
  for (int k = 0; k < kVectors; ++k) {
    const F32x4 a = load<F32x4>(row + 4 * k);
    above[k] = a + fx * (load<F32x4>(row + 4 * k + 1) - a);
  }
  for (int j = 0; j < kAlignSize; ++j) {
    row += Region::kStride;
    for (int k = 0; k < kVectors; ++k) {
      const int at = j * kRow + 4 * k;
      const F32x4 a = load<F32x4>(row + 4 * k);
      const F32x4 below = a + fx * (load<F32x4>(row + 4 * k + 1) - a);
      F32x4 value = above[k] + fy * (below - above[k]);
      above[k] = below;
      if (k == kVectors - 1) value *= last;
      v += value;
      vv += value * value;
      tv += value * load<F32x4>(pattern.grey + at);
      xv += value * load<F32x4>(pattern.gx + at);
      yv += value * load<F32x4>(pattern.gy + at);
    }
  }
  return Sums{sum(v), sum(vv), sum(tv), sum(xv), sum(yv)};
}

/// Σ a b over all pixels; those that fill up a row are zero in one of the two.
float dot(const float* a, const float* b) {
  F32x4 total = {};
  for (int at = 0; at < kAlignSize * kRow; at += 4) total += load<F32x4>(a + at) * load<F32x4>(b + at);
  return sum(total);
}

/// Takes the mean of g and its part along the template out of g. ones is 1 on the pixels.
void project(const float* grey, const float* ones, float energy, float* g) {
  const float mean = dot(g, ones) / kPixels;
  const float along = dot(g, grey) / energy;
  for (int at = 0; at < kAlignSize * kRow; ++at) g[at] -= mean * ones[at] + along * grey[at];
}

/// Noise and normal matrix from the squared residuals at (x, y), both for independent noise of the same size in the
/// pixels of image and source. Two things would make them too good:
/// - Interpolation averages the image's noise away (to (1 - 2 f (1 - f)) of its variance in each direction), but not
///   where it matters, since gradients are smoother than noise.
/// - Noise in the template adds half its variance to that of each gradient, without information about the place.
void judge(const AlignTemplate& pattern, float squares, float x, float y, AlignResult* result) {
  const float fx = x - std::floor(x);
  const float fy = y - std::floor(y);
  const float kept = (1.0f - 2.0f * fx * (1.0f - fx)) * (1.0f - 2.0f * fy * (1.0f - fy));
  const float gain2 = result->gain * result->gain;
  const float variance = squares > 0.0f ? squares / ((kPixels - 4.0f) * (kept + gain2)) : 0.0f;
  result->rms = std::sqrt(variance * (1.0f + gain2));

  const float noise = smaller(0.5f * variance * kPixels, 0.75f * pattern.weakest);
  result->hxx = (pattern.hxx - noise) * gain2;
  result->hyy = (pattern.hyy - noise) * gain2;
  result->hxy = pattern.hxy * gain2;
}

}  // namespace

bool make_align_template(const float* warped, AlignTemplate* out) {
  alignas(16) float ones[kAlignSize * kRow];
  for (int j = 0; j < kAlignSize; ++j) {
    const float* row = warped + (j + 1) * kWarpSize + 1;
    const int at = j * kRow;
    for (int i = 0; i < kAlignSize; ++i) {
      ones[at + i] = 1.0f;
      out->grey[at + i] = row[i] - 128.0f;
      out->gx[at + i] = 0.5f * (row[i + 1] - row[i - 1]);
      out->gy[at + i] = 0.5f * (row[i + kWarpSize] - row[i - kWarpSize]);
    }
    for (int i = kAlignSize; i < kRow; ++i) ones[at + i] = out->grey[at + i] = out->gx[at + i] = out->gy[at + i] = 0.0f;
  }
  out->weakest = 0.0f;
  const float mean = dot(out->grey, ones) / kPixels;
  for (int at = 0; at < kAlignSize * kRow; ++at) out->grey[at] -= mean * ones[at];
  out->energy = dot(out->grey, out->grey);
  if (!(out->energy >= kMinContrast * kMinContrast * kPixels)) return false;
  project(out->grey, ones, out->energy, out->gx);
  project(out->grey, ones, out->energy, out->gy);
  out->hxx = dot(out->gx, out->gx);
  out->hxy = dot(out->gx, out->gy);
  out->hyy = dot(out->gy, out->gy);
  const float difference = out->hxx - out->hyy;
  out->weakest = 0.5f * (out->hxx + out->hyy - std::sqrt(difference * difference + 4.0f * out->hxy * out->hxy));
  return out->weakest >= kMinGradient * kMinGradient * kPixels && out->weakest >= kMinAspect * (out->hxx + out->hyy);
}

AlignResult align(const ImageView& image, const AlignTemplate& pattern, const Vec2& start) {
  AlignResult result;
  result.position = start;
  if (!(pattern.weakest > 0.0f)) return result;
  const float limit_x = static_cast<float>(image.width - 1 - kHalf);
  const float limit_y = static_cast<float>(image.height - 1 - kHalf);
  float x = static_cast<float>(start.x());
  float y = static_cast<float>(start.y());
  const auto is_inside = [&] {
    return x >= static_cast<float>(kHalf) && y >= static_cast<float>(kHalf) && x <= limit_x && y <= limit_y;
  };
  if (!is_inside()) return result;
  const float start_x = x;
  const float start_y = y;

  Region region;
  region.fill(image, static_cast<int>(x), static_cast<int>(y));
  const float det = pattern.hxx * pattern.hyy - pattern.hxy * pattern.hxy;
  const float origin_x = static_cast<float>(region.left + kHalf);
  const float origin_y = static_cast<float>(region.top + kHalf);
  for (int k = 1; k <= kAlignMaxIterations; ++k) {
    const Sums s = evaluate(region, pattern, x - origin_x, y - origin_y);
    const float gain = s.tv / pattern.energy;
    const float energy = s.vv - s.v * s.v / kPixels;
    if (!(gain > kMinGain) || !(energy > 0.0f)) return result;
    const float bx = s.xv / gain;
    const float by = s.yv / gain;
    const float step_x = -(pattern.hyy * bx - pattern.hxy * by) / det;
    const float step_y = -(pattern.hxx * by - pattern.hxy * bx) / det;
    x += step_x;
    y += step_y;
    if (!is_inside() || !(std::fabs(x - start_x) <= kAlignReach) || !(std::fabs(y - start_y) <= kAlignReach)) {
      return result;
    }
    result.iterations = k;
    result.position = Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y));
    result.zncc = s.tv / std::sqrt(energy * pattern.energy);
    result.gain = gain;
    judge(pattern, energy - s.tv * gain, x - step_x, y - step_y, &result);
    if (step_x * step_x + step_y * step_y < kSmallStep * kSmallStep) {
      result.converged = true;
      return result;
    }
  }
  return result;
}

}  // namespace pf
