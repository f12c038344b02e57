#pragma once

#include "base/arena.h"
#include "bundle/adjust.h"
#include "geometry/camera.h"

/// The first depths, when nothing is known beforehand: a bundle adjustment over the first frames, from several first
/// guesses (lib/docs/starting.md).
///
/// Before the camera has moved, a filter cannot estimate depth: at a baseline of zero the derivative of a pixel by
/// depth is zero, and the inverted scene fits equally well at first. So the pixels of the first frames are recorded
/// until there is enough parallax, and then adjusted together.

namespace pf {

/// Pixels of up to kMaxFeatures features, all first seen in frame 0, over up to kMaxFrames frames. When full, every
/// second frame is dropped, so that a resting camera does not fill it.
class StartRecord {
 public:
  static constexpr int kMaxFrames = 32;
  static constexpr int kMaxFeatures = 64;

  struct Frame {
    std::int64_t t_ns;
    Quat q_WC;  ///< W is frame 0's camera
    Vec3 p_W;
  };

  bool layout(Arena& arena);
  void init();

  /// Feature of frame 0, by the ray on which it was first seen; its index, or -1 when there are kMaxFeatures.
  int add_feature(const Vec3& ray);
  void set_ray(int feature, const Vec3& ray) { ray_[feature] = ray; }
  /// Adds a later frame with its estimated pose; add_pixel adds its pixels. Returns its index.
  int add_frame(std::int64_t t_ns, const Quat& q_WC, const Vec3& p_W);
  void add_pixel(int frame, int feature, const Vec2& pixel);

  int frames() const { return frames_; }
  int features() const { return features_; }
  Frame& frame(int k) { return frame_[k]; }
  const Frame& frame(int k) const { return frame_[k]; }
  const Vec3& ray(int i) const { return ray_[i]; }
  const Vec3* rays() const { return ray_; }
  Vec3* rays() { return ray_; }
  const BundlePixel* pixels(int k) const { return pixel_ + k * kMaxFeatures; }  ///< by feature
  bool seen(int k, int i) const { return pixels(k)[i].seen; }
  Vec2 pixel(int k, int i) const { return pixels(k)[i].pixel(); }

 private:
  Frame* frame_ = nullptr;  ///< frame 0 itself is not stored: its pose is the identity
  Vec3* ray_ = nullptr;
  BundlePixel* pixel_ = nullptr;
  int frames_ = 0;
  int features_ = 0;
};

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
  /// The lens is uncertain, and is adjusted with all cameras of a solution; until the next init.
  void free_lens(const Camera& calibration, const LensPrior& prior);
  /// That of the last solution, and of the record's rays; null where it is exact.
  const Camera* lens() const { return is_free_ ? &lens_->camera : nullptr; }

  /// On kSolved and kSettled the record's frames hold the poses (W is frame 0's camera), rho() the inverse depths and
  /// good() which features can be trusted. The first solution sets the unit of length so that the median depth is
  /// `median_depth`; later ones keep it.
  StartOutcome solve(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar median_depth);

  /// Improves the last frame's pose while the depths are open: one adjustment with others spread over the record, from the poses that are
  /// in it and from these inverse depths (about one), under the prior that all are about one. Poses and depths are written back.
  /// depth: of an inverse depth of one.
  void follow(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar depth, Scalar* rho);

  /// Covariance of the camera's place in the record's last frame, about that of frame 0 and in its axes, as what a rotation leaves of its
  /// pixels tells it: how far the camera may have moved for that. False where it tells nothing.
  bool baseline_covariance(const Camera& camera, const StartRecord& record, Scalar sigma_px, Scalar median_depth,
                           Mat3* covariance) const;

  Scalar rho(int feature) const { return rho_[feature]; }
  bool good(int feature) const { return last_rho_[feature] > Scalar(0); }

 private:
  static constexpr int kMaxCameras = 8;  ///< of the adjustment

  struct Lens {
    LensRows rows;
    Scalar information[kLensParameters * kLensParameters];  ///< of the prior
    Camera prior, camera;
    HostPixel pixel[StartRecord::kMaxFeatures];  ///< of frame 0
  };

  Scalar fit_rotation(const Camera& camera, const StartRecord& record, int frame, Quat* q_WC) const;
  StartOutcome solve_by(const Camera& camera, StartRecord& record, Scalar sigma_px, Scalar median_depth);
  Scalar adjust(const Camera& camera, const StartRecord& record, const int* frame, int cameras, int rounds,
                Scalar sigma_px, const BundleLens* lens = nullptr);
  Scalar adjust_with_lens(StartRecord& record, const int* frame, int cameras, Scalar sigma_px);
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
