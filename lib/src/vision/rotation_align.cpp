#include "vision/rotation_align.h"

#include <cmath>
#include <cstring>

#include "vision/pyramid.h"
#include "vision/rotation_normal.h"
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

/// Binomial 1 4 6 4 1 of five values.
template <typename V>
PF_ALWAYS_INLINE V binomial(const V& a, const V& b, const V& c, const V& d, const V& e) {
  return (a + e + 4.0f * (b + d) + 6.0f * c) * (1.0f / 16.0f);
}

/// Binomial in both directions, the edges repeated. `between` has the same size.
void blur(float* image, float* between, int width, int height) {
  alignas(16) float line[RotationAligner::kMaxWidth + 4];
  for (int y = 0; y < height; ++y) {
    const float* row = image + y * width;
    std::memcpy(line + 2, row, static_cast<std::size_t>(width) * sizeof(float));
    line[0] = line[1] = row[0];
    line[width + 2] = line[width + 3] = row[width - 1];
    float* to = between + y * width;
    for (int x = 0; x < width; ++x) to[x] = binomial(line[x], line[x + 1], line[x + 2], line[x + 3], line[x + 4]);
  }
  const auto row_at = [&](int y) { return between + (y < 0 ? 0 : y < height ? y : height - 1) * width; };
  for (int y = 0; y < height; ++y) {
    const float* a = row_at(y - 2);
    const float* b = row_at(y - 1);
    const float* c = row_at(y);
    const float* d = row_at(y + 1);
    const float* e = row_at(y + 2);
    float* to = image + y * width;
    for (int x = 0; x < width; ++x) to[x] = binomial(a[x], b[x], c[x], d[x], e[x]);
  }
}

}  // namespace

bool RotationAligner::layout(Arena& arena, int width, int height) {
  if (width <= 0 || height <= 0) return false;
  input_width_ = width;
  input_height_ = height;
  halvings_ = 0;
  has_previous_ = false;
  for (; width > kMaxWidth && height >= 2; width /= 2, height /= 2) {
    if (halvings_ < 2)
      half_[halvings_] = arena.take<std::uint8_t>(static_cast<std::size_t>((width / 2) * (height / 2)));
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
  for (int pass = 0; pass < 2; ++pass) blur(current_, jacobian_[0], width_, height_);
}

RotationEstimate RotationAligner::update(const ImageView& coarse, const CoarseCamera& camera, const Vec3& guess) {
  RotationEstimate estimate;
  if (coarse.width != input_width_ || coarse.height != input_height_ || width_ < 8 || height_ < 8 ||
      width_ > kMaxWidth) {
    return estimate;
  }
  float* newest = previous_;
  previous_ = current_;
  current_ = newest;
  camera_ = camera;
  shrink(coarse);
  const bool had_previous = has_previous_;
  has_previous_ = true;
  if (!had_previous) {
    // Rows that gradients() leaves out are read past a row's end with weight zero: they must hold numbers.
    for (float* plane : jacobian_) {
      std::memset(plane, 0, static_cast<std::size_t>(width_ * height_) * sizeof(float));
    }
    return estimate;
  }
  gradients();

  const float all = static_cast<float>((width_ - 2) * ((height_ - 2 + Normal::kRowStep - 1) / Normal::kRowStep));
  float R[9];
  rotation_matrix(0.0f, 0.0f, 0.0f, R);
  Normal normal = evaluate(R);
  estimate.before = normal.rms();
  rotation_matrix(static_cast<float>(guess.x()), static_cast<float>(guess.y()), static_cast<float>(guess.z()), R);
  const float f = 0.5f * (camera_.fx + camera_.fy);
  bool settled = false;
  if (!(guess.squaredNorm() == 0)) normal = evaluate(R);
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
