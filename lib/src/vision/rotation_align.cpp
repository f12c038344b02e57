#include "vision/rotation_align.h"

#include <cmath>

#include "vision/pyramid.h"
#include "vision/simd.h"

namespace pf {

namespace {

constexpr int kUnknowns = 5;            // bias, gain, and gain times rotation
constexpr float kLeastGradient = 0.2f;  // grey/px, root mean square, that the two do not explain
constexpr float kSmallStep = 0.02f;     // px
constexpr float kRounding = 0.01f;      // grey

/// Exp of a rotation vector, row by row (Rodrigues).
void rotation_matrix(float x, float y, float z, float (&R)[9]) {
  const float a2 = x * x + y * y + z * z;
  float s;  // sin(a) / a
  float c;  // (1 - cos(a)) / a²
  if (a2 < 1e-4f) {
    s = 1.0f - a2 / 6.0f;
    c = 0.5f - a2 / 24.0f;
  } else {
    const float a = std::sqrt(a2);
    s = std::sin(a) / a;
    c = (1.0f - std::cos(a)) / a2;
  }
  const float out[9] = {1.0f - c * (y * y + z * z), c * x * y - s * z,          c * x * z + s * y,
                        c * x * y + s * z,          1.0f - c * (x * x + z * z), c * y * z - s * x,
                        c * x * z - s * y,          c * y * z + s * x,          1.0f - c * (x * x + y * y)};
  std::memcpy(R, out, sizeof out);
}

void multiply(const float (&A)[9], const float (&B)[9], float (&out)[9]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
    }
  }
}

/// Log for angles below a quarter turn.
Vec3 rotation_vector(const float (&R)[9]) {
  const Scalar x = static_cast<Scalar>(R[7] - R[5]) / 2;
  const Scalar y = static_cast<Scalar>(R[2] - R[6]) / 2;
  const Scalar z = static_cast<Scalar>(R[3] - R[1]) / 2;
  const Scalar sine = std::sqrt(x * x + y * y + z * z);
  const Scalar scale = sine < Scalar(1e-3) ? 1 + sine * sine / 6 : std::asin(std::fmin(sine, Scalar(1))) / sine;
  return Vec3(x * scale, y * scale, z * scale);
}

/// A x = b by Cholesky of the lower triangle, in place. False when a pivot is below its floor.
bool solve(float (&A)[kUnknowns][kUnknowns], const float (&floor)[kUnknowns], float (&b)[kUnknowns]) {
  for (int j = 0; j < kUnknowns; ++j) {
    for (int i = j; i < kUnknowns; ++i) {
      float s = A[i][j];
      for (int k = 0; k < j; ++k) s -= A[i][k] * A[j][k];
      if (i == j) {
        if (!(s > floor[j])) return false;
        A[j][j] = std::sqrt(s);
      } else {
        A[i][j] = s / A[j][j];
      }
    }
  }
  for (int i = 0; i < kUnknowns; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= A[i][k] * b[k];
    b[i] /= A[i][i];
  }
  for (int i = kUnknowns - 1; i >= 0; --i) {
    for (int k = i + 1; k < kUnknowns; ++k) b[i] -= A[k][i] * b[k];
    b[i] /= A[i][i];
  }
  return true;
}

/// Binomial 1 4 6 4 1 along `count` entries that are `step` apart, in place; the ends are repeated.
void blur_line(float* line, int count, std::ptrdiff_t step) {
  float a = line[0];
  float b = a;
  float c = a;
  float d = line[count > 1 ? step : 0];
  for (int i = 0; i < count; ++i) {
    const float e = line[(i + 2 < count ? i + 2 : count - 1) * step];
    line[i * step] = (a + e + 4.0f * (b + d) + 6.0f * c) * (1.0f / 16.0f);
    a = b;
    b = c;
    c = d;
    d = e;
  }
}

}  // namespace

/// Sums over the pixels that both images see, of the products of 1, T, J_x, J_y, J_z and I.
struct RotationAligner::Normal {
  static constexpr int kTerms = 6;
  float at[kTerms][kTerms];  // upper triangle

  /// Of image and template with gain and bias taken out.
  float scatter_image() const { return at[5][5] - at[0][5] * at[0][5] / at[0][0]; }
  float scatter_template() const { return at[1][1] - at[0][1] * at[0][1] / at[0][0]; }
  float scatter_both() const { return at[1][5] - at[0][1] * at[0][5] / at[0][0]; }
  float rms() const {
    const float left = scatter_image() - scatter_both() * scatter_both() / scatter_template();
    return left > 0.0f ? std::sqrt(left / at[0][0]) : 0.0f;
  }
};

