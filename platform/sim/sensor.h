#pragma once

#include <cstdint>
#include <vector>

#include "sim/random.h"

namespace pf::sim {

/// From light to grey levels of 8 bit: vignetting, gain and bias, noise, rounding, clipping.
class Sensor {
 public:
  Sensor(int width, int height, double vignetting);

  void expose(const std::vector<float>& light, double gain, double bias, double noise, Random& random,
              std::vector<std::uint8_t>& grey) const;

 private:
  std::vector<float> falloff_;
  std::vector<float> normals_;  // a pool of draws: looking one up is far cheaper than drawing it
};

}  // namespace pf::sim
