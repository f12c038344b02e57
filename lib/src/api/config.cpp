#include <algorithm>
#include <cmath>
#include <cstddef>

#include "api/checks.h"
#include "api/context.h"
#include "api/research.h"
#include "base/limits.h"
#include "covariance/select.h"
#include "frame/tuning.h"
#include "geometry/camera_distortion.h"

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
    PF_FIELD(first_depth.from_map, 0, 1),
    PF_FIELD(plane.enabled, 0, 1),
    PF_FIELD(capacity.max_state_dim, 32, 2000),
    PF_FIELD(capacity.max_features, 8, 1000),
    PF_FIELD(capacity.max_observations, 8, pf::kMaxObservations),
    PF_FIELD(capacity.max_planes, 1, pf::kMaxPlanes),
    PF_FIELD(capacity.max_kept_views, 0, 200),
    PF_FIELD(capacity.max_places, -1, pf::kMaxPlaces),
    PF_FIELD(capacity.max_anchors, 0, pf::kMaxAnchors),
    PF_FIELD(capacity.max_patches, 0, pf::kMaxPatches),
    PF_FIELD(capacity.patch_side_px, 32, 128),
    PF_FIELD(capacity.max_cameras, 0, 64),
    PF_FIELD(capacity.template_px, pf::PlanarTemplate::kMinSide, pf::PlanarTemplate::kMaxSide),
    PF_FIELD(window.keyframes, 2, 8),
    PF_FIELD(window.fixed_keyframes, 0, 16),
    PF_FIELD(window.points, 50, 1000),
    PF_FIELD(backend, PF_BACKEND_FILTER, PF_BACKEND_WINDOW),
    PF_FIELD(map.masks, PF_MASKS_NONE, PF_MASKS_WHOLE),
    PF_FIELD(plane.min_points, 4, 60),
    PF_FIELD(map.features_in_view, 0, 1000),
    PF_FIELD(map.border_px, 4, 64),
    PF_FIELD(capacity.mask, 0, INT32_MAX),
    PF_FIELD(capacity.max_imu_samples, 0, 10000),
};

constexpr double kTiny = 1e-9;
constexpr double kMaxWalk = 1e4;
constexpr Range kReals[] = {
    PF_FIELD(motion.linear_acceleration_density, kTiny, 1e4),
    PF_FIELD(motion.angular_acceleration_density, kTiny, 1e4),
    PF_FIELD(motion.linear_jerk_density, kTiny, 1e5),
    PF_FIELD(measurement.sigma_px, 0.01, 10),
    PF_FIELD(measurement.gate_probability, 0.9, 0.9999),
    PF_FIELD(first_depth.depth, 1e-4, 1e5),
    PF_FIELD(first_depth.relative_sigma, 0.05, 5),
    PF_FIELD(first_depth.linearity_index, 0.001, 1),
    PF_FIELD(map.max_misfit, 0.01, 100),
    PF_FIELD(plane.max_distance, 1e-5, 10),
    PF_FIELD(plane.max_radius, 0.01, 1e4),
    PF_FIELD(plane.roughness, 1e-6, 1),
    PF_FIELD(plane.fold_sigma, 1e-5, 10),
    PF_FIELD(plane.fix_sigma, 0, 10),
    PF_FIELD(motion.coast_s, 0.05, 10),
    PF_FIELD(motion.restart_s, 0, 1e4),
    PF_FIELD(imu.gyro_range, 0, 1000),
    PF_FIELD(imu.accel_range, 0, 1e5),
};

template <typename T>
T field_at(const pf_config_t& config, std::size_t offset) {
  T value;
  __builtin_memcpy(&value, reinterpret_cast<const char*>(&config) + offset, sizeof(T));
  return value;
}

constexpr Range kLens[] = {
    PF_FIELD(camera.sigma_focal, 1e-5, 0.2),
    PF_FIELD(camera.sigma_aspect, 1e-6, 0.2),
    PF_FIELD(camera.sigma_centre_px, 1e-3, 1e3),
};

