/* Rendered scenes with exact truth, for tests, the demo and experiments.
 *
 *   pf_sim_options_t options;
 *   pf_sim_options_default("desk", &options);      every field gets the scene's own value
 *   pf_sim_t *sim = pf_sim_open("desk", &options); null: no such scene, bad option, no memory
 *   pf_sim_camera(sim, &config.camera);
 *   pf_sim_target(sim, PF_TARGET_RECTANGLE, &target);
 *   while (pf_sim_next(sim, &image, &truth)) pf_push_frame(slam, &image);
 *   pf_sim_close(sim);
 *
 * Scenes: desk      hand-held look around a desk that carries the target
 *         room      the same through a room of 4 m
 *         corridor  17 m with posters and doors, walked along
 *         wall      one textured wall
 *         rotation  the camera only turns (no depth can be known)
 *         person    the room, with somebody walking through the picture
 *         exposure  the desk, with exposure that jumps
 *         repeat    the desk, with texture that repeats
 *         box       a box of 1 m with posters on its sides, circled at 2 m; no target
 *         street    72 m along fronts with pillars, signs and parked boxes before them; no target
 *         checker   two planes in a checkerboard, one before the other; the camera moves sideways
 *         clutter   boards and posts at many depths before a wall
 *         bushes    leaves anywhere in a volume: no plane
 *         road      72 m past poles, parked boxes and fronts
 *         equal-room    a room whose four walls look the same; no target
 *         equal-doors   a corridor whose walls repeat every 2 m; no target
 *         loop      a ring of corridors, walked once around and on along its beginning: 25 m and 5 m
 *
 * W is the centre of the target: x right, y down, z into the wall; of the box, its middle; of the street, where the camera
 * begins. The same seed and options give the same pixels.
 * Units: metres, seconds, grey levels 0..255.
 */
#ifndef PLANEFOLD_PLATFORM_SIM_H
#define PLANEFOLD_PLATFORM_SIM_H

#include "planefold/planefold.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pf_sim pf_sim_t;

typedef struct pf_sim_options {
  uint64_t seed;
  pf_camera_t camera; /* any of the four models */
  int32_t frames;     /* of the whole run, dropped ones included, 1 .. 1000000 */
  double rate_hz;     /* 1 .. 1000 */
  int32_t samples;    /* per pixel and direction, 1 .. 8; 2 is smooth, 1 is fast */

  /* The sensor. */
  double noise_grey;     /* standard deviation of a pixel, 0 .. 50 */
  double exposure_s;     /* 0 .. 1/rate; blurs what moves if blur_samples > 1 */
  int32_t blur_samples;  /* views averaged over the exposure, 1 .. 64; the timestamp is its middle */
  double readout_s;      /* rolling shutter: from first to last row, 0 .. 1/rate; the timestamp is the middle row's */
  double gain, bias;     /* grey = gain * scene + bias */
  double exposure_step;  /* gain jumps by up to this factor either way, >= 1; 1: never */
  double exposure_every; /* seconds between jumps, > 0 */
  double vignetting;     /* loss of light in the corners, 0 .. 1 */

  /* What goes wrong on the way. */
  double drop_probability;   /* the frame never comes, 0 .. 0.9 */
  double repeat_probability; /* the last picture comes again under a new time, 0 .. 0.9 */

  /* The scene. */
  int32_t target;            /* the dark rectangle is there */
  int32_t repeated_texture;  /* surfaces repeat a small cell */
  int32_t person;            /* somebody walks through */
  double shake_m, shake_rad; /* of the hand, standard deviations */
  double rest_s;             /* the camera stands still at first, then gets under way within half a second, 0 .. 1000 */
  /* The camera also swings left and right, to and fro within 0.8 s, at up to this rate .. */
  double swing_rad_s;              /* 0 .. 20; 0: it does not */
  double swing_from_s, swing_to_s; /* .. between these times, a swing or more apart, 0 .. 1e6 */
} pf_sim_options_t;

/* PF_ERROR_RANGE: there is no such scene. */
pf_status_t pf_sim_options_default(const char* scene, pf_sim_options_t* options);

/* Names of the scenes, null after the last. */
const char* pf_sim_scene_name(int32_t index);

/* options may be null for the scene's own. */
pf_sim_t* pf_sim_open(const char* scene, const pf_sim_options_t* options);
void pf_sim_close(pf_sim_t* sim);

