#include "sim/scene.h"

#include <functional>

namespace pf::sim {
namespace {

constexpr double kTargetWidth = 0.21, kTargetHeight = 0.1485;  // A5 [m]

using Painter = std::function<void(Canvas&)>;

class Builder {
 public:
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

}  // namespace

Scene make_desk(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const double top = 0.16, floor = 0.9;  // heights, y down [m]
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  b.add({-2.4, -1.4, 0.95}, x, y, 4.8, 2.4, 0.0025, 150, [&](Canvas& c) {
    b.clutter(c, 0.30, 60);
    b.papers(c, 14, 0.5);
  });
  b.add({-1.7, -1.4, -2.05}, z, y, 3.0, 2.4, 0.004, 130, [&](Canvas& c) { b.clutter(c, 0.3, 60); });
  b.add({-2.4, floor, 1.0}, x, -z, 4.8, 3.4, 0.005, 100, [&](Canvas& c) { b.clutter(c, 0.25, 50); });
  b.add({-1.0, top, 0.75}, x, -z, 2.0, 1.15, 0.001, 120, [&](Canvas& c) {
    b.clutter(c, 0.10, 45);
    b.papers(c, 12, 0.28);
  });
  b.add_box({0, top, 0.08}, {0.40, 0.30, 0.16}, 0, 0.0008, 120, 0.06, 70, [&](Canvas& c) {
    b.clutter(c, 0.06, 70);
    if (options.target) b.paint_target(c, 0.20, 0.14);
  });
  b.add_box({0.55, top, 0.28}, {0.50, 0.36, 0.06}, -0.35, 0.001, 60, 0.05, 80, [&](Canvas& c) {
    paint_box(c, 0.02, 0.02, 0.48, 0.33, 170);
    b.papers(c, 5, 0.22);
    paint_rectangles(c, random, 40, 0.008, 0.05, 100, true);
  });
  b.add_box({-0.55, top, 0.30}, {0.42, 0.30, 0.10}, 0.4, 0.001, 80, 0.05, 80, nullptr);
  for (int k = 0; k < 5; ++k) {
    const double side = k % 2 ? 1 : -1;
    const Vec3 foot{side * random.uniform(0.28, 0.8), top, random.uniform(-0.22, 0.1)};
    const Vec3 size{random.uniform(0.12, 0.24), random.uniform(0.03, 0.14), random.uniform(0.10, 0.2)};
    b.add_box(foot, size, random.uniform(-0.7, 0.7), 0.001, static_cast<float>(random.uniform(70, 180)), 0.05, 70,
              nullptr);
  }
  if (options.person) b.add_person({-2.2, -0.95, 0.55}, {0.45, 0, 0}, x, 1.0);
  return std::move(b.scene);
}

Scene make_room(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const double ceiling = -1.2, floor = 1.4, texel = 0.003;
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const auto wall = [&](bool target) {
    return [&b, &options, target](Canvas& c) {
      b.clutter(c, 0.35, 65);
      b.papers(c, 9, 0.6);
      if (target && options.target) b.paint_target(c, 2.0, 1.2);
    };
  };
  b.add({-2, ceiling, 0}, x, y, 4, 2.6, 0.002, 140, wall(true));    // looking along +z
  b.add({2, ceiling, -4}, -x, y, 4, 2.6, texel, 130, wall(false));  // along -z
  b.add({-2, ceiling, -4}, z, y, 4, 2.6, texel, 120, wall(false));  // along -x
  b.add({2, ceiling, 0}, -z, y, 4, 2.6, texel, 150, wall(false));   // along +x
  b.add({-2, floor, 0}, x, -z, 4, 4, 0.004, 100, [&](Canvas& c) { b.clutter(c, 0.35, 45); });
  b.add({-2, ceiling, -4}, x, z, 4, 4, 0.005, 180, [&](Canvas& c) { b.clutter(c, 0.5, 30); });
  b.add_box({1.2, floor, -0.35}, {0.9, 1.1, 0.5}, 0, 0.003, 110, 0.2, 60, nullptr);
  b.add_box({-1.4, floor, -0.6}, {0.6, 0.7, 0.5}, 0.5, 0.003, 150, 0.2, 60, nullptr);
  b.add_box({1.5, floor, -3.0}, {0.6, 1.5, 0.8}, 0.1, 0.003, 90, 0.2, 60, nullptr);
  b.add_box({-1.5, floor, -3.3}, {0.8, 0.9, 0.6}, -0.4, 0.003, 130, 0.2, 60, nullptr);
  if (options.person) b.add_person({-1.9, -0.3, -0.55}, {0.32, 0, 0}, x, 0.95);
  return std::move(b.scene);
}

Scene make_wall(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  b.add({-2.5, -1.8, 0}, {1, 0, 0}, {0, 1, 0}, 5.0, 3.6, 0.002, 135, [&](Canvas& c) {
    b.clutter(c, 0.2, 75);
    if (options.target) b.paint_target(c, 2.5, 1.8);
  });
  if (options.person) b.add_person({-1.6, -0.7, -0.4}, {0.25, 0, 0}, {1, 0, 0}, 0.8);
  return std::move(b.scene);
}

Scene make_checker(double square, int squares) {
  Scene scene;
  // 64 texels a square: corners fall on texel borders.
  Canvas canvas(square * squares, square * squares, square / 64, 128);
  paint_checker(canvas, square, 40, 215);
  const double half = 0.5 * square * squares;
  scene.quads.push_back({{-half, -half, 0},
                         {1, 0, 0},
                         {0, 1, 0},
                         2 * half,
                         2 * half,
                         std::make_shared<Texture>(canvas),
                         Shape::kRectangle});
  return scene;
}

}  // namespace pf::sim
