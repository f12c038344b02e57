#pragma once

#include <cstdint>
#include <vector>

#include "planefold/planefold.h"
#include "sim/random.h"

namespace pfsim {

/// Makes some homographies gross: what surrounds a patch is moved in the image by more than noise and by less than the aligner reaches, so
/// that it is found, at a wrong place.
class GrossPatches {
 public:
  /// share: of the patches that were inliers in the frame before.
  GrossPatches(double share, std::uint64_t seed);

  /// The image with patches moved; valid until the next call. An image of 8 bits.
  pf_image_t spoil(const pf_slam_t* slam, const pf_image_t& image);

 private:
  void move(const pf_patch_t& patch, const pf_image_t& image);

  double share_;
  pf::sim::Random random_;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace pfsim
