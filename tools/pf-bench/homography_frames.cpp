#include "homography_frames.h"

#include <algorithm>
#include <cmath>

namespace bench {

using pf::sim::Canvas;
using pf::sim::Mat3;
using pf::sim::Pose;
using pf::sim::Random;
using pf::sim::Texture;
using pf::sim::Vec3;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTexel = 0.001;                  // of the plane, which is 1 m away in the first frame [m]
constexpr double kWide = 2.4;                     // of the plane [m]
constexpr int kSurroundings = 48;                 // that are drawn around the patch [px]
constexpr int kSamples = 3;                       // of a pixel, in each direction
constexpr double kPixel = 1.5;                    // that a pixel sees, lens and all [px]
constexpr int kWaves = 3;                         // of each of the six motions
constexpr double kTurn[3] = {0.35, 0.35, 0.5};    // amplitudes [rad]
constexpr double kShift[3] = {0.12, 0.12, 0.15};  // [m]
constexpr double kGain = 0.5, kBias = 25;         // amplitudes of the light
constexpr double kLightFrames = 23;               // of its wave
constexpr double kHiddenFrames = 67;              // in which what hides the patch goes over it and back

enum Stream : std::uint64_t { kPlaneStream = 71, kOtherStream, kPathStream, kNoiseStream };

std::unique_ptr<Texture> make_texture(std::uint64_t seed, std::uint64_t stream) {
  Random random(seed, stream);
  Canvas canvas(kWide, kWide, kTexel, 128);
  paint_noise(canvas, random, 30, 0.1, 5, 0.6);
  paint_rectangles(canvas, random, 3000, 0.012, 0.08, 60, false);
  paint_blobs(canvas, random, 2000, 0.012, 0.05, 60);
  return std::make_unique<Texture>(canvas);
}

Homography inverse_of(const Homography& H) {
  const auto minor = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
    return H[a] * H[d] - H[b] * H[c];
  };
  return {minor(4, 5, 7, 8),  -minor(1, 2, 7, 8), minor(1, 2, 4, 5),  -minor(3, 5, 6, 8), minor(0, 2, 6, 8),
          -minor(0, 2, 3, 5), minor(3, 4, 6, 7),  -minor(0, 1, 6, 7), minor(0, 1, 3, 4)};
}

}  // namespace

std::array<double, 2> map_pixel(const Homography& H, double x, double y) {
  const double w = H[6] * x + H[7] * y + H[8];
  return {(H[0] * x + H[1] * y + H[2]) / w, (H[3] * x + H[4] * y + H[5]) / w};
}

HomographyFrames::HomographyFrames(const HomographyOptions& options, PatchTrouble trouble, std::uint64_t seed)
    : options_(options),
      trouble_(trouble),
      noise_(seed, kNoiseStream),
      plane_(make_texture(seed, kPlaneStream)),
      other_(make_texture(seed, kOtherStream)),
      grey_(static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height)) {
  Random path(seed, kPathStream), step(seed, kPathStream + 100);
  for (std::size_t i = 0; i < wave_.size(); i += 2) {
    wave_[i] = path.uniform(0.4, 1.6);        // radians for each unit of the way
    wave_[i + 1] = path.uniform(0, 2 * kPi);  // phase
  }
  const double far = options.side - 1;
  const auto way = [&](const Homography& a, const Homography& b) {
    double sum = 0;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {far, 0.0}, {far, far}, {0.0, far}}) {
      const auto p = map_pixel(a, left() + x, top() + y), q = map_pixel(b, left() + x, top() + y);
      sum += 0.25 * std::hypot(p[0] - q[0], p[1] - q[1]);
    }
    return sum;
  };
  double s = 0;
  for (int frame = 0; frame < options.frames; ++frame) {
    truth_.push_back(homography(s));
    const double wanted = step.uniform(options.step_low, options.step_high);
    double low = 0, high = 0.5;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (way(truth_.back(), homography(s + middle)) < wanted ? low : high) = middle;
    }
    s += low;
  }
}

/// The camera before the plane z = 1, at the identity at s = 0.
Pose HomographyFrames::pose(double s) const {
  double value[6] = {};
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < kWaves; ++k) {
      const double rate = wave_[static_cast<std::size_t>(2 * (i * kWaves + k))];
      const double phase = wave_[static_cast<std::size_t>(2 * (i * kWaves + k) + 1)];
      value[i] += (std::sin(rate * s + phase) - std::sin(phase)) / (2 * kWaves);
    }
    value[i] *= i < 3 ? kTurn[i] : kShift[i - 3];
  }
  const Vec3 t{value[3], value[4], value[5]};
  // It looks at about the same place, turned by the wanted angles.
  const Vec3 axis = (Vec3{0.3 * value[1], 0.3 * value[0], 1} - t).unit();
  const Mat3 R = pf::sim::look_along(axis, {std::sin(value[2]), std::cos(value[2]), 0});
  return {R, t};
}

