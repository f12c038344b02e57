#pragma once

#include <cstring>

#include "base/arena.h"
#include "vision/image.h"
#include "vision/image_mask.h"
#include "vision/plane_warps.h"

/// The pixels of a patch that are compared, and the sums over them that an alignment needs. Numbers by fours; those that fill up have no
/// weight.

namespace pf {

struct PlaneSamples {
  int count = 0;                       ///< that there are
  int padded = 0;                      ///< a multiple of 4
  float *X = nullptr, *Y = nullptr;    ///< ray, about the patch's middle in half sides
  float* grey = nullptr;               ///< of the template, about its mean
  float *gx = nullptr, *gy = nullptr;  ///< gradient of the template by (X, Y)
  float *px = nullptr, *py = nullptr;  ///< place in the patch, from the centre of its first pixel [px of level 0]
  float *ex = nullptr,
        *ey = nullptr;     ///< what the lens adds to the pixel of a pinhole [px of the level]; with a lens only
  float* trust = nullptr;  ///< variance of noise over that of the residual, in which the warp is wrong as well: 0 .. 1
  float* mask = nullptr;   ///< weight of its own, 0 .. 1; 0 for what fills up
  float* valid = nullptr;  ///< mask where its place is in the image and not saturated, else 0
  float* r = nullptr;      ///< image less gain times template less bias
  float *jx = nullptr, *jy = nullptr;  ///< gradient by (X, Y) that the step is made with

  bool layout(Arena& arena, int capacity);
};

/// Where to read: pixel of the level = G (X, Y, 1), dehomogenised, plus (ex, ey).
struct PlaneReading {
  float G[9] = {};
  bool has_lens = false;
  float C[4] = {1, 0, 0, 1};  ///< what the lens does to a step in the image, row by row
  float gain = 1, bias = 0;
  float image_share =
      0;  ///< of the image's gradient in the step's, the template's has what is missing: 1/2 for second order, or 0
};

struct PlaneCounts {
  float valid = 0;  ///< sum of valid
  float kept = 0;   ///< of the variance of the image's noise, summed over them, what interpolation leaves
};

/// Reads the image at all samples: r, valid, jx and jy.
PlaneCounts read_samples(const ImageView& image, const PlaneReading& reading, PlaneSamples* samples);

/// Leaves out the samples that were read where a mask of level 0 has something: they are not valid.
void leave_out_masked(const ImageMask& mask, int level, const PlaneReading& reading, PlaneSamples* samples,
                      PlaneCounts* counts);

/// Takes gain and bias from mean and standard deviation of all valid samples where that makes the residuals much smaller; they are changed
/// with it. Otherwise a fit that begins with another frame's light converges on the few grey levels that both share.
void fit_light(PlaneSamples* samples, PlaneReading* reading);

/// Standard deviation of the residuals of the samples that fit, from the median of |r| among those within 2.5 of it.
float robust_sigma(const PlaneSamples& samples, float valid);

/// Over v = (J, grey, 1), with weights w = q k, k = (1 - u)^2, u = q (r/c)^2, within c and 0 beyond; q: trust. The normal matrix has the
/// slope of w r for its weight, h = q max((1 - u)(1 - 5 u), k / 4): with w itself the steps are too short where much is hidden.
template <int kColumns>
struct PlaneSums {
  float A[kColumns * (kColumns + 1) / 2];  ///< upper triangle of sum h v v^T, row by row
  float b[kColumns];                       ///< sum w v r
  float weight, slope;                     ///< sum k, sum h / q
  float squares, psi2;                     ///< sum w r^2, sum (w r)^2 / q
  float grey, grey2;                       ///< sum w grey, sum w grey^2
};

namespace plane_sums {

template <int kColumns>
PF_ALWAYS_INLINE void add(const F32x4* v, const F32x4& h, const F32x4& psi, F32x4* A, F32x4* b) {
  int at = 0;
  for (int i = 0; i < kColumns; ++i) {
    const F32x4 hv = h * v[i];
    b[i] += psi * v[i];
    for (int j = i; j < kColumns; ++j) A[at++] += hv * v[j];
  }
}

}  // namespace plane_sums

/// c: where the weight ends [grey].
template <typename Warp>
void sum_samples(const PlaneSamples& s, const Warp& warp, float c, bool is_near, PlaneSums<Warp::kSize + 2>* out) {
  constexpr int kColumns = Warp::kSize + 2, kEntries = kColumns * (kColumns + 1) / 2;
  F32x4 A[kEntries] = {}, b[kColumns] = {};
  F32x4 weight = {}, slope = {}, squares = {}, psi2 = {}, grey = {}, grey2 = {};
  const F32x4 one = F32x4{} + 1.0f, zero = {};
  const float per_c2 = 1.0f / (c * c);
  for (int at = 0; at < s.padded; at += 4) {
    const F32x4 q = load<F32x4>(s.trust + at);
    const F32x4 r = load<F32x4>(s.r + at), u = r * r * q * per_c2;
    const F32x4 in = larger(one - u, zero), valid = load<F32x4>(s.valid + at);
    const F32x4 w0 = in * in * valid, w = w0 * q, psi = w * r;
    const F32x4 h0 = is_near ? larger(in * (one - 5.0f * u) * valid, 0.25f * w0) : w0, h = h0 * q;
    F32x4 v[kColumns];
    warp.rows(load<F32x4>(s.X + at), load<F32x4>(s.Y + at), load<F32x4>(s.jx + at), load<F32x4>(s.jy + at), v);
    const F32x4 t = load<F32x4>(s.grey + at);
    v[kColumns - 2] = t;
    v[kColumns - 1] = one;
    plane_sums::add<kColumns>(v, h, psi, A, b);
    weight += w0;
    slope += h0;
    squares += psi * r;
    psi2 += w0 * psi * r;
    grey += w * t;
    grey2 += w * t * t;
  }
  for (int k = 0; k < kEntries; ++k) out->A[k] = sum(A[k]);
  for (int k = 0; k < kColumns; ++k) out->b[k] = sum(b[k]);
  out->weight = sum(weight);
  out->slope = sum(slope);
  out->squares = sum(squares);
  out->psi2 = sum(psi2);
  out->grey = sum(grey);
  out->grey2 = sum(grey2);
}

}  // namespace pf
