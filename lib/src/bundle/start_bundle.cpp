#include "bundle/start_bundle.h"

#include <algorithm>
#include <cmath>

#include "bundle/rotation_fit.h"
#include "bundle/tuning.h"
#include "geometry/pnp.h"
#include "geometry/small_cholesky.h"

namespace pf {
namespace {

using namespace tuning::start;

constexpr int kDirections = 6;                 // there and back along each axis
constexpr Scalar kBehindCamera = Scalar(1e6);  ///< [px^2] error of what does not project: larger than any other

}  // namespace

bool StartRecord::layout(Arena& arena) {
  frame_ = arena.take<Frame>(kMaxFrames);
  ray_ = arena.take<Vec3>(kMaxFeatures);
  pixel_ = arena.take<BundlePixel>(kMaxFrames * kMaxFeatures);
  return arena.ok();
}

void StartRecord::init() {
  frames_ = 0;
  features_ = 0;
}

int StartRecord::add_feature(const Vec3& ray) {
  if (features_ == kMaxFeatures) return -1;
  ray_[features_] = ray;
  return features_++;
}

int StartRecord::add_frame(std::int64_t t_ns, const Quat& q_WC, const Vec3& p_W) {
  if (frames_ == kMaxFrames) {
    for (int k = 1; 2 * k < kMaxFrames; ++k) {
      frame_[k] = frame_[2 * k];
      std::copy(pixel_ + 2 * k * kMaxFeatures, pixel_ + (2 * k + 1) * kMaxFeatures, pixel_ + k * kMaxFeatures);
    }
    frames_ = kMaxFrames / 2;
  }
  frame_[frames_].t_ns = t_ns;
  frame_[frames_].q_WC = q_WC;
  frame_[frames_].p_W = p_W;
  for (int i = 0; i < kMaxFeatures; ++i) pixel_[frames_ * kMaxFeatures + i].seen = false;
  return frames_++;
}

void StartRecord::add_pixel(int frame, int feature, const Vec2& pixel) {
  BundlePixel& p = pixel_[frame * kMaxFeatures + feature];
  p.x = static_cast<float>(pixel.x());
  p.y = static_cast<float>(pixel.y());
  p.seen = true;
}

bool StartBundle::layout(Arena& arena, int lens_rows) {
  static_assert(1 + kMaxCameras <= BundleAdjuster::kMaxPoses);
  rho_ = arena.take<Scalar>(StartRecord::kMaxFeatures);
  best_rho_ = arena.take<Scalar>(StartRecord::kMaxFeatures);
  last_rho_ = arena.take<Scalar>(StartRecord::kMaxFeatures);
  if (lens_rows > 0) lens_ = arena.take<Lens>(1);
  return adjuster_.layout(arena, 1 + kMaxCameras, kMaxCameras, StartRecord::kMaxFeatures, 0, lens_rows);
}

void StartBundle::init() {
  for (int i = 0; i < StartRecord::kMaxFeatures; ++i) last_rho_[i] = Scalar(0);
  last_parallax_ = Scalar(0);
  random_ = kPoseSeed;
  is_free_ = false;
}

void StartBundle::free_lens(const Camera& calibration, const LensPrior& prior) {
  if (lens_ == nullptr) return;
  is_free_ = true;
  lens_->rows = prior.rows;
  lens_->prior = lens_->camera = calibration;
  lens_information(prior, kLensInflation, lens_->information);
}

/// The record's rays become those of the same pixels through another lens.
void StartBundle::set_lens(const Camera& camera, StartRecord& record) {
  lens_->camera = camera;
  for (int i = 0; i < record.features(); ++i)
    if (lens_->pixel[i].given) unproject(camera, lens_->pixel[i].pixel, &record.rays()[i]);
}

/// Parallax of a frame [px].
Scalar StartBundle::fit_rotation(const Camera& camera, const StartRecord& record, int frame, Quat* q_WC) const {
  Scalar scratch[StartRecord::kMaxFeatures];
  return pf::fit_rotation(camera, record.rays(), record.pixels(frame), record.features(), scratch, q_WC);
}

/// Adjusts the poses of `frame` (pose_[1] and on) and all rho; returns the robust cost.
Scalar StartBundle::adjust(const Camera& camera, const StartRecord& record, const int* frame, int cameras, int rounds,
                           Scalar sigma_px, const BundleLens* lens) {
  pose_[0] = {Quat::Identity(), Vec3::Zero(), false, nullptr};
  for (int c = 0; c < cameras; ++c) {
    pose_[1 + c].free = true;
    pose_[1 + c].pixel = record.pixels(frame[c]);
  }
  const AdjustOptions options = {sigma_px, kHuber, Scalar(1), kPriorSigma, kBehindWeight, kNoPixelPenalty, rounds};
  Bundle bundle = {pose_, 1 + cameras, record.rays(), nullptr, rho_, record.features()};
  bundle.lens = lens;
  return adjuster_.adjust(camera, options, bundle);
}

/// Likewise of all cameras, and the lens with them. What a wrong lens does to depths would otherwise be left for the filter, which believes
/// some of it: it cannot repeat what an adjustment has made of a record to the last digit.
Scalar StartBundle::adjust_with_lens(StartRecord& record, const int* frame, int cameras, Scalar sigma_px) {
  const BundleLens lens = {lens_->rows, lens_->information, lens_->prior, &lens_->camera, lens_->pixel, record.rays()};
  return adjust(lens_->camera, record, frame, cameras, kRounds, sigma_px, &lens);
}

/// A solution that is not taken leaves the lens as it was.
StartOutcome StartBundle::solve(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar median_depth) {
  if (!is_free_) return solve_by(camera, record, sigma_px, median_depth);
  const Camera before = lens_->camera;
  for (int i = 0; i < record.features(); ++i)
    lens_->pixel[i].given = project(before, record.ray(i), &lens_->pixel[i].pixel);
  const StartOutcome outcome = solve_by(lens_->camera, record, sigma_px, median_depth);
  if (outcome != StartOutcome::kSolved && outcome != StartOutcome::kSettled) set_lens(before, record);
  return outcome;
}

/// camera: where the lens is adjusted, that which is.
StartOutcome StartBundle::solve_by(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar median_depth) {
  const int last = record.frames() - 1;
  if (last < 0) return StartOutcome::kWait;
  int left = 0;
  for (int i = 0; i < record.features(); ++i) left += record.seen(last, i) ? 1 : 0;
  if (left < kMinFeatures) return StartOutcome::kTooFew;

  Quat q_last = record.frame(last).q_WC;
  const Scalar parallax = fit_rotation(camera, record, last, &q_last);
  if (!(parallax >= kMinParallax * sigma_px && parallax >= kGrowth * last_parallax_)) return StartOutcome::kWait;

  // Adjust frame 0 and the last frame from six directions of motion, with the turn that explains most by itself; the parallax gives the
  // distance at a depth of one. A camera that looks at one place while it moves about it has a turn that none of them comes near, so the
  // last solution, where there is one, is the seventh.
  const int count = record.features();
  const Scalar length = parallax / camera.fx;
  const int guesses = kDirections + (last_parallax_ > Scalar(0) ? 1 : 0);
  BundlePose best_pose = {Quat::Identity(), Vec3::Zero(), true, nullptr};
  Scalar best = -1, second = -1;
  for (int guess = 0; guess < guesses; ++guess) {
    if (guess < kDirections) {
      Vec3 direction = Vec3::Zero();
      direction[guess / 2] = guess % 2 == 0 ? Scalar(1) : Scalar(-1);
      pose_[1].q_WC = q_last;
      pose_[1].p_W = direction * length * Scalar(2);
      for (int i = 0; i < count; ++i) rho_[i] = Scalar(1);
    } else {
      pose_[1].q_WC = record.frame(last).q_WC;
      pose_[1].p_W = record.frame(last).p_W / median_depth;
      for (int i = 0; i < count; ++i) rho_[i] = last_rho_[i] > Scalar(0) ? last_rho_[i] * median_depth : Scalar(1);
    }
    const Scalar c = adjust(camera, record, &last, 1, kGuessRounds, sigma_px);
    if (best >= Scalar(0)) {
      const Scalar cosine = pose_[1].p_W.dot(best_pose.p_W) / (pose_[1].p_W.norm() * best_pose.p_W.norm());
      if (cosine > kSameDirection) {  // the same explanation again
        if (c >= best) continue;
      } else if (c >= best) {
        if (second < Scalar(0) || c < second) second = c;
        continue;
      } else {
        second = best;
      }
    }
    best = c;
    best_pose = pose_[1];
    std::copy(rho_, rho_ + count, best_rho_);
  }
  // Two solutions that fit about equally well (a scene and its inverted twin): wait for parallax up to kAmpleParallax.
  if (second >= Scalar(0) && second - best < kMinMargin && parallax < kAmpleParallax * sigma_px)
    return StartOutcome::kWait;

  // Adjust the last frame together with others spread over the record.
  std::copy(best_rho_, best_rho_ + count, rho_);
  int frame[kMaxCameras] = {};
  int cameras = std::min(static_cast<int>(kMaxCameras), record.frames());
  for (int c = 0; c < cameras; ++c) frame[c] = last - c * (last + 1) / cameras;
  pose_[1] = best_pose;
  for (int c = 1; c < cameras; ++c) {
    pose_[1 + c].q_WC = record.frame(frame[c]).q_WC;
    fit_rotation(camera, record, frame[c], &pose_[1 + c].q_WC);
    pose_[1 + c].p_W = best_pose.p_W * (static_cast<Scalar>(frame[c] + 1) / static_cast<Scalar>(last + 1));
    if (!locate(camera, record, frame[c], sigma_px, &pose_[1 + c])) return StartOutcome::kWait;
  }
  const Scalar total = is_free_ ? adjust_with_lens(record, frame, cameras, sigma_px)
                                : adjust(camera, record, frame, cameras, kRounds, sigma_px);
  int pixels = 0;
  for (int c = 0; c < cameras; ++c)
    for (int i = 0; i < count; ++i) pixels += record.seen(frame[c], i) ? 1 : 0;
  // A pixel has two numbers, so noise alone leaves a cost of 2; at three times that the solution is rejected.
  if (!(total <= kMaxCost * static_cast<Scalar>(pixels))) return StartOutcome::kWait;

  // Select the depths that can be trusted, and set the unit of length.
  Scalar sorted[StartRecord::kMaxFeatures];
  bool is_good[StartRecord::kMaxFeatures] = {};
  int good = 0;
  for (int i = 0; i < count; ++i) {
    if (!record.seen(last, i) || !(rho_[i] > kMinGoodRho)) continue;
    Scalar worst = 0;
    for (int c = 0; c < cameras; ++c) {
      if (!record.seen(frame[c], i)) continue;
      Vec2 z;
      const BundlePose& pose = pose_[1 + c];
      if (!project_bearing(camera, pose.q_WC.toRotationMatrix(), record.ray(i), -pose.p_W, rho_[i], &z))
        worst = kBehindCamera;
      else
        worst = std::max(worst, (record.pixel(frame[c], i) - z).squaredNorm());
    }
    if (worst > kMaxGoodResidual * kMaxGoodResidual * sigma_px * sigma_px) continue;
    is_good[i] = true;
    sorted[good++] = rho_[i];
  }
  if (good < kMinFeatures) return StartOutcome::kWait;
  std::nth_element(sorted, sorted + good / 2, sorted + good);
  Scalar unit = Scalar(1) / (sorted[good / 2] * median_depth);
  int common = 0;
  for (int i = 0; i < count; ++i)
    if (is_good[i] && last_rho_[i] > Scalar(0)) sorted[common++] = last_rho_[i] / rho_[i];
  if (common >= kMinFeatures) {
    std::nth_element(sorted, sorted + common / 2, sorted + common);
    unit = sorted[common / 2];
  }
  for (int k = 0; k <= last; ++k) {
    int nearest = 0;
    for (int c = 1; c < cameras; ++c)
      if (std::abs(frame[c] - k) < std::abs(frame[nearest] - k)) nearest = c;
    BundlePose pose = pose_[1 + nearest];
    if (frame[nearest] != k && !locate(camera, record, k, sigma_px, &pose)) return StartOutcome::kWait;
    record.frame(k).q_WC = pose.q_WC;
    record.frame(k).p_W = pose.p_W / unit;
  }
  for (int i = 0; i < count; ++i) {
    rho_[i] *= unit;
    last_rho_[i] = is_good[i] ? rho_[i] : Scalar(0);
  }
  last_parallax_ = parallax;
  return parallax > kSettledParallax * sigma_px ? StartOutcome::kSettled : StartOutcome::kSolved;
}

bool StartBundle::baseline_covariance(const Camera& calibration, const StartRecord& record, Scalar sigma_px,
                                      Scalar median_depth, Mat3* covariance) const {
  const Camera& camera = is_free_ ? lens_->camera : calibration;
  const int last = record.frames() - 1;
  if (last < 0) return false;
  int left = 0;
  for (int i = 0; i < record.features(); ++i) left += record.seen(last, i) ? 1 : 0;
  if (left < kMinFeatures) return false;
  Quat q_WC = record.frame(last).q_WC;
  const Scalar parallax = std::max(sigma_px, fit_rotation(camera, record, last, &q_WC));
  Mat3 A;
  if (!translation_left(camera, record.rays(), record.pixels(last), record.features(), q_WC, &A)) return false;
  A += Mat3::Identity() * (parallax * parallax / (kMaxBaseline * kMaxBaseline));
  SmallCholesky<3> cholesky;
  if (!cholesky.factor(A)) return false;
  *covariance = cholesky.inverse() * (parallax * parallax * median_depth * median_depth);
  return true;
}

void StartBundle::follow(const Camera& calibration, StartRecord& record, Scalar sigma_px, Scalar depth, Scalar* rho) {
  const Camera& camera = is_free_ ? lens_->camera : calibration;
  const int last = record.frames() - 1;
  const int cameras = std::min(static_cast<int>(kMaxCameras), record.frames());
  int frame[kMaxCameras] = {};
  for (int c = 0; c < cameras; ++c) {
    frame[c] = last - c * (last + 1) / cameras;
    pose_[1 + c].q_WC = record.frame(frame[c]).q_WC;
    pose_[1 + c].p_W = record.frame(frame[c]).p_W / depth;
  }
  std::copy(rho, rho + record.features(), rho_);
  adjust(camera, record, frame, cameras, kFollowRounds, sigma_px);
  // The unit of length is that of a solution: the median depth.
  std::copy(rho_, rho_ + record.features(), best_rho_);
  std::nth_element(best_rho_, best_rho_ + record.features() / 2, best_rho_ + record.features());
  const Scalar median = best_rho_[record.features() / 2];
  if (!(median > kMinGoodRho)) return;
  for (int i = 0; i < record.features(); ++i) rho[i] = rho_[i] / median;
  for (int c = 0; c < cameras; ++c) {
    record.frame(frame[c]).q_WC = pose_[1 + c].q_WC;
    record.frame(frame[c]).p_W = pose_[1 + c].p_W * (depth * median);
  }
}

/// Pose of one frame with the depths held fixed, from the pose that is in it and from triples of the frame's pixels.
bool StartBundle::locate(const Camera& camera, const StartRecord& record, int frame, Scalar sigma_px,
                         BundlePose* pose) {
  PnpPoint points[StartRecord::kMaxFeatures];
  unsigned char inliers[StartRecord::kMaxFeatures];
  int count = 0;
  for (int i = 0; i < record.features(); ++i)
    if (record.seen(frame, i)) points[count++] = {record.ray(i), rho_[i], record.pixel(frame, i)};
  PoseEstimate estimate;
  estimate.q_WC = pose->q_WC;
  estimate.p_WC = pose->p_W;
  const PnpSearch search = {kMaxGoodResidual * sigma_px, kPoseTrials, kMinPoseInliers, {sigma_px, kHuber, kPoseRounds}};
  if (find_pose(camera, points, count, search, &random_, &estimate, inliers) == 0) return false;
  pose->q_WC = estimate.q_WC;
  pose->p_W = estimate.p_WC;
  return true;
}

}  // namespace pf