/// K (R^T - R^T t n^T / d) K^-1 for p_C = R^T (p - t), n = e_z, d = 1.
Homography HomographyFrames::homography(double s) const {
  const auto at = [&](double parameter) {
    const Pose p = pose(parameter);
    const Mat3 R = p.R_WC.transposed();
    const Vec3 t = R * p.p_WC;
    Mat3 M = R;
    M(0, 2) -= t.x;
    M(1, 2) -= t.y;
    M(2, 2) -= t.z;
    return M;
  };
  const Mat3 M = at(s);
  const double cx = 0.5 * (options_.width - 1), cy = 0.5 * (options_.height - 1), f = options_.focal;
  const Mat3 K{{f, 0, cx, 0, f, cy, 0, 0, 1}}, K_inverse{{1 / f, 0, -cx / f, 0, 1 / f, -cy / f, 0, 0, 1}};
  const Mat3 H = K * M * K_inverse;
  Homography out;
  std::copy(H.m.begin(), H.m.end(), out.begin());
  return out;
}

double HomographyFrames::grey_at(int frame, double x, double y, const Homography& inverse) const {
  const auto p = map_pixel(inverse, x, y);
  const double f = options_.focal, cx = 0.5 * (options_.width - 1), cy = 0.5 * (options_.height - 1);
  const float footprint = static_cast<float>(kPixel / (f * kSamples));
  if (trouble_ == PatchTrouble::kOcclusion && frame > 0) {
    const double wide = options_.hidden * options_.side;
    const double phase = std::fmod(frame / kHiddenFrames, 1.0), part = phase < 0.5 ? 2 * phase : 2 - 2 * phase;
    const double from = left() + part * (options_.side - wide);
    if (p[0] >= from && p[0] < from + wide && p[1] >= top() - 0.1 * options_.side && p[1] < top() + 1.1 * options_.side)
      return static_cast<double>(
          other_->sample(static_cast<float>(x / f + 1), static_cast<float>(y / f + 1), footprint));
  }
  return static_cast<double>(plane_->sample(static_cast<float>((p[0] - cx) / f + 0.5 * kWide),
                                            static_cast<float>((p[1] - cy) / f + 0.5 * kWide), footprint));
}

const std::vector<std::uint8_t>& HomographyFrames::draw(int frame) {
  const Homography& H = truth(frame);
  const Homography inverse = inverse_of(H);
  double x0 = options_.width, x1 = 0, y0 = options_.height, y1 = 0;
  for (int k = 0; k < 4; ++k) {
    const auto p = map_pixel(H, left() + (k % 2 != 0 ? options_.side : 0), top() + (k / 2 != 0 ? options_.side : 0));
    x0 = std::min(x0, p[0]), x1 = std::max(x1, p[0]), y0 = std::min(y0, p[1]), y1 = std::max(y1, p[1]);
  }
  const int begin_x = std::max(0, static_cast<int>(x0) - kSurroundings),
            end_x = std::min(options_.width, static_cast<int>(x1) + kSurroundings);
  const int begin_y = std::max(0, static_cast<int>(y0) - kSurroundings),
            end_y = std::min(options_.height, static_cast<int>(y1) + kSurroundings);
  const bool lit = trouble_ == PatchTrouble::kLight && frame > 0;
  const double wave = 2 * kPi * frame / kLightFrames;
  const double gain = lit ? 1 + kGain * std::sin(wave) : 1, bias = lit ? kBias * std::sin(0.71 * wave) : 0;
  std::fill(grey_.begin(), grey_.end(), std::uint8_t{128});
  for (int y = begin_y; y < end_y; ++y)
    for (int x = begin_x; x < end_x; ++x) {
      double sum = 0;
      for (int k = 0; k < kSamples * kSamples; ++k)
        sum += grey_at(frame, x + kPixel * ((k % kSamples + 0.5) / kSamples - 0.5),
                       y + kPixel * ((k / kSamples + 0.5) / kSamples - 0.5), inverse);
      const double grey = gain * sum / (kSamples * kSamples) + bias + options_.noise_grey * noise_.normal();
      grey_[static_cast<std::size_t>(y) * static_cast<std::size_t>(options_.width) + static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0) + 0.5);
    }
  return grey_;
}

}  // namespace bench
