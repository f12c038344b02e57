#include <cmath>
#include <cstddef>

#include "api/context.h"
#include "covariance/select.h"

namespace pf {
namespace {

struct Range {
  const char* name;
  double low, high;
  std::size_t offset;
};

#define PF_FIELD(field, low, high) \
  { #field, low, high, offsetof(pf_config_t, field) }

constexpr Range kIntegers[] = {
    PF_FIELD(max_state_dim, 32, 2000), PF_FIELD(max_features, 8, 1000),   PF_FIELD(max_observations, 8, 200),
    PF_FIELD(max_planes, 1, 64),       PF_FIELD(plane_min_points, 4, 60), PF_FIELD(features_in_view, 8, 200),
    PF_FIELD(border_px, 4, 64),        PF_FIELD(imu_buffer, 0, 10000),
};

constexpr double kTiny = 1e-9;
constexpr Range kReals[] = {
    PF_FIELD(linear_acceleration_density, kTiny, 1e4),
    PF_FIELD(angular_acceleration_density, kTiny, 1e4),
    PF_FIELD(linear_walk, kTiny, 1e4),
    PF_FIELD(angular_walk, kTiny, 1e4),
    PF_FIELD(sigma_pixel, 0.01, 10),
    PF_FIELD(gate_probability, 0.9, 0.9999),
    PF_FIELD(start_depth, 1e-4, 1e5),
    PF_FIELD(inverse_depth_relative_sigma, 0.05, 5),
    PF_FIELD(linearity_index, 0.001, 1),
    PF_FIELD(plane_distance, 1e-5, 10),
    PF_FIELD(plane_radius, 0.01, 1e4),
    PF_FIELD(plane_roughness, 1e-6, 1),
    PF_FIELD(fold_sigma, 1e-5, 10),
    PF_FIELD(fix_sigma, 0, 10),
    PF_FIELD(coast_seconds, 0.05, 10),
    PF_FIELD(imu_gyro_range, 0, 1000),
    PF_FIELD(imu_accel_range, 0, 1e5),
};

#undef PF_FIELD

template <typename T>
T field_at(const pf_config_t& config, std::size_t offset) {
  T value;
  __builtin_memcpy(&value, reinterpret_cast<const char*>(&config) + offset, sizeof(T));
  return value;
}

constexpr double kLongestReadout = 0.2;  // [s]
constexpr std::uint32_t kScalar = sizeof(Scalar);

}  // namespace

Status settings_from(const pf_config_t& config, Settings* settings, const char** field) {
  const char* dummy;
  if (field == nullptr) field = &dummy;
  *field = nullptr;
  if (config.size != sizeof(pf_config_t)) return *field = "size", Status::kVersion;
  if (config.version != PF_VERSION) return *field = "version", Status::kVersion;
  if (config.scalar != kScalar) return *field = "scalar", Status::kScalar;
  for (const Range& r : kIntegers) {
    const double value = field_at<std::int32_t>(config, r.offset);
    if (!(value >= r.low && value <= r.high)) return *field = r.name, Status::kConfig;
  }
  for (const Range& r : kReals) {
    const double value = field_at<double>(config, r.offset);
    if (!(value >= r.low && value <= r.high)) return *field = r.name, Status::kConfig;
  }
  if (config.features_in_view > config.max_observations) return *field = "features_in_view", Status::kConfig;
  if (config.motion != PF_MOTION_CONSTANT_VELOCITY && config.motion != PF_MOTION_CONSTANT_POSITION)
    return *field = "motion", Status::kConfig;
  if (config.keep_gauge > 1) return *field = "keep_gauge", Status::kConfig;
  if (config.planes > 1) return *field = "planes", Status::kConfig;
  if (config.fold != PF_FOLD_CONDITION && config.fold != PF_FOLD_DROP) return *field = "fold", Status::kConfig;
  if (config.fix < PF_FIX_CONSIDER || config.fix > PF_FIX_ERROR_FREE) return *field = "fix", Status::kConfig;
  if (config.depth_from_map > 1) return *field = "depth_from_map", Status::kConfig;

  settings->kernels = select_kernels(config.kernels);
  if (settings->kernels == nullptr) return *field = "kernels", Status::kConfig;
  const pf_camera_t& c = config.camera;
  const double intrinsics[4] = {c.fx, c.fy, c.cx, c.cy};
  const char* bad = make_camera(c.model, c.width, c.height, intrinsics, c.distortion, &settings->camera);
  if (bad != nullptr) return *field = bad, Status::kConfig;
  const bool moves = config.motion == PF_MOTION_CONSTANT_VELOCITY;
  if (!(c.readout_s >= 0 && c.readout_s <= (moves ? kLongestReadout : 0))) return *field = "readout_s", Status::kConfig;
  settings->camera.readout = static_cast<Scalar>(c.readout_s);

  settings->max_state_dim = config.max_state_dim;
  settings->max_features = config.max_features;
  settings->max_observations = config.max_observations;
  settings->max_planes = config.max_planes;
  settings->planes = config.planes != 0;
  settings->plane_min_points = config.plane_min_points;
  settings->plane_distance = static_cast<Scalar>(config.plane_distance);
  settings->plane_radius = static_cast<Scalar>(config.plane_radius);
  settings->fold_sigma = static_cast<Scalar>(config.fold_sigma);
  settings->fix_sigma = static_cast<Scalar>(config.fix_sigma);
  // chi-square with one degree of freedom: 1 % of the points of a plane stay out
  settings->fold = {static_cast<Scalar>(config.plane_roughness), Scalar(6.63), config.fold == PF_FOLD_CONDITION};
  settings->fix = config.fix == PF_FIX_CONSIDER  ? FixForm::kConsider
                  : config.fix == PF_FIX_INFLATE ? FixForm::kInflate
                                                 : FixForm::kErrorFree;
  settings->constant_velocity = config.motion == PF_MOTION_CONSTANT_VELOCITY;
  settings->motion_noise.linear =
      static_cast<Scalar>(settings->constant_velocity ? config.linear_acceleration_density : config.linear_walk);
  settings->motion_noise.angular =
      static_cast<Scalar>(settings->constant_velocity ? config.angular_acceleration_density : config.angular_walk);
  settings->sigma_px = static_cast<Scalar>(config.sigma_pixel);
  // chi-square with two degrees of freedom: P(d2 < gate) = 1 - exp(-gate / 2)
  settings->gate = static_cast<Scalar>(-2.0 * std::log(1.0 - config.gate_probability));
  settings->start_depth = static_cast<Scalar>(config.start_depth);
  settings->depth_from_map = config.depth_from_map != 0;
  settings->inverse_depth_relative_sigma = static_cast<Scalar>(config.inverse_depth_relative_sigma);
  settings->linearity_index = static_cast<Scalar>(config.linearity_index);
  settings->features_in_view = config.features_in_view;
  settings->border_px = config.border_px;
  settings->coast_ns = static_cast<std::int64_t>(config.coast_seconds * 1e9);
  settings->keep_gauge = config.keep_gauge != 0;
  settings->imu_buffer = config.imu_buffer;
  settings->imu_ranges = {static_cast<Scalar>(config.imu_gyro_range), static_cast<Scalar>(config.imu_accel_range)};
  settings->hooks.clock_ns = config.clock_ns;
  settings->hooks.log = config.log;
  settings->hooks.user = config.user;
  return Status::kOk;
}

}  // namespace pf

pf_status_t pf_config_default(pf_config_t* config) {
  if (config == nullptr) return PF_ERROR_NULL;
  *config = pf_config_t();
  config->size = sizeof(pf_config_t);
  config->version = PF_VERSION;
  config->scalar = pf::kScalar;
  config->kernels = PF_KERNELS_AUTO;
  config->max_state_dim = 300;
  config->max_features = 100;
  config->max_observations = 60;
  config->max_planes = 8;
  config->planes = 1;
  config->plane_min_points = 7;
  config->plane_distance = 0.01;
  config->plane_radius = 1.5;
  config->plane_roughness = 0.002;
  config->fold_sigma = 0.05;
  config->fix_sigma = 0;
  config->fold = PF_FOLD_CONDITION;
  config->fix = PF_FIX_CONSIDER;
  config->motion = PF_MOTION_CONSTANT_VELOCITY;
  config->linear_acceleration_density = 1.0;
  config->angular_acceleration_density = 2.0;
  config->linear_walk = 0.1;
  config->angular_walk = 0.2;
  config->sigma_pixel = 0.1;
  config->gate_probability = 0.99;
  config->start_depth = 1.0;
  config->depth_from_map = 1;
  config->inverse_depth_relative_sigma = 2.0;
  config->linearity_index = 0.1;
  config->features_in_view = 45;
  config->border_px = 8;
  config->coast_seconds = 1.0;
  config->keep_gauge = 1;
  config->imu_buffer = 0;
  config->imu_gyro_range = 0;
  config->imu_accel_range = 0;
  return PF_OK;
}

pf_status_t pf_config_check(const pf_config_t* config, const char** field) {
  if (config == nullptr) return PF_ERROR_NULL;
  pf::Settings settings;
  return pf::to_c(pf::settings_from(*config, &settings, field));
}