constexpr Range kUnit[] = {
    PF_FIELD(imu.gyro_density, kTiny, 1), PF_FIELD(imu.accel_density, kTiny, 10), PF_FIELD(imu.gyro_walk, kTiny, 1),
    PF_FIELD(imu.accel_walk, kTiny, 10),  PF_FIELD(imu.delay_s, -0.5, 0.5),       PF_FIELD(imu.gravity, 9, 11),
};

constexpr Range kUnitSigmas[] = {
    PF_FIELD(imu.sigma_mount_rad, 1e-6, 4), PF_FIELD(imu.sigma_mount_m, 1e-6, 1),
    PF_FIELD(imu.sigma_delay_s, 1e-6, 0.2), PF_FIELD(imu.sigma_readout_s, 1e-6, 0.1),
    PF_FIELD(imu.sigma_scale, 1e-6, 0.05),
};

#undef PF_FIELD

constexpr int kMinFeaturesInView = 8;    // or none
constexpr int kMinMapRows = 6;           // of the state, behind the body: an anchor and a feature
constexpr int kMinImuSamples = 64;       // with the inertial motion model
constexpr double kMaxLever = 10;         // [m] between unit and camera
constexpr double kLongestReadout = 0.2;  // [s]
constexpr std::int32_t kScalar = sizeof(Scalar);

/// What is uncertain of the shape of its pictures. Null, or the name of the first field that makes no sense.
const char* shape_from(const pf_camera_t& c, const pf_config_t& config, LensSigmas* sigmas) {
  for (const Range& r : kLens) {
    const double value = field_at<double>(config, r.offset);
    if (!(value >= r.low && value <= r.high)) return r.name;
  }
  const int used = num_uncertain_distortion(static_cast<CameraModel>(c.model));
  for (int i = 0; i < 8; ++i) {
    const double sigma = c.sigma_distortion[i];
    if (!(sigma >= 0 && sigma <= 1) || (i >= used && sigma != 0)) return "camera.sigma_distortion";
    if (i < kLensDistortion) sigmas->distortion[i] = static_cast<Scalar>(sigma);
  }
  sigmas->focal = static_cast<Scalar>(c.sigma_focal);
  sigmas->aspect = static_cast<Scalar>(c.sigma_aspect);
  sigmas->centre = static_cast<Scalar>(c.sigma_centre_px);
  return nullptr;
}

/// What is uncertain of the camera. Null, or the name of the first field that makes no sense.
const char* lens_from(const pf_camera_t& c, const pf_config_t& config, Settings* settings) {
  if (c.estimate < PF_CAMERA_EXACT || c.estimate > PF_CAMERA_ESTIMATE) return "camera.estimate";
  settings->lens = LensPrior();
  LensSigmas sigmas;
  const char* bad = c.estimate == PF_CAMERA_EXACT ? nullptr : shape_from(c, config, &sigmas);
  if (bad != nullptr) return bad;
  if (config.motion.model == PF_MOTION_INERTIAL) sigmas.readout = static_cast<Scalar>(config.imu.sigma_readout_s);
  settings->lens = make_lens_prior(sigmas, &settings->camera);
  if (settings->lens.rows.count > 0 && config.backend != PF_BACKEND_WINDOW)
    settings->body.add_constant(BodyPart::kLens, settings->lens.rows.count, c.estimate == PF_CAMERA_CONSIDER);
  return nullptr;
}

