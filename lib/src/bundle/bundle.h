#pragma once

#include <cstdint>

#include "bundle/tuning.h"
#include "geometry/lens.h"
#include "geometry/plane.h"

/// Data of a bundle adjustment: poses, points by their bearing and inverse depth in a host pose, planes on which some of the points lie,
/// and the lens that all poses share (lib/docs/theory/window.md, lib/docs/theory/starting.md).

namespace pf {

/// Pixel of a point in a pose.
struct BundlePixel {
  float x, y;  ///< [px]
  bool seen;
  std::uint8_t sigma_class = 0;  ///< index into AdjustOptions::class_sigma_px

  Vec2 pixel() const { return Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y)); }
};

struct BundlePose {
  Quat q_WC;
  Vec3 p_W;
  bool free;                 ///< false: not adjusted
  const BundlePixel* pixel;  ///< by point; null: this pose is a host only
};

/// A plane (geometry/plane.h): three numbers about a constant frame, which should lie near it.
struct BundlePlane {
  PlaneFrame frame;
  Vec3 x;            ///< (a, b, h)
  Scalar roughness;  ///< standard deviation of its points' distances from it [m]
  bool free;         ///< false: not adjusted
};

/// Prior of an inverse depth.
struct RhoPrior {
  Scalar mean;
  Scalar sigma;  ///< not above zero: nothing is known
};

/// Pixel of a point in its host, which gives its bearing; not given: the bearing does not depend on the lens.
struct HostPixel {
  Vec2 pixel;
  bool given;
};

/// Velocities of a camera at its frame's time, with which its rows were read out.
struct BundleRates {
  Vec3 v_W, w_C;
};

/// Parameters of the lens that are adjusted, about a prior. Where the readout is one of them, pixels are those of the frame's time by the
/// readout that the camera begins with; by another one they are
///
///   z(readout) = z - (readout - readout_before) s dz/dt,   s: the row's part of the readout, -1/2 .. 1/2
struct BundleLens {
  LensRows rows;
  const Scalar* prior_information;     ///< rows x rows, row-major
  Camera prior;                        ///< its mean
  Camera* camera;                      ///< adjusted, in place of the camera that the calls below get
  const HostPixel* host_pixel;         ///< of each point
  Vec3* ray;                           ///< the bundle's; becomes the unit ray of the host's pixel where one is given
  const BundleRates* rates = nullptr;  ///< of each pose; null: the readout is not adjusted
  Scalar readout_before = 0;           ///< by which the pixels are at their frames' times
};

/// The distance of a free pose from a place. It holds the scale where no two fixed poses do; pixels are blind to it.
///
///   e = (|p - from| - distance) / sigma,   de/dp = uᵀ / sigma,  u = (p - from) / |p - from|
struct BundleDistance {
  int pose;
  Vec3 from_W;
  Scalar distance, sigma;
};

/// What is adjusted; a view of the caller's arrays. Something must hold position, rotation and scale: fixed poses, a
/// distance, or the prior on the inverse depths.
struct Bundle {
  BundlePose* pose;
  int poses;
  const Vec3* ray;  ///< of each point in its host pose; any length, which is the unit of 1 / rho
  const int*
      host;  ///< pose of each point; null: pose 0 for all. Pixels of a point in its own host have no information and are skipped
  Scalar* rho;
  int points;
  const RhoPrior* prior = nullptr;  ///< of each point; null: the options' for all
  BundlePlane* plane = nullptr;
  int planes = 0;
  const int* plane_of = nullptr;  ///< plane of each point, -1 where it has none; null: of no point
  const Scalar* rho_before =
      nullptr;  ///< of each point, for relative_plane_distance; null: a plane's distances are lengths
  const BundleLens* lens = nullptr;      ///< null: the lens is exact
  const BundleDistance* held = nullptr;  ///< null: no distance is held
};

inline int host_of(const Bundle& bundle, int point) { return bundle.host == nullptr ? 0 : bundle.host[point]; }

struct AdjustOptions {
  Scalar sigma_px;          ///< [px] of every pixel
  Scalar huber;             ///< residuals beyond this count linearly [standard deviations]
  Scalar rho_mean;          ///< prior on every inverse depth
  Scalar rho_sigma;         ///< its standard deviation; not above zero: there is no prior
  Scalar behind_weight;     ///< information of the prior is (1 + this) times larger where rho < 0
  Scalar no_pixel_penalty;  ///< cost of a seen point that has no pixel, in squared standard deviations
  int max_rounds;
  Scalar small_gain = tuning::adjust::kSmallGain;  ///< a step that lowers the cost by less than this share is the last
  const Scalar* class_sigma_px = nullptr;          ///< by BundlePixel::sigma_class, in place of sigma_px; null: none
};

}  // namespace pf
