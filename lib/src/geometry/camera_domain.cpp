#include <cmath>

#include "geometry/camera.h"
#include "geometry/camera_distortion.h"

namespace pf {
namespace {

/// Largest x in [0, 1] up to which slope(x) stays above kMinSlope: steps, then bisection of the last one.
template <typename Slope>
Scalar last_good(Slope slope) {
  constexpr int kSteps = 1024;
  Scalar good = 0;
  for (int i = 1; i <= kSteps; ++i) {
    Scalar bad = static_cast<Scalar>(i) / kSteps;
    if (slope(bad) >= kMinSlope) {
      good = bad;
      continue;
    }
    for (int j = 0; j < 40; ++j) {
      const Scalar middle = (good + bad) / 2;
      (slope(middle) >= kMinSlope ? good : bad) = middle;
    }
    break;
  }
  return good;
}

bool is_between(Scalar value, Scalar low, Scalar high) { return value >= low && value <= high; }

/// Every pixel on the border of the inner half of the image has a ray.
bool inner_half_is_one_to_one(const Camera& c) {
  for (int i = 0; i <= 8; ++i) {
    const Scalar f = Scalar(0.25) + static_cast<Scalar>(i) / 16;
    const Scalar w = static_cast<Scalar>(c.width - 1), h = static_cast<Scalar>(c.height - 1);
    const Scalar low = Scalar(0.25), high = Scalar(0.75);
    Vec3 ray;
    if (!unproject(c, Vec2(f * w, low * h), &ray) || !unproject(c, Vec2(f * w, high * h), &ray)) return false;
    if (!unproject(c, Vec2(low * w, f * h), &ray) || !unproject(c, Vec2(high * w, f * h), &ray)) return false;
  }
  return true;
}

}  // namespace

void init_camera(Camera* camera) {
  const Scalar* k = camera->distortion;
  const Scalar flat = kMaxTangent * kMaxTangent;
  switch (static_cast<CameraModel>(camera->model)) {
    case CameraModel::kRadtan: {
      // In steps of the angle from the axis, r = tan(θ), so that near and far are both seen.
      const Scalar most = std::atan(kMaxTangent);
      const Scalar x = last_good([&](Scalar f) { return radtan_slope(k, std::tan(f * most)); });
      const Scalar r = std::tan(x * most);
      camera->max_r2 = r * r;
      break;
    }
    case CameraModel::kEquidistant: {
      const Scalar x = last_good([&](Scalar f) {
        Scalar slope;
        distort_theta(k, f * kMaxTheta, &slope);
        return slope;
      });
      camera->max_r2 = x * x * kMaxTheta * kMaxTheta;
      break;
    }
    case CameraModel::kDivision: {
      // k > 0 flattens out: 1 + 2 k r² <= 1e4. k < 0 ends at a pole: 1 + 2 k r² >= 1e-3.
      const Scalar f = camera->fx < camera->fy ? camera->fx : camera->fy;
      Scalar most = flat * f * f;
      if (k[0] > 0 && most > Scalar(9999) / (2 * k[0])) most = Scalar(9999) / (2 * k[0]);
      if (k[0] < 0 && most > Scalar(-0.999) / (2 * k[0])) most = Scalar(-0.999) / (2 * k[0]);
      camera->max_r2 = most;
      break;
    }
    default:
      camera->max_r2 = flat;
  }
}

const char* check_camera(const Camera& c) {
  if (c.model < 1 || c.model > 4) return "camera.model";
  if (c.width < 32 || c.width > 4096) return "camera.width";
  if (c.height < 32 || c.height > 4096) return "camera.height";
  const Scalar w = static_cast<Scalar>(c.width), h = static_cast<Scalar>(c.height);
  if (!is_between(c.fx, w / 10, w * 20)) return "camera.fx";
  if (!is_between(c.fy, h / 10, h * 20)) return "camera.fy";
  if (!is_between(c.cx, -w, 2 * w)) return "camera.cx";
  if (!is_between(c.cy, -h, 2 * h)) return "camera.cy";
  constexpr int kUsed[5] = {0, 0, 5, 4, 1};
  for (int i = 0; i < 8; ++i) {
    if (!std::isfinite(c.distortion[i])) return "camera.distortion";
    if (i >= kUsed[c.model] && c.distortion[i] != 0) return "camera.distortion";
  }
  if (!std::isfinite(c.max_r2) || !inner_half_is_one_to_one(c)) return "camera.distortion";
  return nullptr;
}

const char* make_camera(int model, int width, int height, const double intrinsics[4], const double distortion[8],
                        Camera* camera) {
  camera->model = model;
  camera->width = width;
  camera->height = height;
  camera->fx = static_cast<Scalar>(intrinsics[0]);
  camera->fy = static_cast<Scalar>(intrinsics[1]);
  camera->cx = static_cast<Scalar>(intrinsics[2]);
  camera->cy = static_cast<Scalar>(intrinsics[3]);
  for (int i = 0; i < 8; ++i) camera->distortion[i] = static_cast<Scalar>(distortion[i]);
  init_camera(camera);
  return check_camera(*camera);
}

}  // namespace pf
