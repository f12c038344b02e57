#include "bundle/start_bundle.h"

#include <algorithm>
#include <cmath>

#include "bundle/rotation_fit.h"
#include "bundle/row_column.h"
#include "bundle/tuning.h"
#include "geometry/pnp.h"
#include "geometry/small_cholesky.h"

namespace pf {
namespace {

using namespace tuning::start;

constexpr int kDirections = 6;                 // there and back along each axis
constexpr Scalar kBehindCamera = Scalar(1e6);  ///< [px^2] error of what does not project: larger than any other

/// Features that the last frame still sees.
int num_left(const StartRecord& record) {
  int left = 0;
  for (int i = 0; i < record.features(); ++i) left += record.seen(record.frames() - 1, i) ? 1 : 0;
  return left;
}

/// Pixels at their frames' times by another readout, from that of the camera. depth_rho: 0 where there is none. Frame 0 has rays.
void move_readout(const Camera& camera, Scalar readout, const Scalar* depth_rho, StartRecord& record) {
  for (int k = 0; k < record.frames(); ++k) {
    const StartRecord::Frame& frame = record.frame(k);
    const Mat3 R_CW = frame.q_WC.toRotationMatrix().transpose();
    const ViewOfRows view = {R_CW, record.rates(k), camera.readout};
    for (int i = 0; i < record.features(); ++i) {
      if (!record.seen(k, i) || !(depth_rho[i] > Scalar(0))) continue;
      const Scalar far = (record.ray(i) / depth_rho[i] - frame.p_W).norm();
      const Vec2 pixel = record.pixel(k, i);
      record.add_pixel(k, i, pixel - (readout - camera.readout) * readout_column(camera, view, pixel, 1 / far));
    }
  }
}

}  // namespace

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

void StartBundle::free_lens(const Camera& calibration, const LensPrior& prior, const Camera& now) {
  if (lens_ == nullptr) return;
  is_free_ = true;
  lens_->rows = prior.rows;
  lens_->prior = calibration;
  lens_->camera = now;
  lens_->readout_variance = prior.rows.has_readout() ? prior.variance[prior.rows.count - 1] : Scalar(0);
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
                           Scalar sigma_px, const BundleLens* lens, Scalar* lens_covariance) {
  pose_[0] = {Quat::Identity(), Vec3::Zero(), false, nullptr};
  for (int c = 0; c < cameras; ++c) {
    pose_[1 + c].free = true;
    pose_[1 + c].pixel = record.pixels(frame[c]);
  }
  const AdjustOptions options = {sigma_px, kHuber, Scalar(1), kPriorSigma, kBehindWeight, kNoPixelPenalty, rounds};
  Bundle bundle = {pose_, 1 + cameras, record.rays(), nullptr, rho_, record.features()};
  bundle.lens = lens;
  const Scalar cost = adjuster_.adjust(camera, options, bundle);
  if (lens_covariance != nullptr && adjuster_.begin_covariances(camera, options, bundle))
    adjuster_.lens_covariance(lens_covariance);
  return cost;
}

/// The same for all cameras, with the lens. The effect of a wrong lens on the depths would otherwise be left to the filter, which cannot
/// undo it in full: its linearisation differs from the adjustment's.
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
  if (!adjusts_shape()) {
    const bool solved = outcome == StartOutcome::kSolved || outcome == StartOutcome::kSettled;
    return solved && !find_readout(record, sigma_px, median_depth) ? StartOutcome::kWait : outcome;
  }
  if (outcome != StartOutcome::kSolved && outcome != StartOutcome::kSettled) set_lens(before, record);
  return outcome;
}

/// Of a solution that has been found by the readout as it was. False, with the record and the readout as they were but for its poses, where
/// there is none by another one.
bool StartBundle::find_readout(StartRecord& record, Scalar sigma_px, Scalar median_depth) {
  const Camera before = lens_->camera;
  const Spread spread = spread_over(record);
  const int count = record.features();
  lens_->rates[0] = record.rates(-1);
  for (int c = 0; c < spread.count; ++c) {
    const StartRecord::Frame& frame = record.frame(spread.frame[c]);
    pose_[1 + c].q_WC = frame.q_WC;
    pose_[1 + c].p_W = frame.p_W / median_depth;
    lens_->rates[1 + c] = record.rates(spread.frame[c]);
  }
  for (int c = 0; c < 1 + spread.count; ++c) lens_->rates[c].v_W /= median_depth;
  for (int i = 0; i < count; ++i) rho_[i] *= median_depth;
  const BundleLens lens = {lens_->rows,  lens_->information, lens_->prior, &lens_->camera,
                           lens_->pixel, record.rays(),      lens_->rates, before.readout};
  Scalar variance = -1;
  adjust(lens_->camera, record, spread.frame, spread.count, kRounds, sigma_px, &lens, &variance);
  const Scalar found = lens_->camera.readout;
  bool is_good[StartRecord::kMaxFeatures] = {};
  move_readout(before, found, last_rho_, record);
  bool solved = variance > Scalar(0) && list_good(lens_->camera, record, spread, sigma_px, is_good) >= kMinFeatures;
  const Scalar unit = solved ? unit_of_length(is_good, count, median_depth) : 1 / median_depth;
  solved = solved && place_frames(lens_->camera, record, spread, sigma_px, unit);
  for (int i = 0; i < count; ++i) rho_[i] *= unit;
  if (solved) {
    for (int i = 0; i < count; ++i) last_rho_[i] = is_good[i] ? rho_[i] : Scalar(0);
    lens_->readout_variance = kLensInflation * variance;
  } else {
    move_readout(lens_->camera, before.readout, last_rho_, record);
    set_lens(before, record);
  }
  return solved;
}

