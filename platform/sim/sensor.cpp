#include "sim/sensor.h"

#include <algorithm>

namespace pf::sim {

Sensor::Sensor(int width, int height, double vignetting)
    : falloff_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)), normals_(65536) {
  const double cx = 0.5 * (width - 1), cy = 0.5 * (height - 1), r2 = cx * cx + cy * cy;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      falloff_[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)] =
          static_cast<float>(1 - vignetting * ((i - cx) * (i - cx) + (j - cy) * (j - cy)) / r2);
  Random random(20070901);
  for (float& n : normals_) n = static_cast<float>(random.normal());
}

void Sensor::expose(const std::vector<float>& light, double gain, double bias, double noise, Random& random,
                    std::vector<std::uint8_t>& grey) const {
  grey.resize(light.size());
  const auto g = static_cast<float>(gain), b = static_cast<float>(bias), s = static_cast<float>(noise);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    float value = g * falloff_[i] * light[i] + b;
    if (s > 0) {
      bits = i % 4 == 0 ? random.bits() : bits >> 16;
      value += s * normals_[bits & 0xffff];
    }
    grey[i] = static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
  }
}

}  // namespace pf::sim
