#pragma once

#include "base/eigen.h"
#include "vision/image.h"

namespace pf {

/// 8x8 template of the search (lib/docs/theory/matching.md); offset (0, 0) is entry (4, 4): rows and columns -4 .. 3 about the feature.
struct SearchTemplate {
  static constexpr int kSize = 8;
  static constexpr int kBefore = 4;
  static constexpr int kAfter = 3;

  alignas(16) std::uint8_t pixels[kSize * kSize];
  int sum = 0;     // of the pixels
  int energy = 0;  // 64 Σt² - (Σt)²
};

/// The middle of a template of odd side >= 9 from warp_template, rounded to grey levels.
void make_search_template(const float* warped, int size, SearchTemplate* out);

/// Where to look: the x with (x - centre)ᵀ inverse_covariance (x - centre) <= gate, in px of the level that is searched.
struct SearchEllipse {
  Vec2 centre = Vec2::Zero();
  Mat2 inverse_covariance = Mat2::Identity();
  Scalar gate = 0;
};

struct SearchResult {
  Vec2 position = Vec2::Zero();  // whole pixels
  float score = -1;              // zero-mean normalised cross-correlation there, -1 .. 1
  float second = -1;             // highest of the other peaks further than kSearchApart away; -1: there is none
  int visited = 0;               // positions; 0: nothing was found
};

constexpr int kSearchReach = 31;      // the ellipse is cut at so many px on each side of its centre
constexpr float kSearchApart = 2.5f;  // px

/// Zero-mean normalised cross-correlation at every whole pixel of the ellipse where the template lies in the image:
///
///   (64 Σit - Σi Σt) / √((64 Σi² - (Σi)²) (64 Σt² - (Σt)²))          0 where the window has no contrast
///
/// Of equal scores the first in reading order is taken. An ellipse that no pixel lies in is searched at its centre's own
/// pixel. Nothing is visited when a number is not finite or the covariance is not positive definite.
/// Time is proportional to the positions; 10 kB of stack.
SearchResult search(const ImageView& image, const SearchTemplate& pattern, const SearchEllipse& ellipse);

/// The score at one place by the formula, for templates that lie in the image: the plain twin of what search() computes.
float correlation_reference(const ImageView& image, const SearchTemplate& pattern, int x, int y);

}  // namespace pf