bool RotationAligner::layout(Arena& arena, int width, int height) {
  if (width <= 0 || height <= 0) return false;
  input_width_ = width;
  input_height_ = height;
  halvings_ = 0;
  has_previous_ = false;
  for (; width > kMaxWidth && height >= 2; width /= 2, height /= 2) {
    if (halvings_ < 2) half_[halvings_] = arena.take<std::uint8_t>(static_cast<std::size_t>((width / 2) * (height / 2)));
    ++halvings_;
  }
  width_ = width;
  height_ = height;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  previous_ = arena.take<float>(pixels);
  current_ = arena.take<float>(pixels);
  for (float*& plane : jacobian_) plane = arena.take<float>(pixels);
  return true;
}

void RotationAligner::shrink(const ImageView& coarse) {
  ImageView image = coarse;
  for (int k = 0; k < halvings_; ++k) {
    std::uint8_t* to = half_[k % 2];
    halve(image, to, image.width / 2);
    image = ImageView{to, image.width / 2, image.height / 2, image.width / 2};
    camera_.fx *= 0.5f;
    camera_.fy *= 0.5f;
    camera_.cx = camera_.cx * 0.5f - 0.25f;
    camera_.cy = camera_.cy * 0.5f - 0.25f;
  }
  float mean = 0.0f;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      current_[y * width_ + x] = static_cast<float>(image.at(x, y));
      mean += current_[y * width_ + x];
    }
  }
  mean /= static_cast<float>(width_ * height_);
  for (int k = 0; k < width_ * height_; ++k) current_[k] -= mean;
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < height_; ++y) blur_line(current_ + y * width_, width_, 1);
    for (int x = 0; x < width_; ++x) blur_line(current_ + x, height_, width_);
  }
}

// A small rotation w moves the ray (x, y, 1) by w × ray, and its pixel by
//   du = fx (-x y w_x + (1 + x²) w_y - y w_z),   dv = fy (-(1 + y²) w_x + x y w_y + x w_z).
void RotationAligner::gradients() {
  for (int v = 0; v < height_; ++v) {
    const float y = (static_cast<float>(v) - camera_.cy) / camera_.fy;
    const bool edge_row = v == 0 || v == height_ - 1;
    for (int u = 0; u < width_; ++u) {
      const int at = v * width_ + u;
      const bool edge = edge_row || u == 0 || u == width_ - 1;
      const float x = (static_cast<float>(u) - camera_.cx) / camera_.fx;
      const float gu = edge ? 0.0f : 0.5f * (previous_[at + 1] - previous_[at - 1]) * camera_.fx;
      const float gv = edge ? 0.0f : 0.5f * (previous_[at + width_] - previous_[at - width_]) * camera_.fy;
      jacobian_[0][at] = -gu * x * y - gv * (1.0f + y * y);
      jacobian_[1][at] = gu * (1.0f + x * x) + gv * x * y;
      jacobian_[2][at] = gv * x - gu * y;
    }
  }
}

