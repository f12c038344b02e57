#pragma once

#include "bundle/bundle_adjuster.h"
#include "bundle/start_record.h"

/// The first depths, when nothing is known beforehand: a bundle adjustment over the first frames, from several first
/// guesses (lib/docs/theory/starting.md).
///
/// Before the camera has moved, a filter cannot estimate depth: at a baseline of zero the derivative of a pixel by
/// depth is zero, and the inverted scene fits equally well at first. So the pixels of the first frames are recorded
/// until there is enough parallax, and then adjusted together.

namespace pf {

class Archive;

enum class StartOutcome {
  kWait,     ///< not enough parallax (more than last time), or more than one solution
  kSolved,   ///< solved; more frames may improve it
  kSettled,  ///< solved, with enough parallax to stop
  kTooFew,   ///< too few of frame 0's features are left: start again
  kStill,    ///< the camera is where it was in frame 0, and something moves before it
};

/// Poses of the record's frames and inverse depths of its features.
class StartBundle {
 public:
  /// lens_rows: of the lens that a start may adjust with its depths; 0: it is exact.
  bool layout(Arena& arena, int lens_rows = 0);
  void init();
  /// The lens is uncertain, and is adjusted with all cameras of a solution; until the next init. Where the readout alone is, a solution is
  /// adjusted once more with it, by the velocities of the solution's cameras, and the record's rays and pixels are those of their frames'
  /// times by the new one. now: the camera by whose readout they are so to begin with.
  void free_lens(const Camera& calibration, const LensPrior& prior, const Camera& now);
  /// Variance of its readout after the last solution [s²]; where that has none, of the prior.
  Scalar readout_variance() const { return lens_->readout_variance; }
  /// That of the last solution, and of the record's rays; null where it is exact.
  const Camera* lens() const { return is_free_ ? &lens_->camera : nullptr; }

  /// On kSolved and kSettled the record's frames hold the poses (W is frame 0's camera), rho() the inverse depths and
  /// good() the features whose depths can be used. The first solution sets the unit of length so that the median depth is `median_depth`;
  /// later ones keep it.
  StartOutcome solve(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar median_depth);

  /// Improves the last frame's pose while the depths are open: one adjustment with others spread over the record, from the poses that are
  /// in it and from these inverse depths (about one), under the prior that all are about one. Poses and depths are written back.
  /// depth: of an inverse depth of one.
  void follow(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar depth, Scalar* rho);

  /// Covariance of the camera's position in the record's last frame, about that of frame 0 and in its axes, from the residuals of its
  /// pixels after the best rotation: how far the camera may have moved for these. False where they do not constrain it.
  bool baseline_covariance(const Camera& camera, const StartRecord& record, Scalar sigma_px, Scalar median_depth,
                           Mat3* covariance) const;

  Scalar rho(int feature) const { return rho_[feature]; }
  bool good(int feature) const { return last_rho_[feature] > Scalar(0); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMaxCameras = 8;  ///< of the adjustment

  struct Lens {
    LensRows rows;
    Scalar information[kLensParameters * kLensParameters];  ///< of the prior
    Camera prior, camera;
    HostPixel pixel[StartRecord::kMaxFeatures];  ///< of frame 0
    BundleRates rates[1 + kMaxCameras];          ///< of each pose
    Scalar readout_variance;
  };

  Scalar fit_rotation(const Camera& camera, const StartRecord& record, int frame, Quat* q_WC) const;
  /// Frames of the record that are adjusted together, the last one first.
  struct Spread {
    int count;
    int frame[kMaxCameras];
  };

  static Spread spread_over(const StartRecord& record);
  StartOutcome solve_by(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar median_depth);
  void set_guess(int guess, const StartRecord& record, const Quat& q_last, Scalar length, Scalar median_depth);
  bool find_motion(const Camera& camera, const StartRecord& record, const Quat& q_last, Scalar parallax,
                   Scalar sigma_px, Scalar median_depth, BundlePose* motion);
  bool adjust_spread(const Camera& camera, StartRecord& record, const Spread& spread, Scalar sigma_px,
                     const BundlePose& motion);
  int list_good(const Camera& camera, const StartRecord& record, const Spread& spread, Scalar sigma_px,
                bool* is_good) const;
  Scalar unit_of_length(const bool* is_good, int count, Scalar median_depth) const;
  bool place_frames(const Camera& camera, StartRecord& record, const Spread& spread, Scalar sigma_px, Scalar unit);
  Scalar adjust(const Camera& camera, const StartRecord& record, const int* frame, int cameras, int rounds,
                Scalar sigma_px, const BundleLens* lens = nullptr, Scalar* lens_covariance = nullptr);
  Scalar adjust_with_lens(StartRecord& record, const int* frame, int cameras, Scalar sigma_px);
  bool adjusts_shape() const { return is_free_ && lens_->rows.shape_count() > 0; }
  bool find_readout(StartRecord& record, Scalar sigma_px, Scalar median_depth);
  void set_lens(const Camera& camera, StartRecord& record);
  bool locate(const Camera& camera, const StartRecord& record, int frame, Scalar sigma_px, BundlePose* pose);

  BundleAdjuster adjuster_;
  BundlePose pose_[1 + kMaxCameras];  ///< frame 0, which is fixed and hosts every feature, and the cameras
  Scalar* rho_ = nullptr;             ///< kMaxFeatures each
  Scalar* best_rho_ = nullptr;
  Scalar* last_rho_ = nullptr;  ///< of the last solution, zero where it had none
  Scalar last_parallax_ = 0;    ///< [px]
  std::uint32_t random_ = 0;    ///< of the search for poses
  Lens* lens_ = nullptr;        ///< null: no lens is ever adjusted
  bool is_free_ = false;
};

}  // namespace pf
