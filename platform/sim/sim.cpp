#include "planefold_platform/sim.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include "sim/imu.h"
#include "sim/paths.h"
#include "sim/render.h"
#include "sim/scene_box.h"
#include "sim/scene_loop.h"
#include "sim/scene_road.h"
#include "sim/scene_street.h"
#include "sim/sensor.h"
#include "sim/trajectory.h"

using namespace pf::sim;

namespace {

/// A scene: what there is to see, the way through it, how long that takes, and what of the options is its own.
struct SceneKind {
  const char* name;
  Scene (*make)(Random&, const SceneOptions&);
  Trajectory (*path)(Random&);
  int frames;
  void (*adjust)(pf_sim_options_t*);
};

Trajectory turning_path(Random& way) {
  return turning({look_along({0, 0.05, 1}, {0, 1, 0}), {0.02, -0.05, -0.7}}, way, 0.5, 0.15, 10.0);
}
Trajectory circle_path(Random&) { return box_circle(kBoxSeconds, 0); }

Trajectory street_path(Random&) { return street_walk(); }

/// A camera that walks around a wall or along it, and no target.
void adjust_walk(pf_sim_options_t* o) {
  constexpr double kFocal = 601.8;  // 56 degrees across
  o->camera.width = 640;
  o->camera.height = 480;
  o->camera.fx = o->camera.fy = kFocal;
  o->camera.cx = 319.5;
  o->camera.cy = 239.5;
  o->target = 0;
  o->shake_m = o->shake_rad = 0.01;
}

/// A camera that rides past a target.
void adjust_ride(pf_sim_options_t* o) {
  constexpr double kFocal = 300.9;  // 56 degrees across
  o->camera.fx = o->camera.fy = kFocal;
  o->shake_m = 0.005;
}

const SceneKind kScenes[] = {
    {"desk", make_desk, desk_path, 570, nullptr},
    {"room", make_room, room_path, 840, nullptr},
    {"corridor", make_corridor, corridor_path, 480, nullptr},
    {"wall", make_wall, wall_path, 390, nullptr},
    {"rotation", make_desk, turning_path, 300, [](pf_sim_options_t* o) { o->shake_m = 0; }},
    {"person", make_room, room_path, 840, [](pf_sim_options_t* o) { o->person = 1; }},
    {"exposure", make_desk, desk_path, 570, [](pf_sim_options_t* o) { o->exposure_step = 1.6; }},
    {"repeat", make_desk, desk_path, 570, [](pf_sim_options_t* o) { o->repeated_texture = 1; }},
    {"box", make_box, circle_path, 930, adjust_walk},
    {"street", make_street, street_path, 1800, adjust_walk},
    {"checker", make_two_depths, checker_path, 50, [](pf_sim_options_t* o) { o->shake_m = o->shake_rad = 0; }},
    {"clutter", make_clutter, clutter_path, 240, nullptr},
    {"bushes", make_bushes, bushes_path, 600, nullptr},
    {"road", make_road, road_path, 600, adjust_ride},
    {"equal-room", make_equal_room, room_path, 840, [](pf_sim_options_t* o) { o->target = 0; }},
    {"loop", make_loop, loop_path, kLoopFrames, [](pf_sim_options_t* o) { o->noise_grey = 5; }},
    {"equal-doors", make_equal_doors, corridor_path, 480, [](pf_sim_options_t* o) { o->target = 0; }},
};

const SceneKind* find_scene(const char* name) {
  const auto found = std::find_if(std::begin(kScenes), std::end(kScenes),
                                  [&](const SceneKind& s) { return std::string(s.name) == name; });
  return found == std::end(kScenes) ? nullptr : found;
}

enum Stream : std::uint64_t { kSceneStream, kPathStream, kNoiseStream, kFaultStream, kGainStream, kBiasStream };

constexpr double kUnderWay = 0.5;  // from rest to the path's own speed [s]

Pose view_from(const pf_pose_t& pose) { return {rotation_of(pose.q_WC), {pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]}}; }