/// The inertial unit. Null, or the name of the first field that makes no sense.
const char* unit_from(const pf_config_t& config, ImuUnit* unit, BodyLayout* layout) {
  if (config.motion.model != PF_MOTION_INERTIAL) return nullptr;
  if (config.capacity.max_imu_samples < kMinImuSamples) return "capacity.max_imu_samples";
  for (const Range& r : kUnit) {
    const double value = field_at<double>(config, r.offset);
    if (!(value >= r.low && value <= r.high)) return r.name;
  }
  const pf_imu_model_t& imu = config.imu;
  Quat q_BC;
  if (!quaternion_from(imu.q_BC, &q_BC)) return "imu.q_BC";
  if (!within(imu.p_BC, 3, kMaxLever)) return "imu.p_BC";
  unit->noise = {static_cast<Scalar>(imu.gyro_density), static_cast<Scalar>(imu.accel_density),
                 static_cast<Scalar>(imu.gyro_walk), static_cast<Scalar>(imu.accel_walk)};
  unit->mounting.R_CB = q_BC.conjugate().toRotationMatrix();
  unit->mounting.p_C = -(unit->mounting.R_CB * vec3(imu.p_BC));
  unit->delay_ns = static_cast<std::int64_t>(imu.delay_s * 1e9);
  unit->gravity = static_cast<Scalar>(imu.gravity);
  for (const Range& r : kUnitSigmas) {
    const double value = field_at<double>(config, r.offset);
    if (value != 0 && !(value >= r.low && value <= r.high)) return r.name;
  }
  unit->sigma_turn = static_cast<Scalar>(imu.sigma_mount_rad);
  unit->sigma_place = static_cast<Scalar>(imu.sigma_mount_m);
  unit->sigma_delay = static_cast<Scalar>(imu.sigma_delay_s);
  unit->sigma_scale = static_cast<Scalar>(imu.sigma_scale);
  unit->mounting.intrinsics.open = imu.sigma_scale > 0;
  layout->add_mounting(imu.sigma_mount_rad > 0, imu.sigma_mount_m > 0, imu.sigma_delay_s > 0);
  if (imu.sigma_scale > 0) layout->add_intrinsics();
  return nullptr;
}

/// capacity.max_places, or what stands for it where the config does not say.
int places_of(const pf_config_t& config) {
  constexpr int kOfWindow = 16;
  if (config.capacity.max_places >= 0) return config.capacity.max_places;
  return config.backend == PF_BACKEND_WINDOW ? kOfWindow : 0;
}

/// A field that needs a part which this build lacks: its name, with the CMake option of that part. Null: there is none.
const char* refused_by_build(const pf_config_t& config) {
  if (!kHasWindow && config.backend == PF_BACKEND_WINDOW) return "backend (built without PLANEFOLD_WINDOW)";
  if (!kHasInertial && config.motion.model == PF_MOTION_INERTIAL)
    return "motion.model (built without PLANEFOLD_INERTIAL)";
  if (!kHasWalls && config.capacity.max_patches > 0) return "capacity.max_patches (built without PLANEFOLD_WALLS)";
  if (!kHasMemory && config.capacity.max_places > 0) return "capacity.max_places (built without PLANEFOLD_MEMORY)";
  if (!kHasMemory && config.capacity.max_anchors > 0) return "capacity.max_anchors (built without PLANEFOLD_MEMORY)";
  if (!kHasMasks && config.map.masks != PF_MASKS_NONE) return "map.masks (built without PLANEFOLD_MASKS)";
  return nullptr;
}

/// Values and forms of planefold_research.h. Null, or the name of the first field that makes no sense or that only a config with research
/// may have.
const char* refused_of_research(const pf_config_t& config, const pf_research_t& research) {
  if (!holds_research(config)) {
    if (config.motion.model == PF_MOTION_CONSTANT_POSITION) return "motion.model";
    if (config.plane.fix == PF_FIX_ERROR_FREE) return "plane.fix";
    if (config.map.masks == PF_MASKS_WHOLE) return "map.masks";
    return nullptr;
  }
  if (research.keep_gauge != 0 && research.keep_gauge != 1) return "research.keep_gauge";
  if (research.gate_patches != 0 && research.gate_patches != 1) return "research.gate_patches";
  if (research.fold != PF_FOLD_CONDITION && research.fold != PF_FOLD_DROP) return "research.fold";
  if (!(research.linear_walk >= kTiny && research.linear_walk <= kMaxWalk)) return "research.linear_walk";
  if (!(research.angular_walk >= kTiny && research.angular_walk <= kMaxWalk)) return "research.angular_walk";
  return nullptr;
}

