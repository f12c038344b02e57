#include "track/template_matcher.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "track/tuning.h"

namespace pf {
namespace {

using namespace tuning::template_match;

constexpr int kPatchSide = SourcePatch::kSize;
constexpr int kWindow = 2 * kReach + 1;
constexpr int kRegionRow = (PlanarTemplate::kMaxSide + 3) / 4 * 4 + kWindow - 1;
constexpr float kPerByte = 1.0f / 255.0f;
constexpr std::uint8_t kOffPlane = 5;  ///< probability up to which a pixel counts for nothing in a judgement, 1/255
constexpr float kNoiseKept =
    0.8f;  ///< of a pixel's variance, what interpolation and blur leave in residuals, both images together

Scalar radius_of(const SearchTask& task) {
  const Mat2& S = task.innovation;
  const Scalar mean = (S(0, 0) + S(1, 1)) / 2, half = (S(0, 0) - S(1, 1)) / 2;
  return std::sqrt(task.gate * (mean + std::sqrt(half * half + S(0, 1) * S(0, 1))));
}

/// First pixel of a template in its remembered pixels.
int first_pixel(float centre, int side) { return static_cast<int>(centre + 0.5f) - side / 2; }

/// Bilinear in bytes of a square; the place is inside.
float sample(const std::uint8_t* from, int stride, int last, float x, float y) {
  const int ix = std::min(static_cast<int>(x), last - 1), iy = std::min(static_cast<int>(y), last - 1);
  const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
  const std::uint8_t* at = from + iy * stride + ix;
  const float above = static_cast<float>(at[0]) + fx * static_cast<float>(at[1] - at[0]);
  const float below = static_cast<float>(at[stride]) + fx * static_cast<float>(at[stride + 1] - at[stride]);
  return above + fy * (below - above);
}

/// Mean square of the residuals, each by its mask [squared grey levels of the image].
float mean_square(const PlaneSamples& s) {
  float weight = 0, squares = 0;
  for (int i = 0; i < s.count; ++i) {
    weight += s.valid[i];
    squares += s.valid[i] * s.r[i] * s.r[i];
  }
  return weight > 0.0f ? squares / weight : 0.0f;
}

}  // namespace

bool TemplateMatcher::layout(Arena& arena, int side) {
  side_ = side;
  if (side == 0) return arena.ok();
  aligner_ = arena.place<PlaneAligner>([&](PlaneAligner& made) { made.layout(arena, side * side); });
  PlanePatch* patch = arena.take<PlanePatch>(1);
  if (patch != nullptr) patch_ = new (patch) PlanePatch();
  learnt_ = arena.take<std::uint8_t>(static_cast<std::size_t>(side * side));
  probability_ = arena.take<std::uint8_t>(static_cast<std::size_t>(side * side));
  region_ = arena.take<float>(static_cast<std::size_t>(kRegionRow * (side + kWindow - 1)));
  const std::size_t pattern = static_cast<std::size_t>(side * ((side + 3) / 4 * 4));
  grey_ = arena.take<float>(pattern);
  weight_ = arena.take<float>(pattern);
  return arena.ok();
}

void TemplateMatcher::init(const Camera& camera, MaskMode mode, float max_misfit) {
  camera_ = camera;
  mode_ = mode;
  max_misfit_ = max_misfit;
  if (patch_ == nullptr) return;
  std::memset(patch_->pixels, 0, sizeof patch_->pixels);
  std::memset(patch_->chosen, 255, sizeof patch_->chosen);
}

void TemplateMatcher::begin(const ImageView& image, const SourcePatch& patch, const Vec2& pixel, PlanarTemplate* shape,
                            std::uint8_t* mask) {
  if (noise_ < 0) noise_ = image_noise(image);
  begin_template(patch, pixel, side_, mode_ == MaskMode::kWhole, noise_, shape, mask);
  shape->covariance[0] = shape->covariance[2] = kFirstSlopeSigma * kFirstSlopeSigma;
}

/// One pixel more on each side, for gradients; at the end of what is remembered it is repeated.
void TemplateMatcher::fill_patch(const SourcePatch& from, const PlanarTemplate& shape) {
  PlanePatch& to = *patch_;
  const int side = shape.side + 2;
  const int x0 = first_pixel(from.centre_x[0], shape.side) - 1, y0 = first_pixel(from.centre_y[0], shape.side) - 1;
  to.left = static_cast<std::int16_t>(shape.left - 1);
  to.top = static_cast<std::int16_t>(shape.top - 1);
  to.side = static_cast<std::int16_t>(side);
  to.levels = 1;
  int sum = 0;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const int x = std::clamp(x0 + i, 0, kPatchSide - 1), y = std::clamp(y0 + j, 0, kPatchSide - 1);
      sum += to.pixels[j * side + i] = from.pixels[0][y * kPatchSide + x];
    }
  to.mean = static_cast<float>(sum) / static_cast<float>(side * side);
}