/* A scene knows its lens: with the least standard deviations that a calibration may state. */
void pf_sim_camera(const pf_sim_t* sim, pf_camera_t* camera);

/* 1 and the next frame, or 0 at the end. The pixels stay valid until the next call. truth (may be null): the camera at
 * image->t_ns, with velocities and zero covariance. */
int pf_sim_next(pf_sim_t* sim, pf_image_t* image, pf_pose_t* truth);

/* Back to the first frame. */
void pf_sim_rewind(pf_sim_t* sim);

/* Truth at any time of the run. */
void pf_sim_pose_at(const pf_sim_t* sim, int64_t t_ns, pf_pose_t* pose);

/* The target as the library wants it: PF_TARGET_RECTANGLE, or PF_TARGET_POINTS with its corners and the true first pose
 * with a covariance of (2 degrees)^2 and (3 cm)^2. PF_ERROR_STATE: the scene has none. */
pf_status_t pf_sim_target(const pf_sim_t* sim, uint32_t kind, pf_target_t* target);

/* A picture from any pose, with the sensor's settings but no noise, blur or readout. The pixels stay valid until the next call. */
pf_status_t pf_sim_render(pf_sim_t* sim, const pf_pose_t* pose, pf_image_t* image);

/* The same through a rolling shutter: row i from poses[i], of which there are as many as rows. The scene and the image have the time of
 * the middle row's pose, poses[height / 2]. */
pf_status_t pf_sim_render_rows(pf_sim_t* sim, const pf_pose_t* poses, pf_image_t* image);

/* For each pixel's centre, seen from a pose at its t_ns: depth along z [m] (0: nothing) and the surface's number (-1:
 * nothing). Either may be null; both are width * height. */
pf_status_t pf_sim_depth(const pf_sim_t* sim, const pf_pose_t* pose, float* depth, int32_t* surface);

/* Plane of a surface, n . p = d in W, n towards what lies behind it. PF_ERROR_RANGE: no such surface. */
pf_status_t pf_sim_surface(const pf_sim_t* sim, int32_t surface, double n_W[3], double* d_W);

/* An inertial unit beside the camera. Its own axes are not the camera's; its seed stream is its own, so that pictures do not depend on it.
 *
 *   pf_sim_imu_options_t options;
 *   pf_sim_imu_options_default(&options);
 *   pf_sim_imu_t *imu = pf_sim_imu_open(sim, &options);      null: bad option, no memory
 *   config.imu = options.model;                              what a calibration would say
 *   while (pf_sim_imu_next_ns(imu) <= image.t_ns) { pf_sim_imu_next(imu, &sample); pf_push_imu(slam, &sample, 1); }
 */
typedef struct pf_sim_imu pf_sim_imu_t;

typedef struct pf_sim_imu_options {
  uint64_t seed;
  double rate_hz; /* 20 .. 2000. Default 200 */
  pf_imu_model_t
      model; /* noise, mounting, delay, gravity (along W's y); readings end at its ranges, where they are not 0 */
  double sigma_gyro_bias;         /* from which the biases at time 0 are drawn [rad/s] .. */
  double sigma_accel_bias;        /* .. [m/s^2] */
  double gyro_scale, accel_scale; /* relative errors of scale, -0.5 .. 0.5 */
  double jitter_s;                /* standard deviation of time stamps, 0 .. a quarter of the interval */
  double gap_at_s, gap_s;         /* no samples from here on for this long */
} pf_sim_imu_options_t;

/* Noise of EuRoC's unit, 6 cm beside the camera and rotated by 90 degrees about its axis. */
void pf_sim_imu_options_default(pf_sim_imu_options_t* options);

/* options may be null for the default. It lives as long as it likes, also without the scene. */
pf_sim_imu_t* pf_sim_imu_open(const pf_sim_t* sim, const pf_sim_imu_options_t* options);
void pf_sim_imu_close(pf_sim_imu_t* imu);

/* When the next sample is measured, on the clock of the frames; its own time stamp is model.delay_s before that. */
int64_t pf_sim_imu_next_ns(const pf_sim_imu_t* imu);
void pf_sim_imu_next(pf_sim_imu_t* imu, pf_imu_sample_t* sample);
/* The true biases at the sample that came last. */
void pf_sim_imu_biases(const pf_sim_imu_t* imu, double gyro[3], double accel[3]);

#ifdef __cplusplus
}
#endif

#endif