/// The motion model and what it needs. Null, or the name of the first field that makes no sense.
const char* motion_from(const pf_config_t& config, const pf_research_t& research, Settings* settings) {
  const bool accelerates = config.motion.model == PF_MOTION_CONSTANT_ACCELERATION;
  const bool moves = accelerates || config.motion.model == PF_MOTION_CONSTANT_VELOCITY;
  settings->constant_velocity = moves;
  settings->inertial = config.motion.model == PF_MOTION_INERTIAL;
  if (!moves && !settings->inertial && config.motion.model != PF_MOTION_CONSTANT_POSITION) return "motion.model";
  settings->body = accelerates          ? BodyLayout::with_constant_acceleration()
                   : moves              ? BodyLayout::with_constant_velocity()
                   : settings->inertial ? BodyLayout::with_inertial_unit()
                                        : BodyLayout::with_constant_position();
  const bool walks = !settings->body.has(BodyPart::kVelocity);
  settings->motion_noise.linear = static_cast<Scalar>(walks         ? research.linear_walk
                                                      : accelerates ? config.motion.linear_jerk_density
                                                                    : config.motion.linear_acceleration_density);
  settings->motion_noise.angular =
      static_cast<Scalar>(walks ? research.angular_walk : config.motion.angular_acceleration_density);
  return unit_from(config, &settings->unit, &settings->body);
}

/// Name of the first field that needs a feature which the window lacks, or null.
const char* refused_by_window(const pf_config_t& config) {
  if (config.backend != PF_BACKEND_WINDOW) return nullptr;
  if (config.motion.model == PF_MOTION_CONSTANT_ACCELERATION) return "motion.model";
  if (config.camera.estimate == PF_CAMERA_CONSIDER) return "camera.estimate";
  if (config.plane.fix_sigma > 0) return "plane.fix_sigma";
  if (config.capacity.max_patches > 0) return "capacity.max_patches";
  return nullptr;
}

}  // namespace

