// Numbers, times and whole configs that are drawn from a fuzzer's bytes.
#pragma once

#include <planefold/planefold_research.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <limits>

#include "bytes.h"

/// A number that no program should pass, or one that it might.
inline double hostile(Bytes& bytes) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  static const double values[] = {kNan,     kInfinity, -kInfinity, 0.0,  -0.0, 5e-324, DBL_MIN, DBL_MAX,
                                  -DBL_MAX, 1e-30,     1e30,       -1.0, 1e-9, 1e5,    0.1,     1.0};
  const uint8_t which = bytes.take<uint8_t>();
  return which < 240 ? values[which % 16] : bytes.take<double>();
}

inline int64_t hostile_time(Bytes& bytes, int64_t t_ns) {
  switch (bytes.take<uint8_t>() % 8) {
    case 0:
      return INT64_MIN;
    case 1:
      return INT64_MAX;
    case 2:
      return 0;
    case 3:
      return t_ns;
    case 4:
      return t_ns > INT64_MIN ? t_ns - 1 : t_ns;
    case 5:
      return t_ns < INT64_MAX ? t_ns + 1 : t_ns;
    default:
      return bytes.take<int64_t>();
  }
}

/// -1 .. 1
inline double unit(Bytes& bytes) { return bytes.take<int8_t>() / 128.0; }

inline double between(Bytes& bytes, double low, double high) {
  return low * std::pow(high / low, bytes.take<uint8_t>() / 255.0);
}

inline void make_lens_uncertain(Bytes& bytes, pf_camera_estimate_t estimate, pf_config_t* config) {
  config->camera.estimate = estimate;
  config->camera.sigma_focal = between(bytes, 1e-5, 0.2);
  config->camera.sigma_aspect = between(bytes, 1e-6, 0.2);
  config->camera.sigma_centre_px = between(bytes, 1e-3, 100);
}

/// The other back end, or walls with patches and an uncertain mounting; an uncertain lens and masks with both.
inline void extend(Bytes& bytes, pf_config_t* config) {
  const uint8_t more = bytes.take<uint8_t>();
  if ((more & 1) != 0) {
    config->backend = PF_BACKEND_WINDOW;
    config->window.keyframes = 2 + bytes.take<uint8_t>() % 7;
    config->window.fixed_keyframes = bytes.take<uint8_t>() % 17;
    config->window.points = 50 + bytes.take<uint8_t>();
    config->plane.fix_sigma = 0;
    if (config->motion.model == PF_MOTION_INERTIAL) config->motion.model = PF_MOTION_CONSTANT_VELOCITY;
    if ((more & 4) != 0) make_lens_uncertain(bytes, PF_CAMERA_ESTIMATE, config);
  } else {
    if ((more & 2) != 0) {
      config->capacity.max_patches = 1 + bytes.take<uint8_t>() % 8;
      config->capacity.patch_side_px = 32 + bytes.take<uint8_t>() % 24;
      config->capacity.max_cameras = bytes.take<uint8_t>() % 9;
      if ((more & 32) != 0) config->map.features_in_view = 0;
    }
    if ((more & 4) != 0) make_lens_uncertain(bytes, (more & 64) != 0 ? PF_CAMERA_CONSIDER : PF_CAMERA_ESTIMATE, config);
    if ((more & 8) != 0) {
      config->imu.sigma_mount_rad = between(bytes, 1e-6, 0.5);
      config->imu.sigma_mount_m = between(bytes, 1e-6, 1);
      config->imu.sigma_delay_s = between(bytes, 1e-6, 0.1);
      if (config->camera.readout_s > 0) config->imu.sigma_readout_s = 0.01;
      if ((more & 128) != 0) config->imu.sigma_scale = between(bytes, 1e-6, 0.05);
    }
  }
  if ((more & 16) != 0) {
    config->map.masks = (more & 128) != 0 ? PF_MASKS_WHOLE : PF_MASKS_PARTIAL;
    config->capacity.template_px = 9 + 2 * (bytes.take<uint8_t>() % 12);
  }
}

constexpr uint8_t kExtended = 128, kOdd = 16;  ///< of a config's first byte