bool in_range(double v, double low, double high) { return v >= low && v <= high; }

bool valid(const pf_sim_options_t& o) {
  const double period = 1.0 / o.rate_hz;
  return o.camera.width >= 16 && o.camera.height >= 16 && o.camera.width <= 4096 && o.camera.height <= 4096 &&
         o.camera.fx > 0 && o.camera.fy > 0 && o.frames >= 1 && o.frames <= 1000000 && in_range(o.rate_hz, 1, 1000) &&
         o.samples >= 1 && o.samples <= 8 && in_range(o.noise_grey, 0, 50) && in_range(o.exposure_s, 0, period) &&
         o.blur_samples >= 1 && o.blur_samples <= 64 && in_range(o.readout_s, 0, period) && in_range(o.gain, 0, 100) &&
         in_range(o.bias, -255, 255) && in_range(o.exposure_step, 1, 100) && o.exposure_every > 0 &&
         in_range(o.vignetting, 0, 1) && in_range(o.drop_probability, 0, 0.9) &&
         in_range(o.repeat_probability, 0, 0.9) && in_range(o.shake_m, 0, 1) && in_range(o.shake_rad, 0, 1) &&
         in_range(o.rest_s, 0, 1000) && in_range(o.swing_rad_s, 0, 20) &&
         (o.swing_rad_s == 0 ||
          (in_range(o.swing_from_s, 0, 1e6) && in_range(o.swing_to_s, o.swing_from_s + kSwingPeriod, 1e6)));
}

}  // namespace

struct pf_sim {
  pf_sim_options_t options;
  Scene scene;
  Trajectory path;
  std::unique_ptr<Renderer> renderer;
  std::unique_ptr<Sensor> sensor;
  Random noise{0}, fault{0};
  int frame = 0;
  std::vector<float> light;
  std::vector<std::uint8_t> grey;

  std::int64_t time_of(int k) const { return static_cast<std::int64_t>(std::llround(k * 1e9 / options.rate_hz)); }

  Scene scene_at(double t) const {
    Scene s = scene;
    if (s.person >= 0) {
      // There and back again.
      const double span = 20.0, phase = std::fmod(t, 2 * span);
      const double walked = phase < span ? phase : 2 * span - phase;
      Quad& q = s.quads[static_cast<std::size_t>(s.person)];
      q.corner_W = s.person_start_W + s.person_velocity_W * walked;
      q.corner_W.y += 0.02 * std::sin(9.0 * t);
    }
    return s;
  }

  double gain_at(double t) const {
    if (options.exposure_step <= 1) return options.gain;
    const auto k = static_cast<std::uint64_t>(t / options.exposure_every);
    if (k == 0) return options.gain;
    Random random(options.seed + 7919 * k, kGainStream);
    return options.gain * std::pow(options.exposure_step, random.uniform(-1, 1));
  }

  void fill(pf_image_t& image, std::int64_t t_ns) const {
    image = {grey.data(), options.camera.width, options.camera.height, options.camera.width, t_ns};
  }

  void draw(double t) {
    light.assign(light.size(), 0.0f);
    const auto rows = static_cast<std::size_t>(options.camera.height);
    for (int b = 0; b < options.blur_samples; ++b) {
      const double sub = t + options.exposure_s * ((b + 0.5) / options.blur_samples - 0.5);
      std::vector<Pose> poses;
      if (options.readout_s > 0)
        for (std::size_t j = 0; j < rows; ++j)
          poses.push_back(
              path(sub + options.readout_s * ((static_cast<double>(j) + 0.5) / static_cast<double>(rows) - 0.5)));
      else
        poses.push_back(path(sub));
      renderer->render(scene_at(sub), poses, 1.0f / static_cast<float>(options.blur_samples), light);
    }
    sensor->expose(light, gain_at(t), options.bias, options.noise_grey, noise, grey);
  }