/// camera: where the lens is adjusted, that which is.
StartOutcome StartBundle::solve_by(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar median_depth) {
  const int last = record.frames() - 1, count = record.features();
  if (last < 0) return StartOutcome::kWait;
  if (num_left(record) < kMinFeatures) return StartOutcome::kTooFew;

  Quat q_last = record.frame(last).q_WC;
  const Scalar parallax = fit_rotation(camera, record, last, &q_last);
  if (!(parallax >= kMinParallax * sigma_px && parallax >= kGrowth * last_parallax_)) return StartOutcome::kWait;
  BundlePose motion;
  if (!find_motion(camera, record, q_last, parallax, sigma_px, median_depth, &motion)) return StartOutcome::kWait;
  const Spread spread = spread_over(record);
  if (!adjust_spread(camera, record, spread, sigma_px, motion)) return StartOutcome::kWait;

  bool is_good[StartRecord::kMaxFeatures] = {};
  if (list_good(camera, record, spread, sigma_px, is_good) < kMinFeatures) return StartOutcome::kWait;
  const Scalar unit = unit_of_length(is_good, count, median_depth);
  if (!place_frames(camera, record, spread, sigma_px, unit)) return StartOutcome::kWait;
  for (int i = 0; i < count; ++i) {
    rho_[i] *= unit;
    last_rho_[i] = is_good[i] ? rho_[i] : Scalar(0);
  }
  last_parallax_ = parallax;
  return parallax > kSettledParallax * sigma_px ? StartOutcome::kSettled : StartOutcome::kSolved;
}

/// The motion of the last frame, and all rho, from which an adjustment begins. length: of a motion at a depth of one.
void StartBundle::set_guess(int guess, const StartRecord& record, const Quat& q_last, Scalar length,
                            Scalar median_depth) {
  const int last = record.frames() - 1, count = record.features();
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
}