void TemplateMatcher::fill_mask(const PlanarTemplate& shape, const std::uint8_t* mask) {
  for (int i = 0; i < shape.side * shape.side; ++i) probability_[i] = mask_probability(mask[i]);
}

Vec2 TemplateMatcher::slope_of(const SearchTask& task, const TemplateWarp& warp) {
  Vec2 slope;
  if (!task.normal_W.isZero(0) && warp.slope_of(task.first_view.q_WC.conjugate() * task.normal_W, &slope)) return slope;
  if (task.shape->has_normal) return Vec2(task.shape->slope[0], task.shape->slope[1]);
  return warp.facing();
}

/// Template and mask as the current image should show them, about the predicted pixel.
void TemplateMatcher::make_pattern(const SearchTask& task, const Mat2& A, Pattern* out) {
  const SourcePatch& patch = task.appearance->patch;
  const int side = task.shape->side;
  const Scalar scale = std::sqrt(std::max(A.determinant(), Scalar(0)));
  const int wanted = static_cast<int>(static_cast<Scalar>(side) / scale) | 1;
  const int n = std::clamp(wanted, std::min(side, static_cast<int>(PlanarTemplate::kMinSide)), side);
  Pattern p;
  p.size = n;
  p.row = (n + 3) / 4 * 4;
  const float a00 = static_cast<float>(A(0, 0)), a01 = static_cast<float>(A(0, 1));
  const float a10 = static_cast<float>(A(1, 0)), a11 = static_cast<float>(A(1, 1));
  const float x0 = static_cast<float>(first_pixel(patch.centre_x[0], side));
  const float y0 = static_cast<float>(first_pixel(patch.centre_y[0], side));
  const float last = static_cast<float>(side - 1), edge = static_cast<float>(kPatchSide - 1);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < p.row; ++i) {
      const float u = static_cast<float>(i - n / 2), v = static_cast<float>(j - n / 2);
      const float x = patch.centre_x[0] + a00 * u + a01 * v, y = patch.centre_y[0] + a10 * u + a11 * v;
      const float mx = x - x0, my = y - y0;
      const bool in = i < n && mx >= -kRim && my >= -kRim && mx <= last + kRim && my <= last + kRim && x >= 0.0f &&
                      y >= 0.0f && x <= edge && y <= edge;
      const int at = j * p.row + i;
      grey_[at] = weight_[at] = 0.0f;
      if (!in) continue;
      grey_[at] = sample(patch.pixels[0], kPatchSide, kPatchSide - 1, x, y);
      weight_[at] =
          kPerByte * sample(probability_, side, side - 1, std::clamp(mx, 0.0f, last), std::clamp(my, 0.0f, last));
      p.weight += weight_[at];
      p.grey += weight_[at] * grey_[at];
    }
  const float mean = p.weight > 0.0f ? p.grey / p.weight : 0.0f;
  p.grey = 0.0f;
  for (int at = 0; at < n * p.row; ++at) {
    grey_[at] -= mean;
    p.grey2 += weight_[at] * grey_[at] * grey_[at];
    grey_[at] *= weight_[at];
  }
  *out = p;
}

