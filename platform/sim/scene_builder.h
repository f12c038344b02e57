#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "sim/scene.h"

/// What scenes are put together from. The order of the draws is part of a scene: the same seed gives the same pixels.

namespace pf::sim {

using Painter = std::function<void(Canvas&)>;

class Builder {
 public:
  static constexpr double kTargetWidth = 0.21, kTargetHeight = 0.1485;  ///< A5 [m]

  Builder(Random& random, const SceneOptions& options) : random_(random), options_(options) {}

  /// Clutter for a surface whose interesting detail is about `scale` metres large.
  void clutter(Canvas& canvas, double scale, double contrast) {
    const double area = canvas.width * canvas.texel_m * canvas.height * canvas.texel_m;
    const auto count = [&](double density) { return static_cast<int>(density * area / (scale * scale)) + 2; };
    paint_noise(canvas, random_, 0.25 * contrast, scale, 7, 0.75);
    paint_rectangles(canvas, random_, count(1.2), 0.4 * scale, 1.5 * scale, contrast, false);
    paint_blobs(canvas, random_, count(1.0), 0.2 * scale, 0.8 * scale, contrast);
    paint_rectangles(canvas, random_, count(5.0), 0.08 * scale, 0.4 * scale, contrast, false);
    paint_noise(canvas, random_, 0.12 * contrast, 0.05 * scale, 4, 0.9);
    if (options_.repeated_texture) paint_repeat(canvas, 2.0 * scale);
  }

  void add(const Vec3& corner, const Vec3& u, const Vec3& v, double width, double height, double texel, float base,
           const Painter& paint) {
    Canvas canvas(width, height, texel, base);
    paint(canvas);
    scene.quads.push_back({corner, u, v, width, height, std::make_shared<Texture>(canvas), Shape::kRectangle});
  }

  /// The last rectangle once more, elsewhere.
  void add_like_last(const Vec3& corner, const Vec3& u, const Vec3& v) {
    Quad quad = scene.quads.back();
    quad.corner_W = corner;
    quad.u_W = u;
    quad.v_W = v;
    scene.quads.push_back(std::move(quad));
  }

  /// The five faces of a box that stand free: not the one that it stands on. Size is x, y, z before turning by yaw
  /// about the vertical; `foot` is the centre of the bottom.
  void add_box(const Vec3& foot, const Vec3& size, double yaw, double texel, float base, double scale, double contrast,
               const Painter& front) {
    const Vec3 x{std::cos(yaw), 0, std::sin(yaw)}, z{-std::sin(yaw), 0, std::cos(yaw)}, y{0, 1, 0};
    const Vec3 top = foot - y * size.y;
    const auto paint = [&](Canvas& c) { clutter(c, scale, contrast); };
    const Vec3 hx = x * (0.5 * size.x), hz = z * (0.5 * size.z);
    add(top - hx - hz, x, y, size.x, size.y, texel, base, front ? front : paint);  // seen looking along +z
    add(top + hx + hz, -x, y, size.x, size.y, texel, base, paint);                 // along -z
    add(top - hx + hz, -z, y, size.z, size.y, texel, base, paint);                 // along +x
    add(top + hx - hz, z, y, size.z, size.y, texel, base, paint);                  // along -x
    add(top - hx + hz, x, -z, size.x, size.z, texel, base, paint);                 // from above
  }

  /// Sheets of paper with print and pictures, over what is there.
  void papers(Canvas& canvas, int count, double largest) {
    const double w = canvas.width * canvas.texel_m, h = canvas.height * canvas.texel_m;
    for (int k = 0; k < count; ++k) {
      const double a = largest * random_.uniform(0.5, 1.0), b = a * random_.uniform(0.6, 1.4);
      const double u = random_.uniform(0, w - a), v = random_.uniform(0, std::max(0.01, h - b));
      paint_box(canvas, u, v, u + a, v + b, random_.uniform(190, 235));
      paint_print(canvas, random_, u + 0.03 * a, v + 0.03 * b, u + 0.97 * a, v + 0.6 * b, 0.05 * a);
      paint_box(canvas, u + 0.1 * a, v + 0.66 * b, u + 0.5 * a, v + 0.94 * b, random_.uniform(40, 120));
      paint_box(canvas, u + 0.2 * a, v + 0.75 * b, u + 0.7 * a, v + 0.9 * b, random_.uniform(120, 180));
    }
  }

  /// White ground with the dark target, its centre at (u, v) of the canvas.
  void paint_target(Canvas& canvas, double u, double v) {
    const double a = 0.5 * kTargetWidth, b = 0.5 * kTargetHeight, margin = 0.06;
    paint_box(canvas, u - a - margin, v - b - margin, u + a + margin, v + b + margin, 225);
    paint_box(canvas, u - a, v - b, u + a, v + b, 25);
    scene.target_width = kTargetWidth;
    scene.target_height = kTargetHeight;
  }

  void add_person(const Vec3& start, const Vec3& velocity, const Vec3& right, double scale) {
    add(start, right, {0, 1, 0}, 0.55 * scale, 1.75 * scale, 0.004 * scale, 110, [&](Canvas& c) {
      clutter(c, 0.12 * scale, 80);
      paint_box(c, 0.19 * scale, 0, 0.36 * scale, 0.28 * scale, 170);
      paint_noise(c, random_, 12, 0.05 * scale, 3, 0.8);
    });
    scene.quads.back().shape = Shape::kPerson;
    scene.person = static_cast<int>(scene.quads.size()) - 1;
    scene.person_start_W = start;
    scene.person_velocity_W = velocity;
  }

  Scene scene;

 private:
  Random& random_;
  const SceneOptions& options_;
};

}  // namespace pf::sim
