#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/linear.h"
#include "sim/random.h"
#include "sim/texture.h"

/// Frames that show one textured plane under homographies that are known exactly.

namespace bench {

enum class PatchTrouble { kNone, kOcclusion, kLight };

using Homography = std::array<double, 9>;  ///< row by row, pixels of the first frame to pixels of this one

/// (x, y) under H.
std::array<double, 2> map_pixel(const Homography& H, double x, double y);

struct HomographyOptions {
  int width = 640, height = 480;
  double focal = 500;
  int side = 100;  ///< of the patch, in the middle of the first frame [px]
  int frames = 200;
  double step_low = 2, step_high = 6;  ///< mean motion of the corners from frame to frame [px]
  double noise_grey = 2;
  double hidden = 0.3;  ///< share of the patch with kOcclusion
};

/// Frames in order with a square patch of the first one, and where it is.
class PatchFrames {
 public:
  virtual ~PatchFrames() = default;
  virtual int left() const = 0;
  virtual int top() const = 0;
  virtual const Homography& truth(int frame) const = 0;
  /// Pixels, width * height; frames in order.
  virtual const std::vector<std::uint8_t>& draw(int frame) = 0;
};

/// One sequence, drawn from one seed. Every trouble has the same plane, motion and noise.
class HomographyFrames : public PatchFrames {
 public:
  HomographyFrames(const HomographyOptions& options, PatchTrouble trouble, std::uint64_t seed);

  int left() const override { return (options_.width - options_.side) / 2; }
  int top() const override { return (options_.height - options_.side) / 2; }
  const Homography& truth(int frame) const override { return truth_[static_cast<std::size_t>(frame)]; }
  /// Only the patch and its surroundings are drawn.
  const std::vector<std::uint8_t>& draw(int frame) override;

 private:
  pf::sim::Pose pose(double s) const;
  Homography homography(double s) const;
  double grey_at(int frame, double x, double y, const Homography& inverse) const;

  HomographyOptions options_;
  PatchTrouble trouble_;
  pf::sim::Random noise_;
  std::unique_ptr<pf::sim::Texture> plane_, other_;
  std::array<double, 36> wave_{};  ///< rate and phase, of each of the six motions
  std::vector<Homography> truth_;
  std::vector<std::uint8_t> grey_;
};

}  // namespace bench