Status settings_from(const pf_config_t& config, Settings* settings, const char** field) {
  const char* dummy;
  if (field == nullptr) field = &dummy;
  *field = nullptr;
  if (config.size != sizeof(pf_config_t)) return *field = "size", Status::kVersion;
  if ((config.version ^ PF_VERSION) >> 8 != 0) return *field = "version", Status::kVersion;
  if (config.scalar != kScalar) return *field = "scalar", Status::kScalar;
  pf_research_t research;
  if (research_from(config, &research) != Status::kOk) return *field = "research", Status::kVersion;
  *field = refused_of_research(config, research);
  if (*field != nullptr) return Status::kConfig;
  for (const Range& r : kIntegers) {
    const double value = field_at<std::int32_t>(config, r.offset);
    if (!(value >= r.low && value <= r.high)) return *field = r.name, Status::kConfig;
  }
  for (const Range& r : kReals) {
    const double value = field_at<double>(config, r.offset);
    if (!(value >= r.low && value <= r.high)) return *field = r.name, Status::kConfig;
  }
  if (config.capacity.template_px % 2 == 0) return *field = "capacity.template_px", Status::kConfig;
  const bool has_window = config.backend == PF_BACKEND_WINDOW;
  const bool patches_alone = config.map.features_in_view == 0 && config.capacity.max_patches > 0 && !has_window;
  if (config.map.features_in_view > (has_window ? config.window.points : config.capacity.max_observations) ||
      (config.map.features_in_view < kMinFeaturesInView && !patches_alone))
    return *field = "map.features_in_view", Status::kConfig;
  *field = refused_by_build(config);
  if (*field != nullptr) return Status::kConfig;
  *field = refused_by_window(config);
  if (*field != nullptr) return Status::kConfig;
  *field = motion_from(config, research, settings);
  if (*field != nullptr) return Status::kConfig;
  if (config.plane.fix < PF_FIX_CONSIDER || config.plane.fix > PF_FIX_ERROR_FREE)
    return *field = "plane.fix", Status::kConfig;

  settings->kernels = select_kernels(static_cast<std::uint32_t>(config.kernels));
  if (settings->kernels == nullptr) return *field = "kernels", Status::kConfig;
  const pf_camera_t& c = config.camera;
  const double intrinsics[4] = {c.fx, c.fy, c.cx, c.cy};
  const char* bad = make_camera(c.model, c.width, c.height, intrinsics, c.distortion, &settings->camera);
  if (bad != nullptr) return *field = bad, Status::kConfig;
  if (config.capacity.mask != 0 && config.capacity.mask < c.width * c.height)
    return *field = "capacity.mask", Status::kConfig;
  settings->mask.is_asked_for = config.capacity.mask != 0;
  const bool moves = settings->body.has(BodyPart::kVelocity);
  if (!(c.readout_s >= 0 && c.readout_s <= (moves ? kLongestReadout : 0)))
    return *field = "camera.readout_s", Status::kConfig;
  bad = lens_from(c, config, settings);
  if (bad != nullptr) return *field = bad, Status::kConfig;
  if (settings->body.rows() + kMinMapRows > config.capacity.max_state_dim)
    return *field = "capacity.max_state_dim", Status::kConfig;
  if (c.timestamps != PF_TIMESTAMPS_REAL && c.timestamps != PF_TIMESTAMPS_NOMINAL)
    return *field = "camera.timestamps", Status::kConfig;
  // Rows depend on the camera's speeds, and these on the frames' times; with an inertial unit they depend on its samples.
  const bool timeless = c.timestamps == PF_TIMESTAMPS_NOMINAL && !settings->inertial;
  settings->camera.readout = timeless ? Scalar(0) : static_cast<Scalar>(c.readout_s);
  if (settings->lens.rows.has_readout()) {
    constexpr Scalar kStays[pf::kLensParameters] = {};
    move_lens(settings->lens.rows, kStays, &settings->camera);  // as every step of it, to one that is possible
  }
  settings->readout_ignored = timeless && c.readout_s > 0;

  settings->backend = static_cast<BackEnd>(config.backend);
  settings->window_keyframes = static_cast<std::uint8_t>(config.window.keyframes);
  settings->window_fixed = static_cast<std::uint8_t>(config.window.fixed_keyframes);
  settings->max_state_dim = config.capacity.max_state_dim;
  settings->max_features = has_window ? config.window.points : config.capacity.max_features;
  settings->max_observations = config.capacity.max_observations;
  settings->max_planes = config.capacity.max_planes;
  settings->kept.views = config.capacity.max_kept_views;
  // What a mask has learnt of a template goes with its point.
  const bool has_places = kHasMemory && config.map.masks == PF_MASKS_NONE;
  settings->kept.places = has_places ? places_of(config) : 0;
  settings->kept.anchors = config.capacity.max_anchors;
  settings->max_patches = static_cast<std::uint8_t>(config.capacity.max_patches);
  settings->patch_side_px = static_cast<std::uint8_t>(config.capacity.patch_side_px);
  settings->max_cameras = static_cast<std::uint8_t>(config.capacity.max_cameras);
  settings->template_px = static_cast<std::uint8_t>(config.capacity.template_px);
  settings->masks = static_cast<MaskMode>(config.map.masks);
  settings->max_misfit = static_cast<float>(config.map.max_misfit);
  settings->planes = config.plane.enabled != 0;
  settings->plane_min_points = config.plane.min_points;
  settings->plane_distance = static_cast<Scalar>(config.plane.max_distance);
  settings->plane_radius = static_cast<Scalar>(config.plane.max_radius);
  settings->fold_sigma = static_cast<Scalar>(config.plane.fold_sigma);
  settings->fix_sigma = static_cast<Scalar>(config.plane.fix_sigma);
  // chi-square with one degree of freedom: 1 % of the points of a plane stay out
  settings->fold = {static_cast<Scalar>(config.plane.roughness), Scalar(6.63), research.fold == PF_FOLD_CONDITION};
  settings->fix = config.plane.fix == PF_FIX_CONSIDER  ? FixForm::kConsider
                  : config.plane.fix == PF_FIX_INFLATE ? FixForm::kInflate
                                                       : FixForm::kErrorFree;
  settings->sigma_px = static_cast<Scalar>(config.measurement.sigma_px);
  // chi-square with two degrees of freedom: P(d2 < gate) = 1 - exp(-gate / 2)
  settings->gate = static_cast<Scalar>(-2.0 * std::log(1.0 - config.measurement.gate_probability));
  settings->start_depth = static_cast<Scalar>(config.first_depth.depth);
  settings->depth_from_map = config.first_depth.from_map != 0;
  settings->inverse_depth_relative_sigma = static_cast<Scalar>(config.first_depth.relative_sigma);
  settings->linearity_index = static_cast<Scalar>(config.first_depth.linearity_index);
  settings->features_in_view = config.map.features_in_view;
  settings->min_inliers = std::clamp<int>(config.map.features_in_view / 2, tuning::tracking::kMinInliersOfFew,
                                          tuning::tracking::kMinInliers);
  settings->border_px = config.map.border_px;
  settings->max_coast_ns = static_cast<std::int64_t>(config.motion.coast_s * 1e9);
  settings->restart_ns = static_cast<std::int64_t>(config.motion.restart_s * 1e9);
  settings->research = {research.keep_gauge != 0, research.gate_patches != 0};
  settings->imu.buffer = config.capacity.max_imu_samples;
  settings->imu.ranges = {static_cast<Scalar>(config.imu.gyro_range), static_cast<Scalar>(config.imu.accel_range)};
  settings->hooks.clock_ns = config.clock_ns;
  settings->hooks.log = config.log;
  settings->hooks.user = config.user;
  return Status::kOk;
}

}  // namespace pf