/// Zero-mean normalised correlation with the mask as weights. Its square is 1 less the weighted mean square residual, gain and bias
/// projected out, over the image's own.
/// x, y: first pixel in region_.
float TemplateMatcher::score(const Pattern& pattern, int x, int y) const {
  F32x4 v = {}, vv = {}, tv = {};
  for (int j = 0; j < pattern.size; ++j) {
    const float* row = region_ + (y + j) * kRegionRow + x;
    for (int i = 0; i < pattern.row; i += 4) {
      const F32x4 value = load<F32x4>(row + i), weighted = value * load<F32x4>(weight_ + j * pattern.row + i);
      v += weighted;
      vv += weighted * value;
      tv += value * load<F32x4>(grey_ + j * pattern.row + i);
    }
  }
  const float mean = sum(v), energy = sum(vv) - mean * mean / pattern.weight;
  return energy > 0.0f && pattern.grey2 > 0.0f ? sum(tv) / std::sqrt(energy * pattern.grey2) : 0.0f;
}

/// Grey levels about 128 of all pixels that a pattern meets in its search, its first at (left, top); zero outside of the image.
void TemplateMatcher::fill_region(const ImageView& image, const Pattern& pattern, int left, int top) {
  const int rows = pattern.size + kWindow - 1, columns = pattern.row + kWindow - 1;
  for (int j = 0; j < rows; ++j) {
    float* to = region_ + j * kRegionRow;
    const int y = top + j;
    const int begin = std::clamp(-left, 0, columns), end = std::clamp(image.width - left, begin, columns);
    if (y < 0 || y >= image.height) {
      std::fill(to, to + columns, 0.0f);
      continue;
    }
    std::fill(to, to + begin, 0.0f);
    const std::uint8_t* from = image.row(y);
    for (int i = begin; i < end; ++i) to[i] = static_cast<float>(static_cast<int>(from[left + i]) - 128);
    std::fill(to + end, to + columns, 0.0f);
  }
}

/// Best whole pixel of the ellipse. False where none is good enough, or another is nearly as good.
bool TemplateMatcher::find(const ImageView& image, const SearchTask& task, const Pattern& pattern, Vec2* position) {
  float all[kWindow * kWindow];
  const int cx = static_cast<int>(std::lround(task.predicted.x())),
            cy = static_cast<int>(std::lround(task.predicted.y()));
  const int half = pattern.size / 2;
  Mat2 S = task.innovation;
  S(0, 0) += kFloor;
  S(1, 1) += kFloor;
  const Mat2 M = S.inverse();
  int best = -1;
  fill_region(image, pattern, cx - kReach - half, cy - kReach - half);
  for (int k = 0; k < kWindow * kWindow; ++k) {
    const int x = cx + k % kWindow - kReach, y = cy + k / kWindow - kReach;
    const Vec2 off = Vec2(x, y) - task.predicted;
    const bool centre = x == cx && y == cy;
    all[k] = -1.0f;
    if (!image.contains(x, y, half) || !(centre || off.dot(M * off) <= task.gate)) continue;
    all[k] = score(pattern, k % kWindow, k / kWindow);
    if (best < 0 || all[k] > all[best]) best = k;
  }
  if (best < 0 || all[best] < kMinPeak) return false;
  const int bx = best % kWindow, by = best / kWindow;
  for (int k = 0; k < kWindow * kWindow; ++k) {
    const int dx = k % kWindow - bx, dy = k / kWindow - by;
    if (static_cast<float>(dx * dx + dy * dy) > kApart * kApart && all[k] > all[best] - kMinPeakLead) return false;
  }
  *position = Vec2(cx + bx - kReach, cy + by - kReach);
  return true;
}

