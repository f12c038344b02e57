#include "track/patch_search.h"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric_eigen.h"
#include "track/tuning.h"

namespace pf {
namespace {

using namespace tuning::patch_search;

constexpr int kPatchLevel = 2;  ///< of its pixels that are correlated, or the coarsest that it has
constexpr int kMaxSide = PlanePatch::kMaxSide >> (PlanePatch::kLevels - 1);
constexpr int kMaxSamples = kMaxSide * kMaxSide;

}  // namespace

bool PatchSearch::layout(Arena& arena) {
  sample_ = arena.take<Sample>(kMaxSamples);
  return arena.ok();
}

/// Lists the patch's coarse pixels with their places in a level of the image. False where it cannot be projected, or has no contrast.
bool PatchSearch::load(const ImageView& image, int level, const Camera& camera, const PlanePatch& patch,
                       const Mat3& H_CK) {
  const int from = std::min(kPatchLevel, patch.levels - 1), side = patch.side_of(from);
  const int step = std::max(1, 1 << std::max(0, level - from));  // a coarser level needs fewer
  const std::uint8_t* pixels = patch.level(from);
  const auto place = [&](Scalar x, Scalar y, Vec2* at) {
    Vec3 ray;
    const Vec2 pixel(patch.left + from_level(x, from), patch.top + from_level(y, from));
    if (!unproject(camera, pixel, &ray) || !(ray.z() > Scalar(0))) return false;
    const Vec3 seen = H_CK * (ray / ray.z());
    if (!(seen.z() > Scalar(0)) || !project(camera, seen, at)) return false;
    *at = to_level(*at, level);
    return at->cwiseAbs().maxCoeff() < static_cast<Scalar>(kMaxReach);
  };
  const Scalar half = static_cast<Scalar>(side - 1) / 2;
  if (!place(half, half, &middle_)) return false;
  const int cx = static_cast<int>(std::lround(middle_.x())), cy = static_cast<int>(std::lround(middle_.y()));
  left_ = right_ = top_ = bottom_ = 0;
  count_ = 0;
  int sum = 0;
  for (int y = 0; y + step <= side; y += step)
    for (int x = 0; x + step <= side && count_ < kMaxSamples; x += step) {
      const Scalar middle = static_cast<Scalar>(step - 1) / 2;
      Vec2 at;
      if (!place(static_cast<Scalar>(x) + middle, static_cast<Scalar>(y) + middle, &at)) return false;
      int grey = 0;
      for (int b = 0; b < step; ++b)
        for (int a = 0; a < step; ++a) grey += pixels[(y + b) * side + x + a];
      grey /= step * step;
      const int dx = static_cast<int>(std::lround(at.x())) - cx, dy = static_cast<int>(std::lround(at.y())) - cy;
      if (std::abs(dx) >= image.width || std::abs(dy) >= image.height) return false;
      sample_[count_++] = {static_cast<std::int16_t>(dx), static_cast<std::int16_t>(dy),
                           static_cast<std::int16_t>(grey)};
      left_ = std::min(left_, dx);
      right_ = std::max(right_, dx);
      top_ = std::min(top_, dy);
      bottom_ = std::max(bottom_, dy);
      sum += grey;
    }
  squares_ = 0;
  for (int i = 0; i < count_; ++i) {
    sample_[i].grey = static_cast<std::int16_t>(sample_[i].grey - sum / count_);
    squares_ += static_cast<float>(sample_[i].grey * sample_[i].grey);
  }
  return squares_ > kMinContrast * kMinContrast * static_cast<float>(count_);
}

/// Zero-mean normalised, with the patch's middle at (x, y).
float PatchSearch::correlation(const ImageView& image, int x, int y) const {
  const std::uint8_t* centre = image.pixel(x, y);
  int sum = 0, own = 0, squares = 0, both = 0;
  for (int i = 0; i < count_; ++i) {
    const Sample& s = sample_[i];
    const int grey = centre[s.dy * image.stride + s.dx];
    sum += grey;
    squares += grey * grey;
    both += grey * s.grey;
    own += s.grey;
  }
  const float n = static_cast<float>(count_);
  const float variance = static_cast<float>(squares) - static_cast<float>(sum) * static_cast<float>(sum) / n;
  const float covariance = static_cast<float>(both) - static_cast<float>(own) * static_cast<float>(sum) / n;
  return variance > 0.0f ? covariance / std::sqrt(variance * squares_) : 0.0f;
}

/// The best place inside of an ellipse, {d : d^T ellipse^-1 d < 1}, about *x *y, and its correlation. A second place that is nearly as good
/// means repeated texture: 0 then.
float PatchSearch::best_near(const ImageView& image, const Mat2& ellipse, int* x, int* y) const {
  const Scalar det = ellipse.determinant();
  if (!(det > Scalar(0))) return 0.0f;
  const int first_x = -left_, last_x = image.width - 1 - right_, first_y = -top_, last_y = image.height - 1 - bottom_;
  const int rx = static_cast<int>(std::sqrt(ellipse(0, 0))) + 1, ry = static_cast<int>(std::sqrt(ellipse(1, 1))) + 1;
  const int x0 = std::max(first_x, *x - rx), x1 = std::min(last_x, *x + rx);
  const int y0 = std::max(first_y, *y - ry), y1 = std::min(last_y, *y + ry);
  float best = 0.0f, second = 0.0f;
  int best_x = *x, best_y = *y;
  for (int v = y0; v <= y1; ++v)
    for (int u = x0; u <= x1; ++u) {
      const Scalar dx = static_cast<Scalar>(u - *x), dy = static_cast<Scalar>(v - *y);
      if (ellipse(1, 1) * dx * dx - 2 * ellipse(0, 1) * dx * dy + ellipse(0, 0) * dy * dy > det) continue;
      const float score = correlation(image, u, v);
      const bool beside = std::abs(u - best_x) > kPeakWidth || std::abs(v - best_y) > kPeakWidth;
      if (score > best) {
        if (beside) second = best;
        best = score;
        best_x = u;
        best_y = v;
      } else if (beside && score > second) {
        second = score;
      }
    }
  *x = best_x;
  *y = best_y;
  return best - second >= kMinLead ? best : 0.0f;
}

bool PatchSearch::find(const Pyramid& image, const Camera& camera, const PlanePatch& patch, const Mat3& H_CK,
                       const Mat2& innovation, Scalar gate, Vec2* shift) {
  const int fine = std::min(kPatchLevel, image.levels - 1);
  const Scalar reach = std::sqrt(gate * symmetric_eigenvalues(innovation)(1)) / static_cast<Scalar>(1 << fine);
  const int coarse = reach > static_cast<Scalar>(kMaxFineReach) ? std::min(fine + 1, image.levels - 1) : fine;
  Vec2 offset = Vec2::Zero();  // [px]
  for (int level = coarse; level >= fine; --level) {
    if (!load(image.level[level], level, camera, patch, H_CK)) return false;
    const Scalar scale = static_cast<Scalar>(1 << level);
    const Vec2 about = middle_ + offset / scale;
    const int cx = static_cast<int>(std::lround(about.x())), cy = static_cast<int>(std::lround(about.y()));
    int x = cx, y = cy;
    // Behind the first level, what the coarser pixels leave open.
    const Scalar rest = static_cast<Scalar>(kPeakWidth * kPeakWidth);
    const Mat2 ellipse =
        level == coarse ? Mat2(gate * innovation / (scale * scale) + Mat2::Identity()) : Mat2(Mat2::Identity() * rest);
    const float score = best_near(image.level[level], ellipse, &x, &y);
    if (score < kMinScore) return false;
    const Vec2 expected(std::lround(middle_.x()), std::lround(middle_.y()));
    offset = (Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y)) - expected) * scale;
  }
  *shift = offset;
  return true;
}

}  // namespace pf