  /// One view for all rows or one for each, without noise and blur.
  void draw_from(const std::vector<Pose>& views, std::int64_t t_ns, pf_image_t* image) {
    light.assign(light.size(), 0.0f);
    renderer->render(scene_at(static_cast<double>(t_ns) * 1e-9), views, 1.0f, light);
    sensor->expose(light, options.gain, options.bias, 0, noise, grey);
    fill(*image, t_ns);
  }
};

extern "C" {

const char* pf_sim_scene_name(int32_t index) {
  return index >= 0 && index < static_cast<int32_t>(std::size(kScenes)) ? kScenes[index].name : nullptr;
}

pf_status_t pf_sim_options_default(const char* scene, pf_sim_options_t* options) {
  if (!scene || !options) return PF_ERROR_NULL;
  const SceneKind* kind = find_scene(scene);
  if (!kind) return PF_ERROR_RANGE;
  *options = {};
  options->seed = 1;
  options->camera = {PF_CAMERA_PINHOLE,  320,  240,   205.0, 205.0, 159.5, 119.5, {}, 0, PF_CAMERA_EXACT,
                     PF_TIMESTAMPS_REAL, 0.01, 0.001, 3.2,   {0.05}};
  options->rate_hz = 30;
  options->frames = kind->frames;
  options->samples = 2;
  options->noise_grey = 2;
  options->exposure_s = 0.006;
  options->blur_samples = 1;
  options->gain = 1;
  options->exposure_step = 1;
  options->exposure_every = 2;
  options->vignetting = 0.1;
  options->target = 1;
  options->shake_m = 0.003;
  options->shake_rad = 0.006;
  if (kind->adjust) kind->adjust(options);
  return PF_OK;
}

pf_sim_t* pf_sim_open(const char* scene, const pf_sim_options_t* options) {
  pf_sim_options_t own;
  if (pf_sim_options_default(scene, &own) != PF_OK) return nullptr;
  if (options) own = *options;
  if (!valid(own)) return nullptr;
  const SceneKind& kind = *find_scene(scene);
  auto sim = std::make_unique<pf_sim>();
  sim->options = own;
  const SceneOptions what{own.target != 0, own.repeated_texture != 0, own.person != 0};
  Random scenery(own.seed, kSceneStream), way(own.seed, kPathStream);
  sim->scene = kind.make(scenery, what);
  sim->path = kind.path(way);
  sim->path = shaken(std::move(sim->path), way, own.shake_m, own.shake_rad);
  if (own.rest_s > 0) sim->path = after_rest(std::move(sim->path), own.rest_s, kUnderWay);
  if (own.swing_rad_s > 0)
    sim->path = swinging(std::move(sim->path), own.swing_from_s, own.swing_to_s, own.swing_rad_s);
  sim->renderer = std::make_unique<Renderer>(own.camera, own.samples);
  if (!sim->renderer->ok()) return nullptr;
  sim->sensor = std::make_unique<Sensor>(own.camera.width, own.camera.height, own.vignetting);
  sim->light.resize(static_cast<std::size_t>(own.camera.width) * static_cast<std::size_t>(own.camera.height));
  pf_sim_rewind(sim.get());
  return sim.release();
}

void pf_sim_close(pf_sim_t* sim) { delete sim; }

void pf_sim_camera(const pf_sim_t* sim, pf_camera_t* camera) {
  *camera = sim->options.camera;
  camera->readout_s = sim->options.readout_s;
  camera->sigma_focal = 1e-5;
  camera->sigma_aspect = 1e-6;
  camera->sigma_centre_px = 1e-3;
  std::fill(std::begin(camera->sigma_distortion), std::end(camera->sigma_distortion), 0.0);
}

void pf_sim_rewind(pf_sim_t* sim) {
  sim->frame = 0;
  sim->noise = Random(sim->options.seed, kNoiseStream);
  sim->fault = Random(sim->options.seed, kFaultStream);
}

void pf_sim_pose_at(const pf_sim_t* sim, int64_t t_ns, pf_pose_t* pose) {
  const double t = static_cast<double>(t_ns) * 1e-9;
  const Pose p = sim->path(t);
  Vec3 v, w;
  velocities(sim->path, t, v, w);
  *pose = {};
  pose->t_ns = t_ns;
  const auto q = quaternion_of(p.R_WC);
  std::copy(q.begin(), q.end(), pose->q_WC);
  const double numbers[9] = {p.p_WC.x, p.p_WC.y, p.p_WC.z, v.x, v.y, v.z, w.x, w.y, w.z};
  std::copy(numbers, numbers + 3, pose->p_WC);
  std::copy(numbers + 3, numbers + 6, pose->v_W);
  std::copy(numbers + 6, numbers + 9, pose->w_C);
}

int pf_sim_next(pf_sim_t* sim, pf_image_t* image, pf_pose_t* truth) {
  const pf_sim_options_t& o = sim->options;
  bool dropped, repeated;
  do {
    if (sim->frame >= o.frames) return 0;
    // The first frame always comes, and is always new.
    dropped = sim->fault.uniform() < o.drop_probability && sim->frame > 0;
    repeated = sim->fault.uniform() < o.repeat_probability && sim->frame > 0;
    ++sim->frame;
  } while (dropped);
  const std::int64_t t_ns = sim->time_of(sim->frame - 1);
  if (!repeated) sim->draw(static_cast<double>(t_ns) * 1e-9);
  sim->fill(*image, t_ns);
  if (truth) pf_sim_pose_at(sim, t_ns, truth);
  return 1;
}

pf_status_t pf_sim_target(const pf_sim_t* sim, uint32_t kind, pf_target_t* target) {
  if (!(sim->scene.target_width > 0)) return PF_ERROR_STATE;
  if (kind != PF_TARGET_RECTANGLE && kind != PF_TARGET_POINTS) return PF_ERROR_RANGE;
  *target = {};
  target->kind = kind;
  target->width = sim->scene.target_width;
  target->height = sim->scene.target_height;
  target->sigma = 0.0005;
  if (kind == PF_TARGET_RECTANGLE) return PF_OK;
  target->count = 4;
  for (int k = 0; k < 4; ++k) {
    target->points_W[k][0] = (k == 1 || k == 2 ? 0.5 : -0.5) * target->width;
    target->points_W[k][1] = (k >= 2 ? 0.5 : -0.5) * target->height;
  }
  pf_sim_pose_at(sim, 0, &target->first_pose);
  const double degree = 3.14159265358979 / 180;
  for (int k = 0; k < 6; ++k) target->first_pose.covariance[7 * k] = k < 3 ? 4 * degree * degree : 9e-4;
  return PF_OK;
}

pf_status_t pf_sim_render(pf_sim_t* sim, const pf_pose_t* pose, pf_image_t* image) {
  sim->draw_from({view_from(*pose)}, pose->t_ns, image);
  return PF_OK;
}

pf_status_t pf_sim_render_rows(pf_sim_t* sim, const pf_pose_t* poses, pf_image_t* image) {
  const int rows = sim->options.camera.height;
  std::vector<Pose> views;
  for (int j = 0; j < rows; ++j) views.push_back(view_from(poses[j]));
  sim->draw_from(views, poses[rows / 2].t_ns, image);
  return PF_OK;
}

pf_status_t pf_sim_depth(const pf_sim_t* sim, const pf_pose_t* pose, float* depth, int32_t* surface) {
  const Pose view = view_from(*pose);
  std::vector<float> d;
  std::vector<std::int32_t> s;
  sim->renderer->truth(sim->scene_at(static_cast<double>(pose->t_ns) * 1e-9), view, depth ? &d : nullptr,
                       surface ? &s : nullptr);
  if (depth) std::copy(d.begin(), d.end(), depth);
  if (surface) std::copy(s.begin(), s.end(), surface);
  return PF_OK;
}

pf_status_t pf_sim_surface(const pf_sim_t* sim, int32_t surface, double n_W[3], double* d_W) {
  if (surface < 0 || static_cast<std::size_t>(surface) >= sim->scene.quads.size()) return PF_ERROR_RANGE;
  const Quad& q = sim->scene.quads[static_cast<std::size_t>(surface)];
  const Vec3 n = q.normal_W();
  n_W[0] = n.x;
  n_W[1] = n.y;
  n_W[2] = n.z;
  *d_W = n.dot(q.corner_W);
  return PF_OK;
}

struct pf_sim_imu {
  ImuSensor sensor;
};

void pf_sim_imu_options_default(pf_sim_imu_options_t* options) {
  const ImuOptions unit;
  *options = {};
  options->seed = 1;
  options->rate_hz = unit.rate_hz;
  options->sigma_gyro_bias = 0.02;
  options->sigma_accel_bias = 0.1;
  pf_imu_model_t& model = options->model;
  model.gyro_density = unit.gyro_density;
  model.accel_density = unit.accel_density;
  model.gyro_walk = unit.gyro_walk;
  model.accel_walk = unit.accel_walk;
  const auto q = quaternion_of(rotation_exp({0.02, -0.03, 1.55}));
  std::copy(q.begin(), q.end(), model.q_BC);
  model.p_BC[0] = 0.05;
  model.p_BC[1] = -0.02;
  model.p_BC[2] = 0.03;
  model.gravity = unit.gravity_W.y;
}

pf_sim_imu_t* pf_sim_imu_open(const pf_sim_t* sim, const pf_sim_imu_options_t* options) {
  pf_sim_imu_options_t o;
  pf_sim_imu_options_default(&o);
  if (options) o = *options;
  const pf_imu_model_t& model = o.model;
  if (!in_range(o.rate_hz, 20, 2000) || !in_range(model.gravity, 9, 11) || !in_range(model.delay_s, -0.5, 0.5) ||
      !in_range(o.jitter_s, 0, 0.25 / o.rate_hz) || !in_range(o.gyro_scale, -0.5, 0.5) ||
      !in_range(o.accel_scale, -0.5, 0.5))
    return nullptr;
  ImuOptions unit;
  Random bias(o.seed, kBiasStream);
  unit.rate_hz = o.rate_hz;
  unit.gyro_density = model.gyro_density;
  unit.accel_density = model.accel_density;
  unit.gyro_walk = model.gyro_walk;
  unit.accel_walk = model.accel_walk;
  unit.gyro_bias = bias.normal3() * o.sigma_gyro_bias;
  unit.accel_bias = bias.normal3() * o.sigma_accel_bias;
  unit.R_BC = rotation_of(model.q_BC);
  unit.p_BC = {model.p_BC[0], model.p_BC[1], model.p_BC[2]};
  unit.gravity_W = {0, model.gravity, 0};
  unit.delay_s = model.delay_s;
  unit.seed = o.seed;
  unit.gyro_scale = o.gyro_scale;
  unit.accel_scale = o.accel_scale;
  unit.gyro_range = model.gyro_range;
  unit.accel_range = model.accel_range;
  unit.jitter_s = o.jitter_s;
  unit.gap_at_s = o.gap_at_s;
  unit.gap_s = o.gap_s;
  return new (std::nothrow) pf_sim_imu{ImuSensor(unit, sim->path)};
}

void pf_sim_imu_close(pf_sim_imu_t* imu) { delete imu; }

int64_t pf_sim_imu_next_ns(const pf_sim_imu_t* imu) { return imu->sensor.next_ns(); }

void pf_sim_imu_next(pf_sim_imu_t* imu, pf_imu_sample_t* sample) { *sample = imu->sensor.next(); }

void pf_sim_imu_biases(const pf_sim_imu_t* imu, double gyro[3], double accel[3]) {
  const Vec3 g = imu->sensor.gyro_bias(), a = imu->sensor.accel_bias();
  const double numbers[6] = {g.x, g.y, g.z, a.x, a.y, a.z};
  std::copy(numbers, numbers + 3, gyro);
  std::copy(numbers + 3, numbers + 6, accel);
}

}  // extern "C"