/// Updates the mask, into learnt_, by the residuals that the aligner holds. Whether the template with that mask fits.
bool TemplateMatcher::judge(const PlanarTemplate& shape, const std::uint8_t* mask, float gain, Scalar shift_sigma,
                            const Vec2& slope_sigma, float max_misfit) {
  const PlaneSamples& s = aligner_->samples();
  const float per_half = 1.0f / static_cast<float>(aligner_->half_px()), per_gain = 1.0f / gain;
  const float shift = static_cast<float>(shift_sigma) + kWarpSlack;
  const float sx = static_cast<float>(slope_sigma.x()), sy = static_cast<float>(slope_sigma.y());
  float weight = 0, squares = 0;
  for (int i = 0; i < s.count; ++i) {
    MaskEvidence evidence;
    const float own = s.grey[i] + patch_->mean;
    evidence.valid = s.valid[i] > 0.0f && own > kDark && own < kBright;
    evidence.residual = s.r[i] * per_gain;
    const float gradient = per_half * std::sqrt(s.gx[i] * s.gx[i] + s.gy[i] * s.gy[i]);
    evidence.slack = kSlackSigmas * gradient * (shift + sx * std::fabs(s.X[i]) + sy * std::fabs(s.Y[i]));
    learnt_[i] =
        mode_ == MaskMode::kPartial ? learn_pixel(mask[i], evidence, shape.sigma_plane, shape.sigma_other) : mask[i];
    if (!(s.valid[i] > 0.0f)) continue;
    // Without what the least probability leaves: a few pixels far off the plane would count more than all that are on it.
    const std::uint8_t on = mask_probability(learnt_[i]);
    const float p = kPerByte * static_cast<float>(on - std::min(on, kOffPlane));
    weight += p;
    squares += p * evidence.residual * evidence.residual;
  }
  const float area = mask_area(learnt_, s.count);
  return area >= kMinKept * shape.area && area >= kMinArea &&
         squares <= max_misfit * shape.sigma_plane * shape.sigma_plane * weight;
}

SearchOutcome TemplateMatcher::search(const Tracker& tracker, const SearchTask& task) {
  SearchOutcome outcome;
  const ImageView& image = tracker.pyramid().level[0];
  TemplateWarp warp;
  Mat2 A;
  if (!tracker.warp(task, &A)) return outcome;
  const Scalar scale = std::sqrt(std::abs(A.determinant()));
  if (!(scale >= kMinScale && scale <= kMaxScale) ||
      !make_template_warp(camera_, *task.shape, task.first_view, task.p_W, task.q_WC, task.c_W, &warp))
    return tracker.search(task);
  fill_mask(*task.shape, task.mask);
  Vec2 position;
  if (radius_of(task) <= static_cast<Scalar>(kReach) + Scalar(0.5)) {
    outcome.comparable = true;
    Pattern pattern;
    make_pattern(task, A, &pattern);
    if (!find(image, task, pattern, &position)) return outcome;
  } else {
    outcome = tracker.search(task);
    if (!outcome.found) return outcome;
    outcome.found = false;
    position = outcome.pixel;
  }
  fill_patch(task.appearance->patch, *task.shape);
  // Where the feature itself is in the template's middle pixel; A is all that this needs.
  const SourcePatch& source = task.appearance->patch;
  const Vec2 middle(std::floor(source.centre_x[0] + 0.5f) - source.centre_x[0],
                    std::floor(source.centre_y[0] + 0.5f) - source.centre_y[0]);
  const Vec2 aside = A.inverse() * middle;
  const Mat3 H = warp.homography(slope_of(task, warp));
  Mat3 shift;
  if (!anchored(camera_, warp, H, position + aside, &shift)) return outcome;
  PlaneStart start;
  start.level = 0;
  start.H_CK = shift.lazyProduct(H);
  const PlaneAlignment found = aligner_->align(tracker.pyramid(), camera_, *patch_, start, ShiftWarp(), probability_);
  if (found.verdict == PlaneVerdict::kNotConverged || found.verdict == PlaneVerdict::kSlanted) return outcome;
  const Vec3 p = found.H_CK * Vec3(warp.ray_0.x(), warp.ray_0.y(), 1);
  Vec2 pixel;
  if (!(p.z() > Scalar(0)) || !project(camera_, p, &pixel)) return outcome;
  pixel -= aside;
  if (!((pixel - position).squaredNorm() <= kMaxMove * kMaxMove)) return outcome;
  // What the robust weights leave out, because it does not fit, has moved the template all the same.
  const float fitting = kNoiseKept * found.sigma * found.sigma;
  const float misfit = fitting > 0.0f ? std::max(1.0f, mean_square(aligner_->samples()) / fitting) : 1.0f;
  const Mat2 noise =
      (found.covariance + found.reference_covariance).topLeftCorner<2, 2>() * static_cast<Scalar>(misfit);
  outcome.score = found.correlation;
  if (!judge(*task.shape, task.mask, found.gain, std::sqrt(noise.trace() / 2), Vec2::Zero(), max_misfit_))
    return outcome;
  outcome.found = true;
  outcome.pixel = pixel;
  outcome.level_scale = 1;
  outcome.noise = noise;
  return outcome;
}