RotationAligner::Normal RotationAligner::evaluate(const float (&R)[9]) const {
  constexpr int kTerms = Normal::kTerms;
  F32x4 sums[kTerms][kTerms] = {};
  alignas(16) float seen[kMaxWidth + 4];
  alignas(16) float value[kMaxWidth + 4];
  const float limit_x = static_cast<float>(width_ - 1);
  const float limit_y = static_cast<float>(height_ - 1);
  for (int v = 1; v < height_ - 1; ++v) {
    // K R K⁻¹ along the row: three linear functions of u.
    const float y = (static_cast<float>(v) - camera_.cy) / camera_.fy;
    const float x0 = (1.0f - camera_.cx) / camera_.fx;
    const float px = R[0] * x0 + R[1] * y + R[2];
    const float py = R[3] * x0 + R[4] * y + R[5];
    const float pz = R[6] * x0 + R[7] * y + R[8];
    const int count = width_ - 2;
    for (int i = 0; i < count; ++i) {
      const float dx = static_cast<float>(i) / camera_.fx;
      const float z = pz + R[6] * dx;
      const float inverse = 1.0f / (z > 0.01f ? z : 0.01f);
      const float a = camera_.fx * (px + R[0] * dx) * inverse + camera_.cx;
      const float b = camera_.fy * (py + R[3] * dx) * inverse + camera_.cy;
      const bool inside = z > 0.01f && a >= 0.0f && b >= 0.0f && a < limit_x && b < limit_y;
      const int ia = inside ? static_cast<int>(a) : 0;
      const int ib = inside ? static_cast<int>(b) : 0;
      const float fa = a - static_cast<float>(ia);
      const float fb = b - static_cast<float>(ib);
      const float* p = current_ + ib * width_ + ia;
      const float top = p[0] + fa * (p[1] - p[0]);
      const float bottom = p[width_] + fa * (p[width_ + 1] - p[width_]);
      seen[i] = inside ? 1.0f : 0.0f;
      value[i] = inside ? top + fb * (bottom - top) : 0.0f;
    }
    for (int i = count; i < count + 3; ++i) seen[i] = value[i] = 0.0f;
    const int at = v * width_ + 1;
    for (int i = 0; i < count; i += 4) {
      // The last load of a row reaches into the next one, where its weight is zero.
      const F32x4 w = load<F32x4>(seen + i);
      const F32x4 terms[kTerms] = {w,
                                   w * load<F32x4>(previous_ + at + i),
                                   w * load<F32x4>(jacobian_[0] + at + i),
                                   w * load<F32x4>(jacobian_[1] + at + i),
                                   w * load<F32x4>(jacobian_[2] + at + i),
                                   load<F32x4>(value + i)};
      for (int a = 0; a < kTerms; ++a) {
        for (int b = a; b < kTerms; ++b) sums[a][b] += terms[a] * terms[b];
      }
    }
  }
  Normal out;
  for (int a = 0; a < kTerms; ++a) {
    for (int b = a; b < kTerms; ++b) out.at[a][b] = sum(sums[a][b]);
  }
  return out;
}

RotationEstimate RotationAligner::update(const ImageView& coarse, const CoarseCamera& camera, const Vec3& guess) {
  RotationEstimate estimate;
  if (coarse.width != input_width_ || coarse.height != input_height_ || width_ < 8 || height_ < 8 || width_ > kMaxWidth) {
    return estimate;
  }
  float* newest = previous_;
  previous_ = current_;
  current_ = newest;
  camera_ = camera;
  shrink(coarse);
  const bool had_previous = has_previous_;
  has_previous_ = true;
  if (!had_previous) return estimate;
  gradients();

  const float all = static_cast<float>((width_ - 2) * (height_ - 2));
  float R[9];
  rotation_matrix(0.0f, 0.0f, 0.0f, R);
  const Normal still = evaluate(R);
  estimate.before = still.rms();
  rotation_matrix(static_cast<float>(guess.x()), static_cast<float>(guess.y()), static_cast<float>(guess.z()), R);
  const float f = 0.5f * (camera_.fx + camera_.fy);
  bool settled = false;
  Normal normal = evaluate(R);
  for (int k = 1; k <= kMaxIterations && !settled; ++k) {
    const float pixels = normal.at[0][0];
    if (!(pixels >= kLeastOverlap * all)) return estimate;
    // Bias and gain first: the rotation's pivots are then what these two do not explain.
    float A[kUnknowns][kUnknowns];
    float b[kUnknowns];
    for (int i = 0; i < kUnknowns; ++i) {
      for (int j = 0; j <= i; ++j) A[i][j] = normal.at[j][i];
      b[i] = normal.at[i][5];
    }
    const float least = pixels * kLeastGradient * kLeastGradient;
    const float floor[kUnknowns] = {0.0f, least, least * f * f * 0.1f, least * f * f * 0.1f, least * f * f * 0.01f};
    if (!solve(A, floor, b) || !(b[1] > 0.05f)) return estimate;
    float step[9];
    float next[9];
    const float wx = b[2] / b[1];
    const float wy = b[3] / b[1];
    const float wz = b[4] / b[1];
    const float length = std::sqrt(wx * wx + wy * wy + wz * wz);
    if (!(length < 1.0f)) return estimate;
    rotation_matrix(-wx, -wy, -wz, step);
    multiply(R, step, next);
    std::memcpy(R, next, sizeof R);
    normal = evaluate(R);
    estimate.iterations = k;
    settled = length * f < kSmallStep;
  }
  estimate.overlap = normal.at[0][0] / all;
  if (!(estimate.overlap >= kLeastOverlap)) return estimate;
  estimate.after = normal.rms();
  estimate.rotation = rotation_vector(R);
  const float scatter = normal.scatter_image() * normal.scatter_template();
  estimate.zncc = scatter > 0.0f ? normal.scatter_both() / std::sqrt(scatter) : 0.0f;
  estimate.valid = estimate.zncc >= kLeastZncc && estimate.after <= estimate.before + kRounding;
  return estimate;
}

}  // namespace pf