/// A config within its ranges; for every second one, and the calm, near what people use.
inline pf_config_t config_from(Bytes& bytes, bool calm, bool* extended) {
  pf_config_t config;
  pf_config_default(&config);
  uint8_t what = bytes.take<uint8_t>();
  if (calm) what &= ~kOdd;
  const int size = calm ? 2 : 1;
  const int width = size * (48 + bytes.take<uint8_t>() % 80), height = size * (40 + bytes.take<uint8_t>() % 64);
  const double f = width * between(bytes, 0.5, 2.0);
  config.camera = {
      PF_CAMERA_PINHOLE,  width, height, f, f, (width - 1) / 2.0, (height - 1) / 2.0, {}, 0, PF_CAMERA_EXACT,
      PF_TIMESTAMPS_REAL, 0,     0,      0, {}};
  if ((what & 1) != 0) {
    config.camera.model = 2 + bytes.take<uint8_t>() % 3;
    config.camera.distortion[0] = unit(bytes) * (config.camera.model == PF_CAMERA_DIVISION ? 1e-6 : 0.05);
  }
  if ((what & 2) != 0) config.camera.readout_s = between(bytes, 1e-4, 0.2);
  config.capacity.max_state_dim = 40 + bytes.take<uint8_t>();
  config.capacity.max_features = 8 + bytes.take<uint8_t>() % 80;
  config.capacity.max_observations = 8 + bytes.take<uint8_t>() % 60;
  config.capacity.max_planes = 1 + bytes.take<uint8_t>() % 4;
  config.capacity.max_imu_samples = bytes.take<uint8_t>() % 16;
  config.capacity.max_kept_views = config.capacity.max_imu_samples % 4;
  config.capacity.max_anchors = config.capacity.max_imu_samples % 5;
  config.map.features_in_view = config.capacity.max_observations;
  config.plane.min_points = 4 + bytes.take<uint8_t>() % 5;
  config.plane.max_distance = between(bytes, 0.005, 0.05);
  config.plane.fold_sigma = between(bytes, 0.02, 0.3);
  config.plane.fix_sigma = (what & 4) != 0 ? between(bytes, 5e-4, 0.05) : 0.0;
  pf_research_t research;
  pf_research_default(&research);
  const uint8_t forms = bytes.take<uint8_t>();
  if (forms >= 192) {
    config.plane.fix = 1 + forms % 3;
    research.fold = 1 + forms / 3 % 2;
    research.keep_gauge = forms / 6 % 2;
  }
  pf_config_set_research(&config, &research);
  config.kernels = bytes.take<uint8_t>() % 3;
  if ((what & kOdd) != 0) {
    config.motion.linear_acceleration_density = between(bytes, 1e-3, 1e2);
    config.motion.angular_acceleration_density = between(bytes, 1e-3, 1e2);
    config.measurement.sigma_px = between(bytes, 0.01, 10);
    config.first_depth.depth = between(bytes, 1e-2, 1e2);
    config.first_depth.relative_sigma = between(bytes, 0.05, 5);
    config.first_depth.from_map = bytes.take<uint8_t>() % 2;
    config.motion.coast_s = between(bytes, 0.05, 10);
    config.motion.restart_s = 10 - config.motion.coast_s;
  }
  if ((what & 32) != 0 && config.camera.readout_s == 0) config.motion.model = PF_MOTION_CONSTANT_POSITION;
  if ((what & 64) != 0) {
    config.motion.model = PF_MOTION_INERTIAL;
    config.capacity.max_imu_samples = 64 + bytes.take<uint8_t>() % 64;
    config.imu.gyro_density = between(bytes, 1e-5, 0.1);
    config.imu.accel_density = between(bytes, 1e-4, 1);
    config.imu.gyro_walk = between(bytes, 1e-6, 0.1);
    config.imu.accel_walk = between(bytes, 1e-5, 1);
    config.imu.p_BC[0] = unit(bytes);
    config.imu.delay_s = 0.5 * unit(bytes);
  }
  *extended = (what & kExtended) != 0;
  if (*extended) extend(bytes, &config);
  return config;
}