/// Adjusts frame 0 and the last frame from six directions of motion, with the rotation that explains most by itself; the parallax gives the
/// distance at a depth of one. A camera that looks at one place while it moves about it has a rotation that none of them comes near, so the
/// last solution, where there is one, is the seventh. The best motion, with its rho in best_rho_. False where two solutions fit about
/// equally well (a scene and its inverted twin): wait for parallax up to kAmpleParallax.
bool StartBundle::find_motion(const Camera& camera, const StartRecord& record, const Quat& q_last, Scalar parallax,
                              Scalar sigma_px, Scalar median_depth, BundlePose* motion) {
  const int last = record.frames() - 1;
  const Scalar length = parallax / camera.fx;
  const int guesses = kDirections + (last_parallax_ > Scalar(0) ? 1 : 0);
  *motion = {Quat::Identity(), Vec3::Zero(), true, nullptr};
  Scalar best = -1, second = -1;
  for (int guess = 0; guess < guesses; ++guess) {
    set_guess(guess, record, q_last, length, median_depth);
    const Scalar c = adjust(camera, record, &last, 1, kGuessRounds, sigma_px);
    if (best >= Scalar(0)) {
      const Scalar cosine = pose_[1].p_W.dot(motion->p_W) / (pose_[1].p_W.norm() * motion->p_W.norm());
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
    *motion = pose_[1];
    std::copy(rho_, rho_ + record.features(), best_rho_);
  }
  return !(second >= Scalar(0) && second - best < kMinMargin && parallax < kAmpleParallax * sigma_px);
}

StartBundle::Spread StartBundle::spread_over(const StartRecord& record) {
  const int last = record.frames() - 1;
  Spread spread = {std::min(static_cast<int>(kMaxCameras), record.frames()), {}};
  for (int c = 0; c < spread.count; ++c) spread.frame[c] = last - c * (last + 1) / spread.count;
  return spread;
}

/// Adjusts the last frame together with others. False where one cannot be located, or where the solution does not fit: a pixel has two
/// numbers, so noise alone leaves a cost of 2; at three times that the solution is rejected.
bool StartBundle::adjust_spread(const Camera& camera, StartRecord& record, const Spread& spread, Scalar sigma_px,
                                const BundlePose& motion) {
  const int last = record.frames() - 1, count = record.features();
  const int* frame = spread.frame;
  std::copy(best_rho_, best_rho_ + count, rho_);
  pose_[1] = motion;
  for (int c = 1; c < spread.count; ++c) {
    pose_[1 + c].q_WC = record.frame(frame[c]).q_WC;
    fit_rotation(camera, record, frame[c], &pose_[1 + c].q_WC);
    pose_[1 + c].p_W = motion.p_W * (static_cast<Scalar>(frame[c] + 1) / static_cast<Scalar>(last + 1));
    if (!locate(camera, record, frame[c], sigma_px, &pose_[1 + c])) return false;
  }
  const Scalar total = adjusts_shape() ? adjust_with_lens(record, frame, spread.count, sigma_px)
                                       : adjust(camera, record, frame, spread.count, kRounds, sigma_px);
  int pixels = 0;
  for (int c = 0; c < spread.count; ++c)
    for (int i = 0; i < count; ++i) pixels += record.seen(frame[c], i) ? 1 : 0;
  return total <= kMaxCost * static_cast<Scalar>(pixels);
}

/// Lists the depths that are good enough to use. Returns how many.
int StartBundle::list_good(const Camera& camera, const StartRecord& record, const Spread& spread, Scalar sigma_px,
                           bool* is_good) const {
  int good = 0;
  for (int i = 0; i < record.features(); ++i) {
    if (!record.seen(record.frames() - 1, i) || !(rho_[i] > kMinGoodRho)) continue;
    Scalar worst = 0;
    for (int c = 0; c < spread.count; ++c) {
      if (!record.seen(spread.frame[c], i)) continue;
      Vec2 z;
      const BundlePose& pose = pose_[1 + c];
      if (!project_bearing(camera, pose.q_WC.toRotationMatrix(), record.ray(i), -pose.p_W, rho_[i], &z))
        worst = kBehindCamera;
      else
        worst = std::max(worst, (record.pixel(spread.frame[c], i) - z).squaredNorm());
    }
    is_good[i] = !(worst > kMaxGoodResidual * kMaxGoodResidual * sigma_px * sigma_px);
    good += is_good[i] ? 1 : 0;
  }
  return good;
}

/// Divisor of all lengths: keeps the lengths of the last solution where both have enough depths, else makes the median depth
/// `median_depth`.
Scalar StartBundle::unit_of_length(const bool* is_good, int count, Scalar median_depth) const {
  Scalar sorted[StartRecord::kMaxFeatures];
  int good = 0, common = 0;
  for (int i = 0; i < count; ++i)
    if (is_good[i] && last_rho_[i] > Scalar(0)) sorted[common++] = last_rho_[i] / rho_[i];
  if (common >= kMinFeatures) {
    std::nth_element(sorted, sorted + common / 2, sorted + common);
    return sorted[common / 2];
  }
  for (int i = 0; i < count; ++i)
    if (is_good[i]) sorted[good++] = rho_[i];
  std::nth_element(sorted, sorted + good / 2, sorted + good);
  return Scalar(1) / (sorted[good / 2] * median_depth);
}

/// Gives all frames of the record their poses: those that were adjusted, the others by the depths from the nearest one. False where one
/// cannot be located.
bool StartBundle::place_frames(const Camera& camera, StartRecord& record, const Spread& spread, Scalar sigma_px,
                               Scalar unit) {
  const int* frame = spread.frame;
  for (int k = 0; k < record.frames(); ++k) {
    int nearest = 0;
    for (int c = 1; c < spread.count; ++c)
      if (std::abs(frame[c] - k) < std::abs(frame[nearest] - k)) nearest = c;
    BundlePose pose = pose_[1 + nearest];
    if (frame[nearest] != k && !locate(camera, record, k, sigma_px, &pose)) return false;
    record.frame(k).q_WC = pose.q_WC;
    record.frame(k).p_W = pose.p_W / unit;
  }
  return true;
}

bool StartBundle::baseline_covariance(const Camera& calibration, const StartRecord& record, Scalar sigma_px,
                                      Scalar median_depth, Mat3* covariance) const {
  const Camera& camera = is_free_ ? lens_->camera : calibration;
  const int last = record.frames() - 1;
  if (last < 0) return false;
  if (num_left(record) < kMinFeatures) return false;
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
  const Spread spread = spread_over(record);
  const int cameras = spread.count;
  const int* frame = spread.frame;
  for (int c = 0; c < cameras; ++c) {
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
