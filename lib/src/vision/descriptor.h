#pragma once

#include <cstdint>

#include "base/eigen.h"
#include "vision/image.h"
#include "vision/patch.h"

/// 256 bits that describe the surroundings of a point and hardly change when the image is rotated, lit otherwise or a little larger. They
/// recognise points of a map whose place in the image is not predicted.

namespace pf {

struct Descriptor {
  static constexpr int kWords = 4;
  std::uint64_t word[kWords] = {};
};

/// Distance of a pixel from the image's edge [px] that describe() needs.
constexpr int kDescriptorMargin = 13;

/// Describes the surroundings of a pixel:
///
///   bit i = [ M(c + R a_i) < M(c + R b_i) ],   M: means of 3x3 pixels
///
/// R        the rotation that takes the x axis to the centroid of the grey levels about c
/// a_i, b_i fixed pairs of places within 10 px
/// False, out untouched: nearer to the edge than kDescriptorMargin, or not finite. Costs about 10 us.
/// src      Calonder et al. 2010 (comparisons), Rosin 1999 (orientation by the centroid); the pairs are drawn here
bool describe(const ImageView& image, const Vec2& pixel, Descriptor* out);

/// Describes a feature as it was first seen, at half the resolution of its image. False: its surroundings were not all in the image.
bool describe(const SourcePatch& patch, Descriptor* out);

/// Bits that differ, 0 .. 256; 128 of two places that have nothing in common.
int distance(const Descriptor& a, const Descriptor& b);

}  // namespace pf
