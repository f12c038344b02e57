#include <algorithm>
#include <cmath>

#include "sim/texture.h"

namespace pf::sim {

Canvas::Canvas(double width_m, double height_m, double texel_size_m, float fill)
    : width(std::max(4, static_cast<int>(std::lround(width_m / texel_size_m)))),
      height(std::max(4, static_cast<int>(std::lround(height_m / texel_size_m)))),
      texel_m(texel_size_m),
      grey(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

void paint_noise(Canvas& canvas, Random& random, double amplitude, double coarse_m, int octaves, double persistence) {
  double cell = coarse_m / canvas.texel_m;
  // Where each column lies between its two lattice points is the same for all rows.
  std::vector<int> left(static_cast<std::size_t>(canvas.width));
  std::vector<float> share(left.size());
  for (int o = 0; o < octaves && cell >= 1.5; ++o, cell *= 0.5, amplitude *= persistence) {
    const int w = static_cast<int>(canvas.width / cell) + 2, h = static_cast<int>(canvas.height / cell) + 2;
    std::vector<float> lattice(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    for (float& v : lattice) v = static_cast<float>(random.uniform(-amplitude, amplitude));
    const auto smooth = [cell](int i, int* before) {
      const double x = i / cell;
      *before = static_cast<int>(x);
      const double f = x - *before;
      return static_cast<float>(f * f * (3 - 2 * f));
    };
    for (std::size_t i = 0; i < left.size(); ++i) share[i] = smooth(static_cast<int>(i), &left[i]);
    std::vector<float> row(static_cast<std::size_t>(w));
    for (int j = 0; j < canvas.height; ++j) {
      int above;
      const float b = smooth(j, &above);
      const float* top = &lattice[static_cast<std::size_t>(above) * static_cast<std::size_t>(w)];
      for (int k = 0; k < w; ++k) row[static_cast<std::size_t>(k)] = top[k] + b * (top[k + w] - top[k]);
      float* out = &canvas.at(0, j);
      for (std::size_t i = 0; i < left.size(); ++i) {
        const float* p = &row[static_cast<std::size_t>(left[i])];
        out[i] += p[0] + share[i] * (p[1] - p[0]);
      }
    }
  }
}

namespace {

/// Texels of the square of half side `reach` about (ci, cj), cut at the canvas.
struct Window {
  Window(const Canvas& canvas, double ci, double cj, double reach)
      : i0(std::max(0, static_cast<int>(ci - reach))),
        i1(std::min(canvas.width, static_cast<int>(ci + reach) + 2)),
        j0(std::max(0, static_cast<int>(cj - reach))),
        j1(std::min(canvas.height, static_cast<int>(cj + reach) + 2)) {}
  int i0, i1, j0, j1;
};

/// Sizes spread evenly over the octaves between the two.
double draw_size(Random& random, double smallest, double largest) {
  return smallest * std::pow(largest / smallest, random.uniform());
}

float draw_contrast(Random& random, double contrast) {
  const double c = random.uniform(0.4, 1.0) * contrast;
  return static_cast<float>(random.uniform() < 0.5 ? -c : c);
}

}  // namespace

void paint_rectangles(Canvas& canvas, Random& random, int count, double smallest_m, double largest_m, double contrast,
                      bool upright) {
  for (int k = 0; k < count; ++k) {
    const double a = 0.5 * draw_size(random, smallest_m, largest_m) / canvas.texel_m;
    const double b = a * random.uniform(0.4, 1.0);
    const double ci = random.uniform(0, canvas.width), cj = random.uniform(0, canvas.height);
    const double angle = upright ? 0.0 : random.uniform(0.0, 3.14159265);
    const double c = std::cos(angle), s = std::sin(angle);
    const float delta = draw_contrast(random, contrast);
    const Window window(canvas, ci, cj, a + b);
    for (int j = window.j0; j < window.j1; ++j)
      for (int i = window.i0; i < window.i1; ++i) {
        const double di = i + 0.5 - ci, dj = j + 0.5 - cj;
        if (std::fabs(c * di + s * dj) < a && std::fabs(c * dj - s * di) < b)
          canvas.at(i, j) = std::clamp(canvas.at(i, j) + delta, 10.0f, 245.0f);
      }
  }
}

void paint_blobs(Canvas& canvas, Random& random, int count, double smallest_m, double largest_m, double contrast) {
  for (int k = 0; k < count; ++k) {
    const double a = 0.5 * draw_size(random, smallest_m, largest_m) / canvas.texel_m;
    const double b = a * random.uniform(0.4, 1.0);
    const double ci = random.uniform(0, canvas.width), cj = random.uniform(0, canvas.height);
    const double angle = random.uniform(0.0, 3.14159265), c = std::cos(angle), s = std::sin(angle);
    const float inner = draw_contrast(random, contrast), rim = draw_contrast(random, contrast);
    const Window window(canvas, ci, cj, a);
    for (int j = window.j0; j < window.j1; ++j)
      for (int i = window.i0; i < window.i1; ++i) {
        const double di = i + 0.5 - ci, dj = j + 0.5 - cj;
        const double x = (c * di + s * dj) / a, y = (c * dj - s * di) / b, r = x * x + y * y;
        if (r < 1) canvas.at(i, j) = std::clamp(canvas.at(i, j) + (r < 0.6 ? inner : rim), 10.0f, 245.0f);
      }
  }
}

void paint_box(Canvas& canvas, double u0_m, double v0_m, double u1_m, double v1_m, double grey) {
  const double x0 = u0_m / canvas.texel_m, x1 = u1_m / canvas.texel_m;
  const double y0 = v0_m / canvas.texel_m, y1 = v1_m / canvas.texel_m;
  const int i1 = std::min(canvas.width, static_cast<int>(std::ceil(x1)));
  const int j1 = std::min(canvas.height, static_cast<int>(std::ceil(y1)));
  for (int j = std::max(0, static_cast<int>(y0)); j < j1; ++j)
    for (int i = std::max(0, static_cast<int>(x0)); i < i1; ++i) {
      const double cover = std::max(0.0, std::min(x1, i + 1.0) - std::max(x0, i + 0.0)) *
                           std::max(0.0, std::min(y1, j + 1.0) - std::max(y0, j + 0.0));
      float& g = canvas.at(i, j);
      g += static_cast<float>(cover) * (static_cast<float>(grey) - g);
    }
}

void paint_print(Canvas& canvas, Random& random, double u0_m, double v0_m, double u1_m, double v1_m, double line_m) {
  for (double v = v0_m + line_m; v + line_m < v1_m; v += 1.8 * line_m) {
    double u = u0_m + line_m * random.uniform(0.5, 3.0);
    while (u < u1_m - 2 * line_m) {
      const double w = line_m * random.uniform(0.3, 2.5), h = line_m * random.uniform(0.5, 1.0);
      const double end = std::min(u + w, u1_m - line_m);
      paint_box(canvas, u, v + line_m - h, end, v + line_m, random.uniform(20, 90));
      u += w + line_m * random.uniform(0.2, 0.9);
    }
  }
}

void paint_checker(Canvas& canvas, double square_m, double dark, double bright) {
  for (int b = 0; b * square_m < canvas.height * canvas.texel_m; ++b)
    for (int a = 0; a * square_m < canvas.width * canvas.texel_m; ++a)
      paint_box(canvas, a * square_m, b * square_m, (a + 1) * square_m, (b + 1) * square_m,
                (a + b) % 2 ? bright : dark);
}

void paint_repeat(Canvas& canvas, double cell_m) {
  const int n =
      std::clamp(static_cast<int>(std::lround(cell_m / canvas.texel_m)), 1, std::min(canvas.width, canvas.height));
  for (int j = 0; j < canvas.height; ++j)
    for (int i = 0; i < canvas.width; ++i) canvas.at(i, j) = canvas.at(i % n, j % n);
}

}  // namespace pf::sim
