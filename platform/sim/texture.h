#pragma once

#include <cstdint>
#include <vector>

#include "sim/four.h"
#include "sim/random.h"

namespace pf::sim {

/// Grey levels that a painter works on; texel (i, j) covers [i, i+1) x [j, j+1) times the texel's size.
struct Canvas {
  Canvas(double width_m, double height_m, double texel_size_m, float fill);

  float& at(int i, int j) {
    return grey[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
  }

  int width, height;
  double texel_m;  // [m]
  std::vector<float> grey;
};

/// A canvas frozen into a pyramid of levels, each the 2x2 mean of the one below.
///
/// Interpolation inside a level is bilinear and between levels linear. Both reproduce linear functions exactly, and 2x2
/// means keep centres where they are, so no footprint shifts the picture.
class Texture {
 public:
  explicit Texture(const Canvas& canvas);

  /// Grey level at (u, v) [m] as seen through a window of the given width [m].
  float sample(float u_m, float v_m, float footprint_m) const;

  /// The same of four places at once, to the bit.
  Four sample(Four u_m, Four v_m, Four footprint_m) const;

 private:
  struct Level {
    int width, height;
    std::vector<std::uint8_t> grey;
  };

  static float bilinear(const Level& level, float x, float y);
  static Four bilinear(const Level& level, Four x, Four y);

  std::vector<Level> levels_;
  float texels_per_m_;
};

/// Value noise: lattices of random grey levels, cubic-smoothed in between, from `coarse_m` down by halves.
void paint_noise(Canvas& canvas, Random& random, double amplitude, double coarse_m, int octaves, double persistence);

/// Rectangles at random angles, with sharp corners.
void paint_rectangles(Canvas& canvas, Random& random, int count, double smallest_m, double largest_m, double contrast,
                      bool upright);

/// Ellipses with a rim.
void paint_blobs(Canvas& canvas, Random& random, int count, double smallest_m, double largest_m, double contrast);

/// An upright rectangle of one grey level; texels on its border by the share that is covered, so that its edges lie
/// where they should to a small fraction of a texel.
void paint_box(Canvas& canvas, double u0_m, double v0_m, double u1_m, double v1_m, double grey);

/// Lines of small dark marks, like print on paper.
void paint_print(Canvas& canvas, Random& random, double u0_m, double v0_m, double u1_m, double v1_m, double line_m);

/// Squares of two grey levels, with a corner at the canvas origin.
void paint_checker(Canvas& canvas, double square_m, double dark, double bright);

/// Repeat the top left cell all over.
void paint_repeat(Canvas& canvas, double cell_m);

}  // namespace pf::sim
