#pragma once

// What cameras see that only turn: a texture on a sphere around them.

#include <algorithm>
#include <cmath>

#include "geometry/camera.h"
#include "support/filter_cases.h"
#include "support/textured_images.h"
#include "track/thumbnail.h"

namespace pf {

struct Panorama {
  static constexpr int kWidth = 320, kHeight = 240;
  Texture texture;
  TestArena arena;
  Pyramid pyramid;  ///< of the last look

  explicit Panorama(SeededRandom& random) : texture(&random, 70, 180) {
    TEST_ASSERT_TRUE(pyramid.layout(*arena, kWidth, kHeight, 4));
  }
  void look(const Camera& camera, const Quat& q_WC, double gain = 1, double bias = 0) {
    const TestImage image(kWidth, kHeight, [&](int x, int y) {
      Vec3 ray;
      if (!unproject(camera, Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y)), &ray)) return 0.0;
      ray = q_WC * ray;
      const double longitude = std::atan2(static_cast<double>(ray.x()), static_cast<double>(ray.z()));
      const double latitude = std::asin(std::clamp(static_cast<double>(ray.y()), -1.0, 1.0));
      return std::clamp(gain * texture.at(2000 + 300 * longitude, 2000 + 300 * latitude) + bias, 0.0, 255.0);
    });
    pyramid.build(image.view());
  }
  Thumbnail thumbnail(const Camera& camera, const Quat& q_WC, double gain = 1, double bias = 0) {
    look(camera, q_WC, gain, bias);
    Thumbnail t;
    make_thumbnail(pyramid, &t);
    return t;
  }
};

}  // namespace pf