std::uint32_t pf_version() { return PF_VERSION; }

pf_status_t pf_config_default(pf_config_t* config) {
  if (config == nullptr) return PF_ERROR_NULL;
  *config = pf_config_t();
  config->size = sizeof(pf_config_t);
  config->version = PF_VERSION;
  config->scalar = pf::kScalar;
  config->kernels = PF_KERNELS_AUTO;
  config->capacity.max_state_dim = 300;
  config->capacity.max_features = 100;
  config->capacity.max_observations = 60;
  config->capacity.max_planes = 8;
  config->capacity.max_kept_views = 24;
  config->capacity.max_patches = 0;
  config->capacity.patch_side_px = 100;
  config->capacity.max_cameras = 8;
  config->capacity.template_px = pf::PlanarTemplate::kDefaultSide;
  config->backend = PF_BACKEND_FILTER;
  config->window.keyframes = 3;
  config->window.fixed_keyframes = 5;
  config->window.points = 300;
  config->plane.enabled = 1;
  config->plane.min_points = 7;
  config->plane.max_distance = 0.01;
  config->plane.max_radius = 1.5;
  config->plane.roughness = 0.002;
  config->plane.fold_sigma = 0.05;
  config->plane.fix_sigma = 0;
  config->plane.fix = PF_FIX_CONSIDER;
  config->motion.model = PF_MOTION_CONSTANT_VELOCITY;
  config->motion.linear_acceleration_density = 1.0;
  config->motion.angular_acceleration_density = 2.0;
  config->motion.linear_jerk_density = 10.0;
  config->measurement.sigma_px = 0.1;
  config->measurement.gate_probability = 0.99;
  config->first_depth.depth = 1.0;
  config->first_depth.from_map = 1;
  config->first_depth.relative_sigma = 2.0;
  config->first_depth.linearity_index = 0.1;
  config->map.features_in_view = 45;
  config->map.border_px = 8;
  config->map.masks = PF_MASKS_NONE;
  config->map.max_misfit = 2;
  config->motion.coast_s = 1.0;
  config->motion.restart_s = 3.0;
  config->capacity.max_imu_samples = 0;
  config->capacity.mask = 0;
  config->capacity.max_places = pf::kHasMemory ? -1 : 0;
  config->capacity.max_anchors = pf::kHasMemory ? 8 : 0;
  config->imu.gyro_range = 0;
  config->imu.accel_range = 0;
  config->imu.q_BC[0] = 1;
  config->imu.gravity = 9.81;
  return PF_OK;
}

pf_status_t pf_config_check(const pf_config_t* config, const char** field) {
  if (config == nullptr) return PF_ERROR_NULL;
  pf::Settings settings;
  return pf::to_c(pf::settings_from(*config, &settings, field));
}
