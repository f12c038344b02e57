#include "track/align_plane.h"

#include <algorithm>
#include <cmath>

#include "geometry/small_cholesky.h"
#include "track/tuning.h"

namespace pf {
namespace {

using namespace tuning::align_plane;

constexpr float kBlur = 0.125f;                                                           // of each of four neighbours
constexpr float kBlurKept = (1.0f - 4 * kBlur) * (1.0f - 4 * kBlur) + 4 * kBlur * kBlur;  // of noise that is blurred so
// Of normal residuals with unit variance, with the weights of PlaneSums and their cut-off:
constexpr float kPsiOfNormal = 0.7813f;    // E psi^2 / E h
constexpr float kSpread = 0.8144f;         // E psi^2 / (E psi')^2 E h
constexpr float kPerByte = 1.0f / 255.0f;  // of a mask
constexpr int kLightRounds = 2;            ///< of gain and bias about a homography that stays
constexpr int kLevelsNear = 2;             ///< finest levels, on which steps are those of the weights' slope

/// Rays at depth 1 to pixels of the pinhole, at a level.
Mat3 level_projection(const Camera& camera, int level) {
  const Scalar scale = Scalar(1) / static_cast<Scalar>(1 << level);
  Mat3 K = Mat3::Identity();
  K(0, 0) = camera.fx * scale;
  K(1, 1) = camera.fy * scale;
  K(0, 2) = to_level(camera.cx, level);
  K(1, 2) = to_level(camera.cy, level);
  return K;
}

template <int kColumns>
Eigen::Matrix<Scalar, kColumns, kColumns> system_of(const PlaneSums<kColumns>& sums) {
  Eigen::Matrix<Scalar, kColumns, kColumns> A;
  int at = 0;
  for (int i = 0; i < kColumns; ++i)
    for (int j = i; j < kColumns; ++j) A(i, j) = A(j, i) = static_cast<Scalar>(sums.A[at++]);
  return A;
}

/// Of template and image = r + gain grey + bias, both weighted.
template <int kColumns>
float correlation_of(const PlaneSums<kColumns>& s, float gain) {
  const float n = s.weight;
  const float tt = s.grey2 - s.grey * s.grey / n;
  const float rt = s.b[kColumns - 2] - s.b[kColumns - 1] * s.grey / n;
  const float rr = s.squares - s.b[kColumns - 1] * s.b[kColumns - 1] / n;
  const float it = rt + gain * tt, ii = rr + 2.0f * gain * rt + gain * gain * tt;
  return tt > 0.0f && ii > 0.0f ? it / std::sqrt(ii * tt) : 0.0f;
}

/// Whether the patch at its middle is neither too slanted nor too small or large, image against reference. H maps its own coordinates.
bool is_comparable(const Camera& camera, const Mat3& H, Scalar half) {
  Vec2 pixel;
  Mat23 J_pixel;
  const Vec3 p = H.col(2);
  if (!(p.z() > Scalar(0)) || !project(camera, p, &pixel, &J_pixel)) return false;
  const Mat2 A = J_pixel * H.leftCols<2>() / half;
  const Scalar half_trace = A.squaredNorm() / 2, det = std::abs(A.determinant());
  const Scalar large = std::sqrt(half_trace + std::sqrt(std::max(Scalar(0), half_trace * half_trace - det * det)));
  return large >= static_cast<Scalar>(kMinStretch) && large <= static_cast<Scalar>(kMaxStretch) &&
         det >= static_cast<Scalar>(kMinAspect) * large * large;
}

}  // namespace

struct PlaneAligner::Progress {
  Mat3 H;  ///< patch's own coordinates to rays of the image
  PlaneReading reading;
  PlaneCounts counts;
  const ImageMask* mask = nullptr;  ///< of the image; null: none
  int iterations = 0;
};

bool PlaneAligner::begin(const Camera& camera, const PlanePatch& patch) {
  has_lens_ = !PlaneLens::is_pinhole(camera);
  if (has_lens_ && !lens_.set_reference(camera, patch)) return false;
  half_ = static_cast<Scalar>(patch.side) / 2;
  const Scalar middle = static_cast<Scalar>(patch.side - 1) / 2;
  Vec2 centre(patch.left + middle, patch.top + middle);
  if (has_lens_) {
    const float at = static_cast<float>(middle);
    centre += lens_.reference_at(lens_.cell_of(at, at)).cast<Scalar>();
  }
  to_ray_ << half_ / camera.fx, 0, (centre.x() - camera.cx) / camera.fx, 0, half_ / camera.fy,
      (centre.y() - camera.cy) / camera.fy, 0, 0, 1;
  for (int k = 0; k < 4; ++k) {
    Vec3 ray;
    if (!unproject(camera, patch.corner(k), &ray) || !(ray.z() > Scalar(0))) return false;
    const Vec2 pinhole(camera.fx * ray.x() / ray.z() + camera.cx, camera.fy * ray.y() / ray.z() + camera.cy);
    corner_[k] = (pinhole - centre) / half_;
  }
  return true;
}

/// Largest way of a corner under a step, in the patch's own coordinates; huge where it is no number.
Scalar PlaneAligner::corner_way(const Mat3& step) const {
  Scalar largest = 0;
  for (const Vec2& c : corner_) {
    const Vec3 p = step * Vec3(c.x(), c.y(), 1);
    const Scalar way = std::hypot(p.x() / p.z() - c.x(), p.y() / p.z() - c.y());
    if (!(way <= largest)) largest = std::isfinite(way) ? way : static_cast<Scalar>(kNoWay);
  }
  return largest;
}

/// Lists the pixels of a level that are compared, with their rays and gradients.
void PlaneAligner::load_samples(const PlanePatch& patch, int level, float slack_px, const std::uint8_t* mask) {
  const int side = patch.side_of(level);
  const std::uint8_t* pixels = patch.level(level);
  const int inner = (side - 2) * (side - 2);
  const bool every_other = level > 0 && inner > kMaxCoarseSamples;
  const float size = static_cast<float>(1 << level), first = 0.5f * size - 0.5f;
  const float middle = 0.5f * static_cast<float>(patch.side - 1), half = static_cast<float>(half_);
  const float per_half = 1.0f / half;
  const float per_noise = slack_px * size / (half * kNominalNoise), per_noise2 = per_noise * per_noise;
  Eigen::Vector2f centre(middle, middle);
  if (has_lens_) centre += lens_.reference_at(lens_.cell_of(middle, middle));
  PlaneSamples& s = samples_;
  int n = 0;
  float squares = 0;
  all_weight_ = 0.0f;
  for (int y = 1; y < side - 1; ++y)
    for (int x = 1; x < side - 1; ++x) {
      if (level == 0 ? !patch.is_chosen(x, y) : every_other && ((x + y) & 1) != 0) continue;
      const std::uint8_t* at = pixels + y * side + x;
      float gx = 0.5f * half / size * static_cast<float>(at[1] - at[-1]);
      float gy = 0.5f * half / size * static_cast<float>(at[side] - at[-side]);
      squares += gx * gx + gy * gy;
      Eigen::Vector2f place(size * static_cast<float>(x) + first, size * static_cast<float>(y) + first);
      s.px[n] = place.x();
      s.py[n] = place.y();
      if (has_lens_) {
        float J[4];
        place += lens_.reference_at(lens_.cell_of(place.x(), place.y()), J);
        // Gradient by the pinhole's pixel: (I + J)^-T g.
        const float a = 1.0f + J[0], b = J[1], c = J[2], d = 1.0f + J[3], per_det = 1.0f / (a * d - b * c);
        const float ux = (d * gx - c * gy) * per_det;
        gy = (a * gy - b * gx) * per_det;
        gx = ux;
      }
      s.X[n] = (place.x() - centre.x()) * per_half;
      s.Y[n] = (place.y() - centre.y()) * per_half;
      // As blurred as interpolation leaves the image, over all places between its pixels.
      const int bend = at[1] + at[-1] + at[side] + at[-side] - 4 * at[0];
      s.grey[n] = static_cast<float>(at[0]) + kBlur * static_cast<float>(bend) - patch.mean;
      s.trust[n] = 1.0f / (1.0f + per_noise2 * (gx * gx + gy * gy));
      s.gx[n] = gx;
      s.gy[n] = gy;
      s.mask[n] = mask != nullptr ? kPerByte * static_cast<float>(mask[(y - 1) * (side - 2) + x - 1]) : 1.0f;
      all_weight_ += s.mask[n];
      ++n;
    }
  gradient2_ = n > 0 ? squares / (half * half * static_cast<float>(n)) : 0.0f;
  s.count = n;
  for (; n % 4 != 0; ++n) {
    for (float* each : {s.X, s.Y, s.grey, s.gx, s.gy, s.px, s.py, s.mask, s.trust}) each[n] = 0.0f;
  }
  s.padded = n;
}

/// Reads the image where the warp puts the samples. False where it leaves what the lens can project, or too little of it is in the image.
bool PlaneAligner::read(const ImageView& image, const Camera& camera, int level, Progress* progress) {
  PlaneReading& reading = progress->reading;
  const Mat3 G = level_projection(camera, level) * progress->H;
  for (int i = 0; i < 9; ++i) reading.G[i] = static_cast<float>(G(i / 3, i % 3));
  reading.image_share = 0.5f;
  reading.has_lens = has_lens_;
  if (has_lens_) {
    const Mat3 H_CK = progress->H * to_ray_.inverse();
    if (!lens_.set_image(camera, H_CK)) return false;
    const Vec3 p = progress->H.col(2);
    Vec2 pixel;
    Mat23 J;
    if (!project(camera, Vec3(p.x() / p.z(), p.y() / p.z(), 1), &pixel, &J)) return false;
    for (int i = 0; i < 4; ++i)
      reading.C[i] = static_cast<float>(J(i / 2, i % 2) / (i % 2 == 0 ? camera.fx : camera.fy));
    const float scale = 1.0f / static_cast<float>(1 << level);
    for (int i = 0; i < samples_.padded; ++i) {
      const Eigen::Vector2f e = lens_.image_at(lens_.cell_of(samples_.px[i], samples_.py[i]));
      samples_.ex[i] = e.x() * scale;
      samples_.ey[i] = e.y() * scale;
    }
  }
  progress->counts = read_samples(image, reading, &samples_);
  if (progress->mask != nullptr) leave_out_masked(*progress->mask, level, reading, &samples_, &progress->counts);
  return progress->counts.valid > 0.0f && progress->counts.valid >= kMinWeight * all_weight_;
}

template <typename Warp>
bool PlaneAligner::align_level(const ImageView& image, const Camera& camera, int level, Warp* warp, Progress* progress,
                               PlaneSums<Warp::kSize + 2>* sums) {
  constexpr int kSize = Warp::kSize;
  using System = Eigen::Matrix<Scalar, kSize + 2, 1>;
  const Scalar side_px = half_ / static_cast<Scalar>(1 << level);
  const Scalar small = static_cast<Scalar>(level > 0 ? kCoarseStep : kSmallStep) / side_px;
  PlaneReading& reading = progress->reading;
  for (int k = 0; progress->iterations < kMaxIterations; ++k) {
    if (level > 0 && k == (kSize > ShiftWarp::kSize ? kCoarseIterations : kShiftIterations)) return true;
    if (!read(image, camera, level, progress)) return false;
    if (progress->iterations == 0) fit_light(&samples_, &reading);
    ++progress->iterations;
    warp->begin(progress->H);
    const float sigma = std::max(kMinSigma, robust_sigma(samples_, progress->counts.valid));
    sum_samples(samples_, *warp, kCutOff * sigma, level < kLevelsNear, sums);
    System b;
    for (int i = 0; i < kSize + 2; ++i) b(i) = static_cast<Scalar>(-sums->b[i]);
    SmallCholesky<kSize + 2> cholesky;
    if (!cholesky.factor(system_of(*sums))) return false;
    const System step = cholesky.template solve<1>(b);
    const Mat3 increment = warp->increment(step.template head<kSize>());
    const Scalar way = corner_way(increment);
    if (!(way < static_cast<Scalar>(2 * kMaxStep))) return false;
    progress->H = progress->H * increment;
    // image = gain grey + bias; the columns grey and 1 have the other sign in r.
    const float gain = reading.gain;
    reading.gain -= static_cast<float>(step(kSize));
    reading.bias -= static_cast<float>(step(kSize + 1));
    if (!(reading.gain > kMinGain)) return false;
    const bool last = progress->iterations == kMaxIterations;
    if (way < (level == 0 && last ? static_cast<Scalar>(kLastStep) / side_px : small)) {
      if (level == 0) reading.gain = gain;  // that of the sums
      return true;
    }
  }
  return false;
}

/// Covariances of the corners and the verdict, from the sums of the last iteration.
template <typename Warp>
void PlaneAligner::judge(const Camera& camera, const Warp& warp, const PlaneSums<Warp::kSize + 2>& sums,
                         const Progress& progress, PlaneAlignment* out) const {
  constexpr int kSize = Warp::kSize;
  const Mat3& H = progress.H;
  Eigen::Matrix<Scalar, 8, kSize> J;
  for (int k = 0; k < 4; ++k) {
    const Vec2& c = corner_[k];
    Mat23 J_pixel;
    if (!project(camera, H * Vec3(c.x(), c.y(), 1), &out->corner[k], &J_pixel)) return;
    const Mat2 J_c = J_pixel * H.leftCols<2>();
    J.template middleRows<2>(2 * k) = J_c * warp.jacobian(c.x(), c.y());
  }
  const float gain = progress.reading.gain, gain2 = gain * gain;
  const float kept = progress.counts.kept / progress.counts.valid;
  const float variance =
      sums.slope > 0.0f ? sums.psi2 / (sums.slope * kPsiOfNormal * (kept + kBlurKept * gain2)) : 0.0f;
  const float noise = std::min(variance / gradient2_, kMaxGradientNoise);  // of the gradients' squares, what is noise
  SmallCholesky<kSize + 2> cholesky;
  if (!(sums.slope > 0.0f) || !cholesky.factor(system_of(sums))) return;
  const Eigen::Matrix<Scalar, kSize, kSize> C = cholesky.inverse().template topLeftCorner<kSize, kSize>();
  const Eigen::Matrix<Scalar, 8, kSize> JC = J.lazyProduct(C);
  const PlaneAlignment::Mat8 shape = JC.lazyProduct(J.transpose());
  out->sigma = std::sqrt(variance);
  out->covariance = shape * static_cast<Scalar>(kSpread * variance / (1.0f - noise));
  out->reference_covariance = out->covariance * static_cast<Scalar>(gain2);
  out->correlation = correlation_of(sums, gain);
  if constexpr (kSize == 2)
    out->step_covariance = C * static_cast<Scalar>(kSpread * variance * (1.0f + gain2) / (1.0f - noise));
  out->weight = sums.weight / all_weight_;
  out->verdict = !is_comparable(camera, H, half_)         ? PlaneVerdict::kSlanted
                 : !(out->weight >= kMinWeight)           ? PlaneVerdict::kHidden
                 : !(out->correlation >= kMinCorrelation) ? PlaneVerdict::kUnlike
                                                          : PlaneVerdict::kAligned;
}

template <typename Warp>
PlaneAlignment PlaneAligner::align(const Pyramid& image, const Camera& camera, const PlanePatch& patch,
                                   const PlaneStart& start, Warp warp, const std::uint8_t* mask) {
  PlaneAlignment out;
  out.H_CK = start.H_CK;
  out.covariance.setZero();
  out.reference_covariance.setZero();
  for (int k = 0; k < 4; ++k) out.corner[k].setZero();
  if (!begin(camera, patch)) return out;
  Progress progress;
  progress.mask = in_use(image.mask);
  progress.H = start.H_CK * to_ray_;
  progress.reading.gain = start.gain;
  progress.reading.bias = start.gain * patch.mean + start.offset;
  if (!is_comparable(camera, progress.H, half_)) {
    out.verdict = PlaneVerdict::kSlanted;
    return out;
  }
  PlaneSums<Warp::kSize + 2> sums = {};
  bool done = true;
  const int coarsest = std::min({start.level, patch.levels - 1, image.levels - 1});
  for (int level = coarsest; level >= 0 && done; --level) {
    load_samples(patch, level, start.slack_px, level == 0 ? mask : nullptr);
    if (level == coarsest && level > 0 && Warp::kSize > ShiftWarp::kSize) {
      // A shift first: while it is far off, what hides a part of the patch would bend a homography.
      ShiftWarp shift;
      PlaneSums<ShiftWarp::kSize + 2> unused;
      done = align_level(image.level[level], camera, level, &shift, &progress, &unused);
    }
    done = done && align_level(image.level[level], camera, level, &warp, &progress, &sums);
  }
  out.iterations = progress.iterations;
  if (done || progress.iterations == kMaxIterations) out.H_CK = progress.H * to_ray_.inverse();
  if (!done) return out;
  out.gain = progress.reading.gain;
  out.offset = progress.reading.bias - progress.reading.gain * patch.mean;
  judge(camera, warp, sums, progress, &out);
  return out;
}

bool PlaneAligner::compare(const Pyramid& image, const Camera& camera, const PlanePatch& patch, const PlaneStart& start,
                           const std::uint8_t* mask, float* gain) {
  if (!begin(camera, patch)) return false;
  Progress progress;
  progress.mask = in_use(image.mask);
  progress.H = start.H_CK * to_ray_;
  progress.reading.gain = start.gain;
  progress.reading.bias = start.gain * patch.mean + start.offset;
  load_samples(patch, 0, start.slack_px, mask);
  if (!read(image.level[0], camera, 0, &progress)) return false;
  fit_light(&samples_, &progress.reading);
  for (int round = 0; round < kLightRounds; ++round) {
    const float sigma = std::max(kMinSigma, robust_sigma(samples_, progress.counts.valid));
    PlaneSums<LightWarp::kSize + 2> sums;
    sum_samples(samples_, LightWarp(), kCutOff * sigma, false, &sums);
    SmallCholesky<2> cholesky;
    if (!cholesky.factor(system_of(sums))) return false;
    const Vec2 step = cholesky.solve<1>(Vec2(static_cast<Scalar>(sums.b[0]), static_cast<Scalar>(sums.b[1])));
    const float by_gain = static_cast<float>(step(0)), by_bias = static_cast<float>(step(1));
    for (int i = 0; i < samples_.count; ++i) samples_.r[i] -= by_gain * samples_.grey[i] + by_bias;
    progress.reading.gain += by_gain;
  }
  *gain = progress.reading.gain;
  return *gain > kMinGain;
}

template PlaneAlignment PlaneAligner::align(const Pyramid&, const Camera&, const PlanePatch&, const PlaneStart&,
                                            ShiftWarp, const std::uint8_t*);
template PlaneAlignment PlaneAligner::align(const Pyramid&, const Camera&, const PlanePatch&, const PlaneStart&,
                                            SlopesWarp, const std::uint8_t*);
template PlaneAlignment PlaneAligner::align(const Pyramid&, const Camera&, const PlanePatch&, const PlaneStart&,
                                            HomographyWarp, const std::uint8_t*);

}  // namespace pf
