#include "vision/rotation_normal.h"

#include "vision/simd.h"

namespace pf {

namespace {

/// Four bilinear readings; the pixels right and below are readable too.
PF_ALWAYS_INLINE F32x4 sample(const float* image, int width, const F32x4& x, const F32x4& y) {
  const I32x4 ix = __builtin_convertvector(x, I32x4);
  const I32x4 iy = __builtin_convertvector(y, I32x4);
  const I32x4 at = iy * width + ix;
  F32x4 pair[4];  // left and right of two pixels, above and below
  for (int k = 0; k < 4; ++k) {
    const float* p = image + at[k % 2 * 2] + k / 2 * width;
    const float* q = image + at[k % 2 * 2 + 1] + k / 2 * width;
    pair[k] = (F32x4)U64x2{load<std::uint64_t>(p), load<std::uint64_t>(q)};
  }
  const F32x4 fx = x - __builtin_convertvector(ix, F32x4);
  const F32x4 fy = y - __builtin_convertvector(iy, F32x4);
  const F32x4 left_top = even_lanes(pair[0], pair[1]);
  const F32x4 left_bottom = even_lanes(pair[2], pair[3]);
  const F32x4 top = left_top + fx * (odd_lanes(pair[0], pair[1]) - left_top);
  const F32x4 bottom = left_bottom + fx * (odd_lanes(pair[2], pair[3]) - left_bottom);
  return top + fy * (bottom - top);
}

}  // namespace

// A small rotation w moves the ray (x, y, 1) by w × ray, and its pixel by
//   du = fx (-x y w_x + (1 + x²) w_y - y w_z),   dv = fy (-(1 + y²) w_x + x y w_y + x w_z).
void RotationAligner::gradients() {
  const float scale = 1.0f / camera_.fx;
  for (int v = 1; v < height_ - 1; v += Normal::kRowStep) {
    const float y = (static_cast<float>(v) - camera_.cy) / camera_.fy;
    const float* T = previous_ + v * width_;
    float* jx = jacobian_[0] + v * width_;
    float* jy = jacobian_[1] + v * width_;
    float* jz = jacobian_[2] + v * width_;
    for (int u = 1; u < width_ - 1; ++u) {
      const float x = (static_cast<float>(u) - camera_.cx) * scale;
      const float gu = 0.5f * (T[u + 1] - T[u - 1]) * camera_.fx;
      const float gv = 0.5f * (T[u + width_] - T[u - width_]) * camera_.fy;
      jx[u] = -gu * x * y - gv * (1.0f + y * y);
      jy[u] = gu * (1.0f + x * x) + gv * x * y;
      jz[u] = gv * x - gu * y;
    }
    for (float* row : {jx, jy, jz}) row[0] = row[width_ - 1] = 0.0f;
  }
}

// One row of the previous image at a time: first where its pixels are seen now and what is there, then the sums. The
// last four of a row may reach into the next one, where their weight is zero.
RotationAligner::Normal RotationAligner::evaluate(const float (&R)[9]) const {
  constexpr int kTerms = Normal::kTerms;
  F32x4 sums[kTerms][kTerms] = {};
  const F32x4 zero = {};
  const F32x4 one = zero + 1.0f;
  const F32x4 lanes = {0.0f, 1.0f, 2.0f, 3.0f};
  const F32x4 limit_x = zero + static_cast<float>(width_ - 1);
  const F32x4 limit_y = zero + static_cast<float>(height_ - 1);
  const float step = 1.0f / camera_.fx;
  const int count = width_ - 2;
  for (int v = 1; v < height_ - 1; v += Normal::kRowStep) {
    alignas(16) float seen[kMaxWidth];
    alignas(16) float value[kMaxWidth];
    const float y = (static_cast<float>(v) - camera_.cy) / camera_.fy;
    const float x0 = (1.0f - camera_.cx) * step;
    const F32x4 row_x = zero + (R[0] * x0 + R[1] * y + R[2]);
    const F32x4 row_y = zero + (R[3] * x0 + R[4] * y + R[5]);
    const F32x4 row_z = zero + (R[6] * x0 + R[7] * y + R[8]);
    for (int i = 0; i < count; i += 4) {
      const F32x4 along = lanes + static_cast<float>(i);
      const F32x4 dx = along * step;
      const F32x4 z = row_z + R[6] * dx;
      const F32x4 inverse = one / larger(z, zero + 0.01f);
      const F32x4 a = (row_x + R[0] * dx) * inverse * camera_.fx + camera_.cx;
      const F32x4 b = (row_y + R[3] * dx) * inverse * camera_.fy + camera_.cy;
      const I32x4 inside =
          (z > 0.01f) & (a >= zero) & (b >= zero) & (a < limit_x) & (b < limit_y) & (along < static_cast<float>(count));
      const auto where_inside = [&inside](const F32x4& what) { return (F32x4)((I32x4)what & inside); };
      store(seen + i, where_inside(one));
      store(value + i, where_inside(sample(current_, width_, where_inside(a), where_inside(b))));
    }
    const int at = v * width_ + 1;
    // Sums of the row first, in registers: ww wT wI TT TI II, then for each J its products with w, T and I, then JJ.
    F32x4 a0 = zero, a1 = zero, a2 = zero, a3 = zero, a4 = zero, a5 = zero;
    for (int i = 0; i < count; i += 4) {
      const F32x4 w = load<F32x4>(seen + i);
      const F32x4 I = load<F32x4>(value + i);
      const F32x4 T = w * load<F32x4>(previous_ + at + i);
      a0 += w;
      a1 += T;
      a2 += I;
      a3 += T * T;
      a4 += T * I;
      a5 += I * I;
    }
    sums[0][0] += a0;
    sums[0][1] += a1;
    sums[0][5] += a2;
    sums[1][1] += a3;
    sums[1][5] += a4;
    sums[5][5] += a5;
    for (int k = 0; k < 3; ++k) {
      a0 = a1 = a2 = zero;
      for (int i = 0; i < count; i += 4) {
        const F32x4 J = load<F32x4>(seen + i) * load<F32x4>(jacobian_[k] + at + i);
        a0 += J;
        a1 += J * load<F32x4>(previous_ + at + i);
        a2 += J * load<F32x4>(value + i);
      }
      sums[0][2 + k] += a0;
      sums[1][2 + k] += a1;
      sums[2 + k][5] += a2;
    }
    a0 = a1 = a2 = a3 = a4 = a5 = zero;
    for (int i = 0; i < count; i += 4) {
      const F32x4 w = load<F32x4>(seen + i);
      const F32x4 jx = w * load<F32x4>(jacobian_[0] + at + i);
      const F32x4 jy = w * load<F32x4>(jacobian_[1] + at + i);
      const F32x4 jz = w * load<F32x4>(jacobian_[2] + at + i);
      a0 += jx * jx;
      a1 += jx * jy;
      a2 += jx * jz;
      a3 += jy * jy;
      a4 += jy * jz;
      a5 += jz * jz;
    }
    sums[2][2] += a0;
    sums[2][3] += a1;
    sums[2][4] += a2;
    sums[3][3] += a3;
    sums[3][4] += a4;
    sums[4][4] += a5;
  }
  Normal out;
  for (int a = 0; a < kTerms; ++a) {
    for (int b = a; b < kTerms; ++b) out.at[a][b] = sum(sums[a][b]);
  }
  return out;
}

}  // namespace pf