bool TemplateMatcher::learn(const Tracker& tracker, const SearchTask& task, const Vec2& pixel, PlanarTemplate* shape,
                            std::uint8_t* mask) {
  TemplateWarp warp;
  Mat2 A;
  if (!tracker.warp(task, &A)) return false;
  const Scalar scale = std::sqrt(std::abs(A.determinant()));
  if (!(scale >= kMinScale && scale <= kMaxScale) ||
      !make_template_warp(camera_, *shape, task.first_view, task.p_W, task.q_WC, task.c_W, &warp))
    return false;
  const SourcePatch& source = task.appearance->patch;
  fill_patch(source, *shape);
  fill_mask(*shape, mask);
  const Vec2 middle(std::floor(source.centre_x[0] + 0.5f) - source.centre_x[0],
                    std::floor(source.centre_y[0] + 0.5f) - source.centre_y[0]);
  const Vec2 at = pixel + A.inverse() * middle;
  Vec2 slope = slope_of(task, warp);
  TemplateNormal normal;
  normal.slope = slope;
  normal.covariance << static_cast<Scalar>(shape->covariance[0]), static_cast<Scalar>(shape->covariance[1]),
      static_cast<Scalar>(shape->covariance[1]), static_cast<Scalar>(shape->covariance[2]);
  TemplateNormal measured;
  if (task.normal_W.isZero(0) &&
      measure_slopes(tracker.pyramid(), camera_, *patch_, probability_, warp, slope, at, aligner_, &measured)) {
    fuse_slopes(measured, &normal);
    slope = normal.slope;
    shape->has_normal = true;
    shape->slope[0] = static_cast<float>(slope.x());
    shape->slope[1] = static_cast<float>(slope.y());
    shape->covariance[0] = static_cast<float>(normal.covariance(0, 0));
    shape->covariance[1] = static_cast<float>(normal.covariance(0, 1));
    shape->covariance[2] = static_cast<float>(normal.covariance(1, 1));
  }
  const Mat3 H = warp.homography(slope);
  Mat3 shift;
  if (!anchored(camera_, warp, H, at, &shift)) return false;
  PlaneStart start;
  start.level = 0;
  start.H_CK = shift.lazyProduct(H);
  float gain = 1;
  if (!aligner_->compare(tracker.pyramid(), camera_, *patch_, start, probability_, &gain)) return false;
  const Scalar leverage = task.normal_W.isZero(0) ? slope_leverage(warp, patch_->side) : Scalar(0);
  const Vec2 slope_sigma(leverage * std::min(std::sqrt(normal.covariance(0, 0)), Scalar(kMaxSlopeSigma)),
                         leverage * std::min(std::sqrt(normal.covariance(1, 1)), Scalar(kMaxSlopeSigma)));
  if (!judge(*shape, mask, gain, Scalar(0), slope_sigma, std::min(max_misfit_, kMaxLearntMisfit))) return false;
  std::memcpy(mask, learnt_, static_cast<std::size_t>(shape->side * shape->side));
  shape->area = mask_area(mask, shape->side * shape->side);
  if (shape->frames < INT16_MAX) ++shape->frames;
  return true;
}

}  // namespace pf
