#pragma once

#include <cstdint>

#include "vision/patch.h"

namespace pf {

/// What is learnt of which pixels a template's surface fills. With the numbers of pf_masks_t.
enum class MaskMode : std::uint8_t { kNone = 0, kPartial = 1, kWhole = 2 };

/// Template of a surface that fills only a part of it: what is known beside the pixels of first sight (SourcePatch) and the mask, which
/// lies in a table of its own. A plain copy: no pointers.
///
/// Inverse depth over the template, in the camera of first sight:  rho(ray) = rho_0 (1 + slope . (ray - ray_0)), rays at depth 1, ray_0
/// that of its middle. n_K ~ (slope, 1 - slope . ray_0).
struct PlanarTemplate {
  static constexpr int kMinSide = 9, kMaxSide = 31, kDefaultSide = 15;

  std::int16_t left = 0, top = 0;  ///< first pixel, in the image of first sight
  std::uint8_t side = 0;           ///< [px], odd; 0: there is none
  bool has_normal = false;         ///< the slopes were measured
  std::int16_t frames = 0;         ///< that the mask has learnt from
  float sigma_plane = 0;           ///< of residuals on the dominant plane [grey levels]
  float sigma_other = 0;           ///< the same off it
  float area = 0;                  ///< sum of the mask [px]
  float slope[2] = {0, 0};
  float covariance[3] = {0, 0, 0};  ///< of the slopes: xx, xy, yy
};
static_assert(sizeof(PlanarTemplate) + PlanarTemplate::kDefaultSide * PlanarTemplate::kDefaultSide <= 512);

}  // namespace pf
