#include "vision/plane_samples.h"

#include <cmath>

#include "vision/tuning.h"

namespace pf {
namespace {

using namespace tuning::plane_patch;

constexpr int kBins = 512;
constexpr float kBinsPerGrey = 2.0f;
constexpr float kMedian = 0.6745f;       // of |x|, x of unit variance
constexpr float kTrim = 2.5f;            // [standard deviations]
constexpr float kWithinTrim = 0.98758f;  // share of normal numbers
constexpr int kTrimRounds = 6;

PF_ALWAYS_INLINE F32x4 clamp(const F32x4& v, float high) { return smaller(larger(v, F32x4{}), F32x4{} + high); }

/// 1 where v is from low to high, 0 elsewhere and for NaN.
PF_ALWAYS_INLINE F32x4 between(const F32x4& v, float low, float high) {
  const I32x4 in = (v >= low) & (v <= high);
  return (F32x4)(in & (I32x4)(F32x4{} + 1.0f));
}

/// The four pixels around a place, of four places at once.
struct Corners {
  F32x4 grey[4];  ///< left and right above, left and right below

  PF_ALWAYS_INLINE Corners(const ImageView& image, const I32x4& x, const I32x4& y) {
    U32x4 four;
    for (int k = 0; k < 4; ++k) {
      const std::uint8_t* p = image.pixel(x[k], y[k]);
      const std::uint8_t* q = p + image.stride;
      const unsigned top = static_cast<unsigned>(p[0] | p[1] << 8), bottom = static_cast<unsigned>(q[0] | q[1] << 8);
      four[k] = top | bottom << 16;
    }
    for (int k = 0; k < 4; ++k) grey[k] = __builtin_convertvector((I32x4)(four >> 8 * k & 255), F32x4);
  }
};

}  // namespace

bool PlaneSamples::layout(Arena& arena, int capacity) {
  const std::size_t size = static_cast<std::size_t>((capacity + 3) / 4 * 4);
  for (float** each : {&X, &Y, &grey, &gx, &gy, &px, &py, &ex, &ey, &trust, &mask, &valid, &r, &jx, &jy})
    *each = arena.take<float>(size);
  return arena.ok();
}

PlaneCounts read_samples(const ImageView& image, const PlaneReading& reading, PlaneSamples* samples) {
  const PlaneSamples& s = *samples;
  const float* G = reading.G;
  const float* C = reading.C;
  const float right = static_cast<float>(image.width - 1), bottom = static_cast<float>(image.height - 1);
  const float image_share = reading.image_share, own_share = reading.gain * (1.0f - image_share);
  const F32x4 one = F32x4{} + 1.0f;
  F32x4 count = {}, kept = {};
  for (int at = 0; at < s.padded; at += 4) {
    const F32x4 X = load<F32x4>(s.X + at), Y = load<F32x4>(s.Y + at);
    const F32x4 per_depth = one / (G[6] * X + G[7] * Y + G[8]);
    const F32x4 px = (G[0] * X + G[1] * Y + G[2]) * per_depth, py = (G[3] * X + G[4] * Y + G[5]) * per_depth;
    F32x4 x = px, y = py;
    if (reading.has_lens) {
      x += load<F32x4>(s.ex + at);
      y += load<F32x4>(s.ey + at);
    }
    F32x4 valid = between(x, 0.0f, right) * between(y, 0.0f, bottom) * between(per_depth, 0.0f, kMaxPerDepth);
    // The last pixel is read as the end of the cell before it.
    const F32x4 cx = clamp(x, right), cy = clamp(y, bottom);
    const I32x4 ix = __builtin_convertvector(smaller(cx, F32x4{} + (right - 1.0f)), I32x4);
    const I32x4 iy = __builtin_convertvector(smaller(cy, F32x4{} + (bottom - 1.0f)), I32x4);
    const F32x4 fx = cx - __builtin_convertvector(ix, F32x4), fy = cy - __builtin_convertvector(iy, F32x4);
    const Corners c(image, ix, iy);
    const F32x4 above = c.grey[0] + fx * (c.grey[1] - c.grey[0]), below = c.grey[2] + fx * (c.grey[3] - c.grey[2]);
    const F32x4 value = above + fy * (below - above);
    valid = valid * between(value, kDark, kBright) * load<F32x4>(s.mask + at);
    store(s.valid + at, valid);
    store(s.r + at, value - reading.gain * load<F32x4>(s.grey + at) - reading.bias);
    count += valid;
    kept += valid * (one - 2.0f * fx * (one - fx)) * (one - 2.0f * fy * (one - fy));
    F32x4 jx = own_share * load<F32x4>(s.gx + at), jy = own_share * load<F32x4>(s.gy + at);
    if (image_share > 0.0f) {
      const F32x4 left = c.grey[1] - c.grey[0], lower = c.grey[3] - c.grey[2];
      const F32x4 dx = left + fy * (lower - left), dy = below - above;
      const F32x4 ux = (dx * C[0] + dy * C[2]) * per_depth * image_share;
      const F32x4 uy = (dx * C[1] + dy * C[3]) * per_depth * image_share;
      jx += ux * (G[0] - px * G[6]) + uy * (G[3] - py * G[6]);
      jy += ux * (G[1] - px * G[7]) + uy * (G[4] - py * G[7]);
    }
    store(s.jx + at, jx);
    store(s.jy + at, jy);
  }
  return {sum(count), sum(kept)};
}

void leave_out_masked(const ImageMask& mask, int level, const PlaneReading& reading, PlaneSamples* samples,
                      PlaneCounts* counts) {
  const PlaneSamples& s = *samples;
  const float* G = reading.G;
  const int size = 1 << level;
  float left = 0;
  for (int i = 0; i < s.count; ++i) {
    if (!(s.valid[i] > 0.0f)) continue;
    const float per_depth = 1.0f / (G[6] * s.X[i] + G[7] * s.Y[i] + G[8]);
    float x = (G[0] * s.X[i] + G[1] * s.Y[i] + G[2]) * per_depth;
    float y = (G[3] * s.X[i] + G[4] * s.Y[i] + G[5]) * per_depth;
    if (reading.has_lens) {
      x += s.ex[i];
      y += s.ey[i];
    }
    // A sample is read between four pixels of its level.
    const Rect read{static_cast<int>(x) * size, static_cast<int>(y) * size, 2 * size, 2 * size};
    if (mask.is_clear(read))
      left += s.valid[i];
    else
      s.valid[i] = 0;
  }
  if (counts->valid > 0.0f) counts->kept *= left / counts->valid;
  counts->valid = left;
}

void fit_light(PlaneSamples* samples, PlaneReading* reading) {
  const PlaneSamples& s = *samples;
  const auto image_at = [&](int i) { return s.r[i] + reading->gain * s.grey[i] + reading->bias; };
  float n = 0, t = 0, g = 0, tt = 0, gg = 0;
  for (int i = 0; i < s.count; ++i) {
    const float v = s.valid[i], image = image_at(i);
    n += v;
    t += v * s.grey[i];
    g += v * image;
    tt += v * s.grey[i] * s.grey[i];
    gg += v * image * image;
  }
  const float spread = tt - t * t / n, image_spread = gg - g * g / n;
  if (!(spread > 0.0f) || !(image_spread > 0.0f)) return;
  const float gain = std::sqrt(image_spread / spread), bias = (g - gain * t) / n;
  float before = 0, after = 0;
  for (int i = 0; i < s.count; ++i) {
    before += s.valid[i] * std::fabs(s.r[i]);
    after += s.valid[i] * std::fabs(image_at(i) - gain * s.grey[i] - bias);
  }
  if (!(after < kOtherLight * before)) return;
  for (int i = 0; i < s.count; ++i) s.r[i] = image_at(i) - gain * s.grey[i] - bias;
  reading->gain = gain;
  reading->bias = bias;
}

float robust_sigma(const PlaneSamples& s, float valid) {
  float bin[kBins] = {};
  for (int i = 0; i < s.count; ++i) {
    const float scaled = kBinsPerGrey * std::fabs(s.r[i]) * std::sqrt(s.trust[i]);
    const int at = scaled < static_cast<float>(kBins - 1) ? static_cast<int>(scaled) : kBins - 1;
    bin[at] += s.valid[i];
  }
  // Of the samples within kTrim sigma, which for normal residuals are nearly all, the median gives sigma; outliers are beyond.
  const auto quantile = [&bin](float wanted) {
    float below = 0;
    int at = 0;
    while (at < kBins - 1 && below + bin[at] < wanted) below += bin[at++];
    const float part = bin[at] > 0.0f ? (wanted - below) / bin[at] : 0.5f;
    return (static_cast<float>(at) + part) / kBinsPerGrey;
  };
  const auto share_below = [&bin](float limit) {
    const float scaled = limit * kBinsPerGrey;
    float below = 0;
    int at = 0;
    for (; at < kBins && static_cast<float>(at + 1) <= scaled; ++at) below += bin[at];
    return at < kBins ? below + (scaled - static_cast<float>(at)) * bin[at] : below;
  };
  float sigma = quantile(0.5f * valid) / kMedian;
  for (int round = 0; round < kTrimRounds; ++round) {
    const float within = share_below(kTrim * sigma);
    if (within < kMinFitting * valid) break;
    sigma = quantile(0.5f / kWithinTrim * within) / kMedian;
  }
  return sigma;
}

}  // namespace pf
