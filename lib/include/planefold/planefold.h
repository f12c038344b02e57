/* planefold: a camera's pose and a map, from its frames, in one block of memory that the caller
 * owns.
 *
 *   pf_config_t config;
 *   pf_config_default(&config);              every field gets a value that works
 *   config.camera = ...;                     the calibration, which only you know
 *   pf_memory_query(&config, &need);         how many bytes
 *   pf_create(&config, block, bytes, &slam); uses your block; nothing is allocated, ever
 *   pf_push_frame(slam, &image);             once per frame
 *   pf_get_pose(slam, &pose);                where the camera is, with its covariance
 *
 * There is no destroy: forget the block when you are done. pf_reset() starts over in the same
 * block.
 *
 * FRAMES. W is the world, C the camera (x right, y down, z forward). p_W = R_WC p_C + p_WC. Pixels:
 * (0, 0) is the centre of the top-left one. Quaternions are (w, x, y, z), of unit length.
 * LENGTHS are in one unit throughout, written [m]. It is the unit of the target or of the start
 * pose: give those in metres. After a start with neither, no length is known: the unit is then the
 * one in which the features of the first frame have a median depth of first_depth.depth (default
 * 1).
 * ERRORS of a pose are (theta, p): R_true = Exp(theta) R, p_true = p + e, both in W.
 * COVARIANCES are row-major, finite and positive semidefinite. A row is zero only where something
 * is exactly known: where rounding has left nothing of a variance, or less, it is given as large as
 * rounding may be, and 1e12 stands for unknown.
 * UNITS. SI and radians. Times, pixels and angles in other units name them (_s, _ns, _px).
 * TYPES. In a structure, kinds and switches are int32_t, and the comment names the enum; a switch
 * is 0 or 1. Ids are uint32_t.
 *
 * STATUS. 0 is done. Positive: done, with something to know. Negative: rejected, and nothing was
 * changed. Any call can return PF_ERROR_NULL, PF_ERROR_CONTEXT and PF_ERROR_NONFINITE;
 * PF_ERROR_RANGE is also of positions and speeds above 1e6 and quaternions not of unit length;
 * other errors stand at the call.
 * THREADS. A context belongs to one thread at a time. Contexts are independent. There are no
 * globals.
 * TIME. Work per call is bounded by the capacities in the config. No clock is read unless you give
 * one.
 * STATES. Tracking means: a pose in this map that this frame's own measurements support, by at
 * least 8 gated inliers (half of map.features_in_view where that is less, 5 at least) that are
 * consistent beyond chance, or, in the frame of a start at a target, by the target; rotation sigma
 * below 20 degrees and position sigma below half the median depth, both against the points in view.
 * Otherwise the pose coasts, and nothing is added to the map until
 * it was found again; after motion.coast_s it is lost.
 * MAPS. There is one map at a time, with a map_id. If it is lost for motion.restart_s of usable
 * images, it is left and a new one begins: a new map_id, a new W, and, without a target in view, a
 * new unit of length. The window keeps the places of a map that is left (capacity.max_places):
 * where two views of the new map are recognised in it, the new map goes on in its W and unit, under
 * its map_id. Where a map goes on under another map_id, pf_report_t.correction_from_map_id names
 * the one before, and the correction is the way to the new W. With walls (pf_add_wall) a map is
 * searched for until it is found, and so is one that was loaded (pf_load_map).
 */
#ifndef PLANEFOLD_PLANEFOLD_H
#define PLANEFOLD_PLANEFOLD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PF_API __attribute__((visibility("default")))
#else
#define PF_API
#endif

#define PF_VERSION_MAJOR 0
#define PF_VERSION_MINOR 1
#define PF_VERSION_PATCH 0
#define PF_VERSION ((PF_VERSION_MAJOR << 16) | (PF_VERSION_MINOR << 8) | PF_VERSION_PATCH)

/* PF_VERSION of the library that is linked, which may be another patch release than this header's.
 * Patch releases of one minor version fit together; any other difference is PF_ERROR_VERSION. */
PF_API uint32_t pf_version(void);

/* -------------------------------------------------------------------------------- status -- */

typedef enum pf_status {
  PF_OK = 0,

  /* Taken. There is no pose yet, or known depths do not support it yet. Also after an estimate that
   * was no longer finite was discarded, and when a new map begins: a new start follows, with a new
   * W and a line in the log. */
  PF_NOTE_STARTING = 1,
  /* taken; too few measurements, the pose is a prediction with growing covariance */
  PF_NOTE_COASTING = 2,
  /* taken; the pose is no longer usable; the map is searched for in every frame (MAPS) */
  PF_NOTE_LOST = 3,
  /* taken; the image shows nothing usable (black, white, blurred, frozen); pose coasts */
  PF_NOTE_UNUSABLE = 4,
  /* done; there was more than your array holds; *count has the full number */
  PF_NOTE_TRUNCATED = 5,
  /* done; there is nothing (no plane under the pixel or with that id any more, no mark) */
  PF_NOTE_NOTHING = 6,

  PF_ERROR_NULL = -1,   /* a pointer that must not be null is null */
  PF_ERROR_CONFIG = -2, /* a field of the config is out of its range; pf_config_check names it */
  /* the structure's size or version belongs to another release of this header */
  PF_ERROR_VERSION = -3,
  /* the config was made for the other library (planefold: double, planefoldf: float) */
  PF_ERROR_SCALAR = -4,
  PF_ERROR_MEMORY = -5,    /* the block is smaller than pf_memory_query returned */
  PF_ERROR_ALIGNMENT = -6, /* the block does not begin at a multiple of pf_memory_t.alignment */
  PF_ERROR_SIZE = -7,      /* width, height or stride of the image do not fit the calibration */
  PF_ERROR_TIME = -8,      /* the timestamp is not after the last one */
  PF_ERROR_NONFINITE = -9, /* a number that was passed in is NaN or infinite */
  /* Not possible in this state (a start after the first frame; a pose before the start), or a call
   * that changes the context from inside its own log or clock. */
  PF_ERROR_STATE = -10,
  PF_ERROR_RANGE = -11,   /* a number that was passed in is outside of its domain */
  PF_ERROR_CONTEXT = -12, /* not a context, or one whose block was overwritten */
  /* there is no room for it, see capacity.max_state_dim, max_planes and max_anchors */
  PF_ERROR_FULL = -13,
  /* no saved map, or one that is damaged or of another format; the log has the reason */
  PF_ERROR_MAP = -14
} pf_status_t;

/* One line in English for a status; never null. */
PF_API const char* pf_status_text(pf_status_t status);

/* -------------------------------------------------------------------------------- camera -- */

typedef enum pf_camera_model {
  PF_CAMERA_PINHOLE = 1, /* no distortion */
  /* distortion = k1 k2 p1 p2 k3 (Brown-Conrady; OpenCV and ROS plumb_bob order) */
  PF_CAMERA_RADTAN = 2,
  PF_CAMERA_EQUIDISTANT = 3, /* distortion = k1 k2 k3 k4 (Kannala-Brandt; OpenCV fisheye) */
  /* distortion = k [1/px^2]: r_d = r_u / sqrt(1 + 2 k r_u^2), r in pixels (Harris; MonoSLAM) */
  PF_CAMERA_DIVISION = 4
} pf_camera_model_t;

/* How a context uses the numbers of a calibration (lib/docs/theory/lens.md). */
typedef enum pf_camera_estimate {
  PF_CAMERA_EXACT = 0, /* takes them as exact; the default */
  /* allows for their errors in every covariance, and does not correct them (Schmidt). Filter
   * only */
  PF_CAMERA_CONSIDER = 1,
  /* estimates them with pose and map: better wherever they are not measured well */
  PF_CAMERA_ESTIMATE = 2
} pf_camera_estimate_t;
/* Where the times of frames come from. */
typedef enum pf_timestamps {
  PF_TIMESTAMPS_REAL = 0, /* measured: when each image was exposed */
  /* counted: frame number over rate, as in many recordings, which know no lost frames */
  PF_TIMESTAMPS_NOMINAL = 1
} pf_timestamps_t;

typedef struct pf_camera {
  int32_t model;         /* pf_camera_model_t */
  int32_t width, height; /* [px] 32 .. 4096 */
  /* [px] fx from a tenth of the width to 20 widths, cx from one width to the left to two; the same
   * of fy and cy with the height */
  double fx, fy, cx, cy;
  /* In the order of the model; unused entries are zero. One to one in the inner half of the
   * image */
  double distortion[8];
  /* Rolling shutter: from the first row to the last, 0 .. 0.2; 0 is a global shutter. A frame has
   * the time of its middle row. 0 with PF_MOTION_CONSTANT_POSITION, which has no velocity. */
  double readout_s;

  /* How the numbers above are used, and how uncertain they are. Each uncertain one is a row of the
   * filter's state, up to nine (ten with imu.sigma_readout_s): count them in
   * capacity.max_state_dim. Only read where estimate is not PF_CAMERA_EXACT. */
  int32_t estimate; /* pf_camera_estimate_t */
  /* pf_timestamps_t. With nominal ones readout_s counts as 0, with a line in the log, since the
   * rows depend on a velocity that such times do not give. Not so with PF_MOTION_INERTIAL, where
   * they depend on the gyroscope. */
  int32_t timestamps;
  double sigma_focal;     /* of fx and fy together, relative: 1e-5 .. 0.2. Typical 0.01 */
  double sigma_aspect;    /* of fx against fy, relative: 1e-6 .. 0.2. Typical 0.001 */
  double sigma_centre_px; /* of cx and of cy, 0.001 .. 1000. Typical 0.01 of the width */
  /* Of each entry of distortion, 0 (exact) .. 1. A pinhole whose first one is not zero is a
   * radial-tangential camera with an uncertain k1. Typical 0.05 where no distortion was calibrated.
   * */
  double sigma_distortion[8];
} pf_camera_t;

/* Pixel of a point in C, z > 0 (equidistant: anywhere but the optical centre); it may lie outside
 * of the image. PF_ERROR_RANGE: behind the camera or where the model is not one to one.
 * PF_ERROR_CONFIG, here and below: camera is none. */
PF_API pf_status_t pf_camera_project(const pf_camera_t* camera, const double p_C[3],
                                     double pixel[2]);

/* Unit ray in C that projects to a pixel. PF_ERROR_RANGE where the model has none. */
PF_API pf_status_t pf_camera_unproject(const pf_camera_t* camera, const double pixel[2],
                                       double ray_C[3]);

/* -------------------------------------------------------------------------------- config -- */

typedef enum pf_motion_model {
  PF_MOTION_CONSTANT_VELOCITY = 1, /* white accelerations; the default */
  /* Translational acceleration and angular velocity constant in camera axes, with white jerk and
   * angular acceleration (Servant 2008, lib/docs/theory/servant2008.md). Three rows more in
   * capacity.max_state_dim. Filter only. */
  PF_MOTION_CONSTANT_ACCELERATION = 3,
  /* By the samples of pf_push_imu (lib/docs/theory/inertial.md). Needs imu and
   * capacity.max_imu_samples >= 64: as many samples as come in the longest time between frames that
   * is to be bridged. */
  PF_MOTION_INERTIAL = 4
} pf_motion_model_t;

typedef enum pf_kernels {
  PF_KERNELS_AUTO = 0, /* the fastest that this processor runs */
  PF_KERNELS_REFERENCE = 1,
  PF_KERNELS_PORTABLE = 2,
  PF_KERNELS_AVX2 = 3,
  PF_KERNELS_AVX512 = 4,
  PF_KERNELS_NEON = 5
} pf_kernels_t;

/* What becomes of a folded point that is known well enough among the others of its plane. */
typedef enum pf_fix {
  PF_FIX_CONSIDER = 1, /* keeps its covariance and is estimated no more (Schmidt) */
  /* leaves the state; its variance becomes noise of its pixels. Saves memory; overconfident */
  PF_FIX_INFLATE = 2
} pf_fix_t;

/* Templates that learn which of their pixels belong to their dominant plane
 * (lib/docs/theory/templates.md; Masoud 2015). */
typedef enum pf_masks {
  /* every pixel of a feature counts, and one in five may be wrong; the default */
  PF_MASKS_NONE = 0,
  /* a mask for each feature whose depth is known, and the normal of its plane */
  PF_MASKS_PARTIAL = 1
} pf_masks_t;

/* What estimates pose and map. */
typedef enum pf_backend {
  PF_BACKEND_FILTER = 1, /* a filter over pose, points and planes (Gee 2007); the default */
  /* Keyframes that are adjusted with the points that they see (lib/docs/theory/window.md; Masoud
   * 2015). PF_ERROR_CONFIG with motion.model constant acceleration, imu.sigma_readout_s above 0,
   * camera.estimate consider, plane.fix_sigma above 0 and capacity.max_patches above 0. The pose's
   * covariance takes the map's first keyframes as exact, those of points and planes all keyframes
   * and the lens. The block at its defaults is 2.4 MiB, with camera.estimate estimate 2.5. */
  PF_BACKEND_WINDOW = 2
} pf_backend_t;

typedef enum pf_scalar { PF_SCALAR_DOUBLE = 8, PF_SCALAR_FLOAT = 4 } pf_scalar_t;

/* The inertial unit of pf_push_imu. Its own axes are B. */
typedef struct pf_imu_model {
  double gyro_range;  /* that it can measure [rad/s], 0 (not known) .. 1000. Default 0 */
  double accel_range; /* [m/s^2] 0 (not known) .. 1e5. Default 0 */

  /* Only read with PF_MOTION_INERTIAL. Noise as Kalibr and EuRoC state it; no default fits a unit,
   * and less than 1e-9 is rejected. */
  double gyro_density;  /* white noise [rad/s/sqrt(Hz)], up to 1 */
  double accel_density; /* the same [m/s^2/sqrt(Hz)], up to 10 */
  double gyro_walk;     /* of its bias [rad/s^2/sqrt(Hz)], up to 1 */
  double accel_walk;    /* the same [m/s^3/sqrt(Hz)], up to 10 */
  /* Mounting, p_B = R_BC p_C + p_BC: EuRoC's T_BS of the camera, the inverse of Kalibr's T_cam_imu.
   * Default: axes and origin of the camera. */
  double q_BC[4]; /* w x y z */
  double p_BC[3]; /* [m] up to 10 each */
  double delay_s; /* t_frame = t_sample + delay, -0.5 .. 0.5. Default 0 */
  double gravity; /* [m/s^2] 9 .. 11. Default 9.81 */
  /* How far the mounting and the delay may be off, of each axis: standard deviations, from which
   * they are then estimated (pf_get_inertial). 0: taken as exact; else at least 1e-6. Defaults 0.
   * Axes above 0.2 and a delay above 0.02 are open: the camera moves as without a unit until its
   * rotations have fixed them, a second or two of rotating by hand. A delay is found within 0.2
   * s. */
  double sigma_mount_rad; /* of the unit's axes, up to 4 (any). Three rows of the state */
  double sigma_mount_m;   /* of its origin in C, up to 1. Three rows */
  /* Of the delay, up to 0.2. One row. A frame then depends on samples that may be as much later:
   * push those of up to three sigma behind its time before it, as far as they have come. */
  double sigma_delay_s;
  /* Of camera.readout_s, which may be 0 then; up to 0.1. One more row of the lens, which is
   * considered with PF_CAMERA_CONSIDER, and else estimated. It never falls below 0. */
  double sigma_readout_s;
  /* Of the scales of both sensors and of the directions of their axes, relative, up to 0.05: what
   * data sheets call sensitivity and cross-axis errors, 0.01 for a phone. 15 rows of the state */
  double sigma_scale;
} pf_imu_model_t;

/* Fill with pf_config_default, then change what you know better. pf_config_check names a bad field
 * as it is written here: "capacity.max_state_dim". */
typedef struct pf_config {
  uint32_t size;    /* sizeof(pf_config_t), set by pf_config_default */
  uint32_t version; /* PF_VERSION, set by pf_config_default */
  int32_t scalar;   /* pf_scalar_t of the library that filled this in */
  /* pf_kernels_t; a set that this processor cannot run is PF_ERROR_CONFIG. Default auto */
  int32_t kernels;

  pf_camera_t camera; /* no default: the calibration of your camera */

  int32_t backend; /* pf_backend_t. Default filter */

  /* The only fields, beside the image size, that change the memory. */
  struct {
    /* rows of the covariance, 32 .. 2000. Memory grows with its square. Default 300 */
    int32_t max_state_dim;
    int32_t max_features;     /* features in the map, 8 .. 1000. Default 100 */
    int32_t max_observations; /* features measured in one frame, 8 .. 200. Default 60 */
    int32_t max_planes;       /* planes in the map, 1 .. 64. Default 8 */
    int32_t max_imu_samples; /* inertial samples that are kept, the newest, 0 .. 10000. Default 0 */
    /* Views (thumbnails of tracked frames with their poses) by which a lost camera recognises where
     * it is, 0 .. 200, of about 1.3 kB each. 0: it searches about its last pose only. Default 24 */
    int32_t max_kept_views;
    /* Patches of known walls (pf_add_wall) that are followed in images, 0 .. 32, of at most 24 KiB
     * each. They are squares of patch_side_px pixels, 32 .. 128, and less where a wall is seen at a
     * slant. A patch takes eight rows of the state, and the camera that first saw it six, which is
     * shared by all that began in its frame: of such cameras there are at most max_cameras, 0 ..
     * 64. Defaults 0 (none), 100, 8 */
    int32_t max_patches, patch_side_px, max_cameras;
    /* Side of a feature's template with map.masks, odd, 9 .. 31 px; without, it takes no memory.
     * Default 15 */
    int32_t template_px;
    /* Pixels of the mask that pf_set_mask may set: 0 (none), or camera.width * camera.height at
     * least. It is kept as one bit for 4x4 of them: 2.4 kB for 640x480. Default 0 */
    int32_t mask;
    /* Places: cameras that are kept with up to 24 points and their appearance, by which a lost
     * camera finds itself, and of which a saved map is made (MAPS). With PF_BACKEND_WINDOW a camera
     * that comes back to one corrects what the map has drifted since. 0 .. 200, of 16 kB each and
     * 150 kB for all (filter: 15 and 90); -1: 16 with PF_BACKEND_WINDOW, and none with the filter.
     * None in any case with map.masks. Default -1 */
    int32_t max_places;
    /* Anchors (pf_add_anchor_hit), 0 .. 64, of about 1.5 kB each. Default 8 */
    int32_t max_anchors;
  } capacity;

  /* Capacities of PF_BACKEND_WINDOW, of no meaning with the filter. With the window, max_state_dim,
   * max_features, max_observations, max_patches and max_cameras above take nothing. */
  struct {
    /* Keyframes that are adjusted together while a start without a target still improves its first
     * depths, 2 .. 8, and older ones that see the same points and are held fixed then, 0 .. 16.
     * Afterwards all but the oldest are adjusted. Defaults 3, 5 */
    int32_t keyframes, fixed_keyframes;
    int32_t points; /* in the map, 50 .. 1000. Default 300 */
  } window;

  /* How the camera may move between frames. Densities are those of white noise: over a time dt the
   * velocity's variance grows by density^2 dt. */
  struct {
    int32_t model;                       /* pf_motion_model_t. Default constant velocity */
    double linear_acceleration_density;  /* [m/s^2/sqrt(Hz)] 1e-9 .. 1e4. Default 1 */
    double angular_acceleration_density; /* [rad/s^2/sqrt(Hz)] 1e-9 .. 1e4. Default 2 */
    /* [m/s^3/sqrt(Hz)] 1e-9 .. 1e5, in place of linear_acceleration_density with
     * PF_MOTION_CONSTANT_ACCELERATION. Default 10 */
    double linear_jerk_density;
    double coast_s; /* after this time without tracking the state is lost, 0.05 .. 10. Default 1 */
    /* After this time of usable images without finding the map again, counted from when the state
     * was lost, the map is discarded and a new one begins; 0: never. 0 .. 1e4. Default 3 */
    double restart_s;
  } motion;

  struct {
    /* Of a match in an image: least standard deviation (lens, warp, interpolation) on top of the
     * image noise; both are scaled up together where the residuals are larger. The prior of
     * sigma_gate_px in the report. Of an observation that gives no sigma_px: its standard
     * deviation. 0.01 .. 10. Default 0.1 */
    double sigma_px;
    double gate_probability; /* that a true match passes the gate, 0.9 .. 0.9999. Default 0.99 */
  } measurement;

  /* Depth of a feature that was seen once: rho = 1/depth has mean rho0 and standard deviation
   * relative_sigma * rho0. */
  struct {
    /* [m] rho0 is 1/depth until the map has a median (from_map). 1e-4 .. 1e5. Default 1. After a
     * start with neither target nor pose it is also the unit of length, see LENGTHS. */
    double depth;
    /* 1: rho0 becomes the median of what is in view; where only a target is in view, half of the
     * target's, since a target stands in front of its scene. 0: it stays 1/depth. Default 1 */
    int32_t from_map;
    /* 0.05 .. 5. Default 2: hardly a prior. A prior that is wrong in the same way for many features
     * bends the scale. */
    double relative_sigma;
    /* An inverse-depth point whose index of linearity is below this becomes a 3-D point, 0.001 ..
     * 1. Default 0.1 */
    double linearity_index;
  } first_depth;

  struct {
    /* Features to keep in view, 8 .. capacity.max_observations, with PF_BACKEND_WINDOW 8 ..
     * window.points; 0 with capacity.max_patches: none begin, and patches of walls alone are
     * followed. Default 45 */
    int32_t features_in_view;
    int32_t border_px; /* no feature nearer to the image's edge than this, 4 .. 64. Default 8 */
    int32_t masks;     /* pf_masks_t. Default none. Other than none, it adds memory */
    /* With masks: mean square of a match's residuals, in that of a pixel on the dominant plane, at
     * most. 0.01 .. 100. Default 2 */
    double max_misfit;
  } map;

  /* Finding planes and folding points into them (lib/docs/theory/planes.md). Names of Gee 2007,
   * section 3, in brackets. */
  struct {
    int32_t enabled;     /* 1: finds planes and folds points into them. 0: points only. Default 1 */
    int32_t min_points;  /* a new plane has more points than this (l_T), 4 .. 60. Default 7 */
    double max_distance; /* [m] of a point from a new plane (d_T), 1e-5 .. 10. Default 0.01 */
    /* [m] of a point from a new plane's origin (d_max), 0.01 .. 1e4. Default 1.5 */
    double max_radius;
    /* [m] of real surfaces: standard deviation of a point from its plane, 1e-6 .. 1. Default
     * 0.002 */
    double roughness;
    /* [m] A point can be folded when its standard deviation relative to the camera is below this
     * (sigma_T), 1e-5 .. 10. Default 0.05 */
    double fold_sigma;
    /* [m] A folded point is fixed when its standard deviation among the points of its plane is
     * below this (sigma_fix), 0 (never) .. 10. Default 0 */
    double fix_sigma;
    int32_t fix; /* pf_fix_t. Default consider */
  } plane;

  pf_imu_model_t imu;

  /* Comparisons that no product needs; written by pf_config_set_research (planefold_research.h)
   * alone. Default zeros: none */
  uint64_t research[8];

  /* Nanoseconds of any steady clock, for the cost of each stage in the report; null reads no clock.
   * Default null */
  int64_t (*clock_ns)(void* user);
  /* One line of plain text, up to 239 characters, on what the library decided; null: no log.
   * Default null */
  void (*log)(void* user, const char* line);
  /* Handed to both. Both may call functions of a const pf_slam_t*; others are PF_ERROR_STATE */
  void* user;
} pf_config_t;

PF_API pf_status_t pf_config_default(pf_config_t* config);

/* PF_OK, or an error; *field (may be null) then points to the name of the first bad field, a
 * constant string, else it is null. */
PF_API pf_status_t pf_config_check(const pf_config_t* config, const char** field);

/* -------------------------------------------------------------------------------- memory -- */

typedef struct pf_memory {
  size_t bytes;       /* that the block must have at least */
  size_t alignment;   /* the block must begin at a multiple of this */
  size_t stack_bytes; /* the most stack that any call uses (a tested bound) */
} pf_memory_t;

PF_API pf_status_t pf_memory_query(const pf_config_t* config, pf_memory_t* memory);

typedef struct pf_slam pf_slam_t; /* lives in your block */

/* Makes a context in the block. On an error *slam is null and the block may be reused. What the
 * block held before does not matter. */
PF_API pf_status_t pf_create(const pf_config_t* config, void* block, size_t bytes,
                             pf_slam_t** slam);

/* Back to the moment after pf_create: same config, no map, no pose, and any timestamp may come
 * next. */
PF_API pf_status_t pf_reset(pf_slam_t* slam);

/* ------------------------------------------------------------------------------ starting -- */

typedef struct pf_pose {
  int64_t t_ns;
  double q_WC[4];        /* w x y z */
  double p_WC[3];        /* [m] */
  double covariance[36]; /* 6x6 of (theta, p) [rad, m] */
  double v_W[3];         /* velocity [m/s]; zero with PF_MOTION_CONSTANT_POSITION */
  double w_C[3];         /* angular velocity [rad/s], in C; the same */
  /* of the map that W belongs to; never used twice. Ignored in a pose that you pass in */
  uint32_t map_id;
  uint32_t reserved; /* 0 */
} pf_pose_t;

#define PF_TARGET_MAX_POINTS 16

typedef enum pf_target_kind {
  /* A dark rectangle of known size on a light ground, found in the image (Gee 2007, section 4). */
  PF_TARGET_RECTANGLE = 1,
  PF_TARGET_POINTS = 2 /* known points, seen from about a known pose */
} pf_target_kind_t;

typedef struct pf_target {
  int32_t kind; /* pf_target_kind_t */
  /* Rectangle: its frame T is at its centre, x right and y down as seen upright, z into the wall.
   * */
  double width, height; /* [m] 1e-4 .. 1e3, of the outer edge of the dark area */
  /* Rectangle: where that frame is in W, p_W = R_WT p_T + p_WT, q_WT w x y z. All zero: it is W. */
  double q_WT[4], p_WT[3];
  /* Points. */
  int32_t count;                            /* 4 .. PF_TARGET_MAX_POINTS */
  double points_W[PF_TARGET_MAX_POINTS][3]; /* [m] */
  /* About where the camera is at first, with its covariance; t_ns is unused. Images of later maps
   * begin without the points. */
  pf_pose_t first_pose;
  /* Both. */
  double sigma; /* [m] 1e-9 .. 1e3, standard deviation of the target's points */
} pf_target_t;

/* Starts in front of a known target, before the first frame. Until the target is seen the state is
 * starting. PF_ERROR_STATE: after the first frame or pf_set_second_pose, and in a loaded map; of a
 * rectangle also after pf_start_from_pose, and after pf_add_wall without a place in W.
 * PF_ERROR_RANGE: a number of the target is outside of its range, or first_pose has no
 * covariance. */
PF_API pf_status_t pf_start_from_target(pf_slam_t* slam, const pf_target_t* target);

/* Starts from a known pose, with its covariance and velocity, before the first frame;
 * velocity_covariance is 6x6 of (v_W, w_C). With images the state is starting until the first
 * frames have measured the depths, unless walls or a speed above twice its sigma fix them; the
 * scale is that of first_depth where nothing else gives it. PF_ERROR_STATE together with a
 * rectangle as target, which gives the pose itself. With a target of points both may be given: the
 * known pose then counts if the points are seen in the first frame, and their own sighting later.
 * With neither start, W is the first camera. PF_ERROR_RANGE: a standard deviation below 1e-9, or
 * numbers that are no covariance. */
PF_API pf_status_t pf_start_from_pose(pf_slam_t* slam, const pf_pose_t* pose,
                                      const double velocity_covariance[36]);

/* Gives the place of the camera in the frame at t_ns (to a millisecond), which is still to come:
 * its distance from the first camera (that of pf_start_from_pose, else the origin of W) is the
 * scale, and the map is scaled about the first camera in that frame, or when the depths are known.
 * Of the pose the position counts. Poses that were returned before keep the old scale, and a mark
 * (pf_mark_pose) is lost. Nothing is scaled, with a line in the log, where the frame does not come,
 * is not tracked, or the camera has hardly moved. PF_ERROR_STATE: with PF_BACKEND_FILTER, with a
 * target, or while another one is waited for. PF_ERROR_TIME: the frame is not after the last one.
 * PF_ERROR_RANGE: it is nearer to the first place than its own standard deviation. */
PF_API pf_status_t pf_set_second_pose(pf_slam_t* slam, int64_t t_ns, const pf_pose_t* pose);

/* Stops measuring the target's own points; they stay in the map. */
PF_API pf_status_t pf_withdraw_target(pf_slam_t* slam);

/* --------------------------------------------------------------------------------- walls -- */

#define PF_OUTLINE_MAX 24

/* A wall: a plane that is known beforehand, from a building plan, with how uncertain it is
 * (lib/docs/theory/walls.md). Fields as in pf_plane_t. */
typedef struct pf_wall_prior {
  /* The plane's frame, row-major: x and y in the plane, z towards the side that can be seen */
  double R_WP[9];
  double p_WP[3]; /* its origin: the wall's own centre, inside of the outline [m] */
  /* 3x3 of (alpha, beta, delta) at that origin: n_true = n + alpha x_W + beta y_W, n_true . (p -
   * p_WP) = delta. Standard deviations of 1e-9 at least.   [rad, rad, m] */
  double covariance[9];
  int32_t outline_count; /* 3 .. PF_OUTLINE_MAX */
  /* x y in the plane's frame, counter-clockwise seen from the z side, convex: every vertex is a
   * corner */
  double outline_P[PF_OUTLINE_MAX][2];
  double roughness;   /* [m] as plane.roughness of the config, 1e-6 .. 1; 0: that one */
  uint32_t two_sided; /* 1: can be seen from both sides, 0: only from the z side */
  uint32_t reserved;  /* 0 */
} pf_wall_prior_t;

/* Adds a wall to the map, before the first frame or later; *id is that of a pf_plane_t. With the
 * filter it takes three rows of the state (capacity.max_state_dim), for which features that were
 * not seen in the last frame are evicted while tracking. Points that lie on it fold into it, and
 * planes that are found merge into it. It is refined by what is seen, and never dissolved. Where
 * that contradicts it, it is rejected: it takes no points then. As long as there are walls no new
 * map begins after a loss; pf_reset drops them, and so does an estimate that is no longer finite.
 * PF_ERROR_STATE where the place of W is not known to you: before pf_start_from_pose, or
 * pf_start_from_target with points or with a place, and in a map that began after that start's;
 * with plane.enabled 0; with the window also after pf_set_second_pose, and in a loaded map.
 * PF_ERROR_FULL: more planes than capacity.max_planes, or no rows.
 * PF_ERROR_RANGE: R_WP is no rotation, covariance has a negative eigenvalue or a standard deviation
 * below 1e-9, or the outline is not convex, crosses itself, is not counter-clockwise or does not
 * hold the origin. */
PF_API pf_status_t pf_add_wall(pf_slam_t* slam, const pf_wall_prior_t* wall, uint32_t* id);

/* --------------------------------------------------------------------------------- input -- */

typedef struct pf_image {
  const uint8_t* pixels; /* grey levels; read during the call only */
  int32_t width, height; /* [px] those of the calibration */
  int32_t stride;        /* bytes from row to row, >= width */
  int64_t t_ns;          /* middle of the exposure, after that of every earlier frame */
} pf_image_t;

/* Pixels from (x, y) on, which may reach beyond the image. */
typedef struct pf_rectangle {
  int32_t x, y, width, height; /* [px] width and height >= 0 */
} pf_rectangle_t;

/* What in the images is not the scene: the carrier's own body, a date or a frame that a recorder
 * has drawn. By pixels, by rectangles or both. */
typedef struct pf_mask {
  /* One byte a pixel, row by row: 0 is masked, all else is scene. Null: rectangles alone */
  const uint8_t* pixels;
  int32_t width, height; /* [px] those of the calibration */
  int32_t stride;        /* bytes from row to row, >= width; not read without pixels */
  int32_t num_rectangles;
  const pf_rectangle_t* rectangles; /* that are masked; null with num_rectangles 0 */
} pf_mask_t;

/* Masks a part of all images from the next one on, in place of the mask before; a mask in which all
 * is scene ends it, and so does pf_reset. What is masked is never searched, and nothing begins, is
 * aligned or is recognised there (lib/docs/guide/mask.md). Of each 4x4 px a masked pixel masks all.
 * Bytes and rectangles are read during the call only. Pushed observations are not masked.
 * PF_NOTE_UNUSABLE: done, but of the 8x6 equal parts of the image, in which features begin, fewer
 * than eight hold any scene, which is too little for tracking.
 * PF_ERROR_FULL: capacity.mask is 0. PF_ERROR_NULL: neither pixels nor rectangles. PF_ERROR_SIZE:
 * not the size of the images. PF_ERROR_RANGE: everything would be masked, or a rectangle has a
 * negative side. */
PF_API pf_status_t pf_set_mask(pf_slam_t* slam, const pf_mask_t* mask);

/* Tracks one frame. PF_OK means tracked; a note says why there is no pose of this frame's own:
 * PF_NOTE_STARTING, PF_NOTE_COASTING, PF_NOTE_LOST, PF_NOTE_UNUSABLE. PF_ERROR_SIZE and
 * PF_ERROR_TIME as above; PF_ERROR_STATE: the context takes observations. An image that is byte for
 * byte the one before repeats that one's pose and status under its own time and is counted; nothing
 * is measured, and the next prediction begins at the image's first time. A camera that is frozen
 * for longer than motion.coast_s coasts. */
PF_API pf_status_t pf_push_frame(pf_slam_t* slam, const pf_image_t* image);

/* A feature that something else has found and recognised: for trackers in hardware and for
 * simulations. A new id begins a feature (if the map has room for it), a known one measures it.
 * With a target of points, the ids 0 .. count-1 are its points. Of an id that comes twice in a
 * call, the first counts; of more than features and observations of one frame together
 * (capacity.max_features, with the window window.points, and max_observations) the rest is not
 * read. A context takes frames or observations, not both. */
typedef struct pf_observation {
  uint32_t id;
  double pixel[2]; /* below 1e5 */
  double sigma_px; /* 0.01 .. 100; 0: measurement.sigma_px of the config */
} pf_observation_t;

/* One frame by its features, in place of an image. Notes as of pf_push_frame. PF_ERROR_TIME: not
 * after the last frame. PF_ERROR_STATE: the context takes frames; with a rectangle as target, which
 * is found in images only; in the window with any target or in a loaded map. */
PF_API pf_status_t pf_push_observations(pf_slam_t* slam, int64_t t_ns,
                                        const pf_observation_t* observations, size_t count);

/* Control input: a change of velocity that is known beforehand (a motor, a thruster, a simulation).
 * The next frame's prediction adds it to the velocities, in camera axes: v_W += R_WC dv_C [m/s],
 * w_C += dw_C [rad/s]. Calls add up. PF_ERROR_STATE: with PF_MOTION_INERTIAL and
 * PF_MOTION_CONSTANT_POSITION. */
PF_API pf_status_t pf_push_control(pf_slam_t* slam, const double dv_C[3], const double dw_C[3]);

/* A sample of an inertial measurement unit, in the unit's own axes. */
typedef struct pf_imu_sample {
  int64_t t_ns;    /* when it was measured, on the clock of the frames */
  double gyro[3];  /* angular velocity [rad/s], at most 1000 each */
  double accel[3]; /* specific force [m/s^2], at most 1e5 each: 9.8 upwards when it lies still */
} pf_imu_sample_t;

/* Samples, the oldest first, each after every earlier one; those up to a frame's time belong before
 * that frame. All or none are taken: PF_ERROR_TIME where a time is not after the one before,
 * PF_ERROR_NONFINITE, PF_ERROR_RANGE beyond what any unit measures. They are kept
 * (capacity.max_imu_samples) and reported; poses depend on them with PF_MOTION_INERTIAL only. */
PF_API pf_status_t pf_push_imu(pf_slam_t* slam, const pf_imu_sample_t* samples, size_t count);

/* ---------------------------------------------------------------------------------- maps -- */

typedef enum pf_map_kind {
  /* Places, planes, anchors, gravity and the lens, in a format that any build reads
   * (lib/docs/reference/map_format.md). */
  PF_MAP_PORTABLE = 1,
  /* The context as it stands between two frames, to go on with the very next one: the bits that
   * follow are those of a run that was never saved. For the same build, config and kernel set */
  PF_MAP_CONTINUE = 2
} pf_map_kind_t;

/* Bytes that pf_save_map needs at most, now. Notes and errors as of pf_save_map. */
PF_API pf_status_t pf_map_size(const pf_slam_t* slam, int32_t kind, size_t* bytes);

/* Writes the map into a buffer, of which *used is then the map. What is kept are places: those that
 * the map has, and what keyframes of the window or the filter's camera see; of more than
 * capacity.max_places the least redundant ones. PF_NOTE_NOTHING: none has enough points yet, and
 * nothing is written. PF_ERROR_STATE: without room for places, and while starting.
 * PF_MAP_CONTINUE needs no places and can be saved at any time, also before the first frame, but
 * not from a callback (PF_ERROR_STATE). PF_ERROR_RANGE: the kind is unknown. PF_ERROR_MEMORY: the
 * buffer is too small, and nothing was written. */
PF_API pf_status_t pf_save_map(const pf_slam_t* slam, int32_t kind, void* buffer, size_t bytes,
                               size_t* used);

/* Begins in a saved map: W, lengths and planes are those of the map, and the camera is lost in it
 * until pf_push_frame recognises one of its places; the log has a line with the first tracked
 * frame. Before the first frame only. The map may come from another config, build, scalar or camera
 * of about the same focal length in pixels. The lens is that of the config or, where that is
 * estimated and the map's is within three of its sigmas, the map's. The map is searched for until
 * it is found, also after later losses: no new one begins before pf_reset, which drops it.
 * The buffer is read during the call only. All of it is checked first: where it is rejected nothing
 * changes, and the log has the reason. PF_ERROR_MAP: no map, damaged, of another version, or with a
 * number out of its domain. PF_ERROR_FULL: more places, planes or anchors than
 * capacity.max_places, max_planes and max_anchors. PF_ERROR_STATE: after the first frame, with a
 * start that was set or a wall, or without room for places (capacity.max_places).
 *
 * With PF_MAP_CONTINUE goes on where the saved context was, at any address, with the next frame,
 * whose time is after the last one's. Masks, walls, anchors, marks, gravity and samples come back;
 * the callbacks are those of this context. PF_ERROR_STATE: a call has changed the context since
 * pf_create or pf_reset. PF_ERROR_MAP: another release, build, scalar, kernel set or config (all
 * fields but kernels and callbacks), and the log names which; or damaged. The CRC is no
 * authentication: of a forged file too every count, index and enum is checked, so that it reaches
 * no memory outside of the block, but its poses and points are used as they stand there. */
PF_API pf_status_t pf_load_map(pf_slam_t* slam, const void* buffer, size_t bytes);

/* -------------------------------------------------------------------------------- output -- */

typedef enum pf_state {
  /* no pose yet, or a pose whose depths are not yet known (nothing but rotation so far) */
  PF_STATE_STARTING = 0,
  PF_STATE_TRACKING = 1,
  PF_STATE_COASTING = 2, /* the pose is a prediction; covariance grows */
  PF_STATE_LOST = 3
} pf_state_t;

PF_API pf_status_t pf_get_state(const pf_slam_t* slam, pf_state_t* state);

/* Pose at the last frame. PF_ERROR_STATE before the first one. */
PF_API pf_status_t pf_get_pose(const pf_slam_t* slam, pf_pose_t* pose);

/* Pose predicted to a time at or after the last frame, for display; the state does not change.
 * PF_ERROR_STATE before the first pose, PF_ERROR_TIME before the last frame, PF_ERROR_RANGE more
 * than 10 s after it. */
PF_API pf_status_t pf_predict_pose(const pf_slam_t* slam, int64_t t_ns, pf_pose_t* pose);

/* How the camera moved between two frames of one map. Unlike the pose in W, which drifts as a
 * whole, this is as good as the measurements in between: for odometry, and to test the covariance
 * over short times (NEES). */
typedef struct pf_motion {
  int64_t mark_t_ns; /* of the frame whose pose was marked: K is the camera there */
  int64_t t_ns;      /* of the last frame: C is the camera there */
  double q_KC[4];    /* w x y z */
  double p_KC[3]; /* of C in K [m]; in the map's own unit where no length is known, see LENGTHS */
  /* 6x6 of (theta, p) [rad, m], both in K: R_true = Exp(theta) R_KC, p_true = p_KC + e. From all
   * that both poses have in common; zero in the frame of the mark. */
  double covariance[36];
  uint32_t map_id;   /* as in pf_pose_t */
  uint32_t reserved; /* 0 */
} pf_motion_t;

/* Marks the pose of the last frame, whatever the state: a copy of the camera becomes part of the
 * state. There is one mark; a new one replaces it. It goes with its map: with a new map_id, after
 * pf_reset, and when a start without a target begins its map again with better depths. It takes six
 * rows of the state (capacity.max_state_dim). While tracking, features that were not seen in the
 * last frame are evicted for them. PF_ERROR_STATE before the first pose, PF_ERROR_FULL without
 * room. */
PF_API pf_status_t pf_mark_pose(pf_slam_t* slam);

/* Motion from the mark to the last frame. PF_NOTE_NOTHING, and *motion is as it was, when there is
 * no mark. */
PF_API pf_status_t pf_get_motion_since_mark(const pf_slam_t* slam, pf_motion_t* motion);

/* Pixel of a point in the world at the last frame, and its 2x2 covariance from the pose's (may be
 * null). Of a rolling shutter it is the one at the frame's own time, which its row does not share:
 * lib/docs/theory/rolling_shutter.md has the way to it. PF_ERROR_STATE before the first pose,
 * PF_ERROR_RANGE as of pf_camera_project. */
PF_API pf_status_t pf_project_point(const pf_slam_t* slam, const double p_W[3], double pixel[2],
                                    double covariance[4]);

typedef enum pf_feature_kind {
  PF_FEATURE_INVERSE_DEPTH = 1, /* direction known, depth not yet */
  PF_FEATURE_POINT = 2,
  PF_FEATURE_FOLDED = 3, /* two coordinates on a plane */
  PF_FEATURE_FIXED = 4   /* on a plane, and estimated no more */
} pf_feature_kind_t;

typedef struct pf_feature {
  uint32_t id; /* never used twice */
  /* pf_observation_t.id; of a point of the target: its index. 0 of what an image began */
  uint32_t external_id;
  int32_t kind;      /* pf_feature_kind_t */
  int32_t is_target; /* 1 for a point of the target */
  uint32_t plane;    /* id of the plane that it is folded into, or began on, or 0 */
  /* 1: began on that plane, and has not shown by its own parallax that it lies there. */
  int32_t on_trial;
  uint32_t map_id;      /* as in pf_pose_t */
  double p_W[3];        /* [m] inverse depth: at the mean inverse depth */
  double covariance[9]; /* 3x3; inverse depth: to first order */
  int32_t observations; /* frames in which it was measured */
  int32_t attempts;     /* frames in which it was looked for */
  /* Natural log-odds that it is a point of the scene, by how often it was found: 0 when it begins,
   * at most 6.9 (0.1 % are none); below -4.6 (99 % are none) it is dropped. */
  double log_odds;
} pf_feature_t;

/* Copy of the map. *count is how many there are; PF_NOTE_TRUNCATED if capacity was smaller. */
PF_API pf_status_t pf_get_features(const pf_slam_t* slam, pf_feature_t* features, size_t capacity,
                                   size_t* count);

/* Of a plane, once the direction of gravity is known (pf_set_gravity, pf_get_inertial): within 15
 * degrees with a probability of 95 %, by the covariance of the plane and, where it is estimated, of
 * gravity. Up and down: which way the side looks that was seen. */
typedef enum pf_orientation {
  PF_ORIENTATION_UNKNOWN = 0,         /* gravity is not known, or which of the others it is */
  PF_ORIENTATION_HORIZONTAL_UP = 1,   /* floor, table top */
  PF_ORIENTATION_HORIZONTAL_DOWN = 2, /* ceiling */
  PF_ORIENTATION_VERTICAL = 3,        /* wall, front */
  PF_ORIENTATION_OTHER = 4
} pf_orientation_t;

typedef struct pf_plane {
  uint32_t id;         /* never used twice */
  int32_t orientation; /* pf_orientation_t */
  int32_t points;      /* that began on it or were folded into it: members + trial */
  int32_t members;     /* of these, those whose own parallax has shown it; fixed ones among them */
  int32_t trial;       /* and those that began on it, and have not shown it yet */
  int32_t fixed_points;
  uint32_t map_id; /* as in pf_pose_t */
  /* of the convex outline of its points, 0 .. PF_OUTLINE_MAX; of a wall, with the plan's */
  int32_t outline_count;
  int32_t is_wall;    /* 1: a wall, see pf_add_wall */
  int32_t rejected;   /* 1: a wall that is rejected: the images contradict its place */
  double normal_W[3]; /* unit, towards the side that was seen */
  double distance;    /* n . p of its points */
  double R_WP[9];     /* the plane's frame, row-major: x and y in the plane, z the normal */
  double p_WP[3];     /* its origin, in the plane and about in the middle */
  /* 3x3 of (alpha, beta, delta) [rad, rad, m]: n_true = n + alpha x_W + beta y_W,
   * n_true . (p - p_WP) = delta: two tilts about p_WP, and a shift along the normal */
  double covariance[9];
  /* x y in the plane's frame, counter-clockwise seen from the normal's side */
  double outline_P[PF_OUTLINE_MAX][2];
  double area; /* [m^2] of the outline */
} pf_plane_t;

/* Copy of the planes. *count is how many there are; PF_NOTE_TRUNCATED if capacity was smaller. */
PF_API pf_status_t pf_get_planes(const pf_slam_t* slam, pf_plane_t* planes, size_t capacity,
                                 size_t* count);

/* The plane that an id stands for now: itself, or the one that it was merged into. PF_NOTE_NOTHING
 * (*current_id is 0) when it is gone. */
PF_API pf_status_t pf_find_plane(const pf_slam_t* slam, uint32_t id, uint32_t* current_id);

/* Sets the direction of gravity in W, of any length below 1e6; zero removes it, and so does a new
 * map. Only pf_plane_t.orientation depends on it. With PF_MOTION_INERTIAL gravity is estimated
 * (pf_get_inertial), and a direction that is set here is used in its place. */
PF_API pf_status_t pf_set_gravity(pf_slam_t* slam, const double gravity_W[3]);

/* States that a plane is vertical within a standard deviation of sigma_rad, 1e-6 .. 0.5, which
 * constrains gravity's direction and the plane's. It counts once: a second call changes nothing
 * until a call with 0 has removed it, which adds back what it took from the variance of the plane's
 * tilt. PF_ERROR_STATE where gravity is not estimated and known (pf_inertial_t.metric).
 * PF_NOTE_NOTHING: no plane has this id. PF_ERROR_RANGE too where gravity and plane contradict it
 * by their covariances (1 in 10,000). */
PF_API pf_status_t pf_set_plane_vertical(pf_slam_t* slam, uint32_t plane, double sigma_rad);

typedef struct pf_hit {
  uint32_t plane; /* id */
  double p_W[3];
  double covariance[9]; /* 3x3, from pose and plane and what they have in common */
  double range;         /* from the camera [m] */
} pf_hit_t;

/* Where the ray through a pixel of the last frame meets the nearest plane, inside of its outline.
 * PF_NOTE_NOTHING when it meets none. PF_ERROR_STATE before the first pose, PF_ERROR_RANGE where
 * the pixel has no ray. */
PF_API pf_status_t pf_hit_test(const pf_slam_t* slam, const double pixel[2], pf_hit_t* hit);

/* A pose that stays where it was set while the map is corrected: something that is shown, measured
 * or returned to (lib/docs/theory/anchors.md, lib/docs/guide/anchors.md). As of the last frame of
 * its map. */
typedef struct pf_anchor {
  uint32_t id; /* never used twice; of a map that was loaded, the one that it had there */
  /* As in pf_pose_t, of the map that it belongs to. After that map is discarded it stays as it was,
   * in a W that is no more. */
  uint32_t map_id;
  uint32_t plane;        /* id of the plane that it lies on; 0: of none, or that plane is gone */
  uint32_t reserved;     /* 0 */
  double q_WA[4];        /* w x y z; on a plane the third axis is its normal */
  double p_WA[3];        /* [m] */
  double covariance[36]; /* 6x6 of (theta, p) [rad, m], as in pf_pose_t */
} pf_anchor_t;

/* Sets an anchor at a pose in W: rotation and position count, the rest is ignored. What is held is
 * where it is seen from the camera of the last frame, so its covariance is that of the camera,
 * carried there. PF_ERROR_STATE: unless the last frame is tracked. PF_ERROR_FULL: there are
 * capacity.max_anchors, or with the filter no room: there the first anchor of a frame takes six
 * rows of the state (capacity.max_state_dim), for which features are evicted that were not seen in
 * the last frame. PF_ERROR_RANGE: q_WC is not of unit length, or a coordinate is above 1e6. */
PF_API pf_status_t pf_add_anchor_pose(pf_slam_t* slam, const pf_pose_t* pose, uint32_t* id);

/* Sets an anchor where a ray of the last frame meets a plane, as of pf_hit_test: plane and p_W
 * count. It stays on that plane and on that ray as both are corrected. Its third axis is the
 * plane's normal, and the first one points to the right in the image as far as that allows (down
 * where the plane is seen along its right). Errors as of pf_add_anchor_pose. PF_NOTE_NOTHING: no
 * plane has this id. PF_ERROR_RANGE: the ray to p_W does not meet it. */
PF_API pf_status_t pf_add_anchor_hit(pf_slam_t* slam, const pf_hit_t* hit, uint32_t* id);

/* PF_NOTE_NOTHING, and *anchor is as it was: no anchor has this id. */
PF_API pf_status_t pf_get_anchor(const pf_slam_t* slam, uint32_t id, pf_anchor_t* anchor);

/* Copy of the anchors. *count is how many there are; PF_NOTE_TRUNCATED if capacity was smaller. */
PF_API pf_status_t pf_get_anchors(const pf_slam_t* slam, pf_anchor_t* anchors, size_t capacity,
                                  size_t* count);

/* PF_NOTE_NOTHING: no anchor has this id. */
PF_API pf_status_t pf_remove_anchor(pf_slam_t* slam, uint32_t id);

typedef enum pf_match_status {
  PF_MATCH_INLIER = 1,  /* measured and used */
  PF_MATCH_OUTLIER = 2, /* found, but not consistent with the others */
  PF_MATCH_MISSED = 3,  /* looked for in the ellipse and not found */
  PF_MATCH_NEW = 4      /* a feature that began in this frame */
} pf_match_status_t;

typedef struct pf_match {
  uint32_t id;    /* of the feature */
  int32_t status; /* pf_match_status_t */
  int32_t kind;   /* pf_feature_kind_t */
  double predicted_px[2];
  double covariance_px[4]; /* 2x2 of the innovation: the search ellipse */
  double measured_px[2];   /* inliers, outliers and new ones */
  double nis; /* of inliers and outliers: normalised innovation squared, 2 degrees of freedom */
} pf_match_t;

/* What was looked for in the last frame, and what was found. *count is how many there are;
 * PF_NOTE_TRUNCATED if capacity was smaller. */
PF_API pf_status_t pf_get_matches(const pf_slam_t* slam, pf_match_t* matches, size_t capacity,
                                  size_t* count);

/* Beside the values of pf_match_status_t: the patch was found, but it is not known yet which plane
 * it lies on, so it was not used. */
enum { PF_PATCH_WAITING = 5 };

/* A patch of a wall, or of a plane that was found, that is followed in images
 * (capacity.max_patches, lib/docs/theory/homography.md). */
typedef struct pf_patch {
  uint32_t id;    /* never used twice */
  uint32_t plane; /* id of the wall or plane that it lies on; 0: not known yet */
  /* pf_match_status_t, or PF_PATCH_WAITING; 0: out of view, or too slanted to be looked for */
  int32_t status;
  int32_t frames; /* in which it was measured */
  /* Where its corners are in the last frame, in the order of a circle: measured (inlier, outlier,
   * new, waiting), or else predicted. */
  double corners_px[4][2];
  /* 8x8 of corners that were measured (x, y of each), from the noise of this frame's image */
  double covariance_px[64];
  double weight; /* share of its pixels that fit in the last frame, 0 .. 1 */
} pf_patch_t;

/* Copy of the patches. *count is how many there are; PF_NOTE_TRUNCATED if capacity was smaller. */
PF_API pf_status_t pf_get_patches(const pf_slam_t* slam, pf_patch_t* patches, size_t capacity,
                                  size_t* count);

/* Template of a feature, with map.masks. */
typedef struct pf_template {
  uint32_t feature; /* id */
  int32_t side;     /* [px] capacity.template_px */
  /* side * side, row by row, in the image where the feature was first seen. mask: probability of
   * belonging to the dominant plane in 1/255; 0 where there was no image. */
  uint8_t grey[31 * 31], mask[31 * 31];
  /* Unit, of the dominant plane, towards the camera; a folded feature has its plane's */
  double normal_W[3];
  double sigma_normal_rad; /* of the template's own normal; 0 of a folded feature */
  double centre_px[2];     /* of the middle pixel, in the image where the feature was first seen */
  int32_t frames;          /* that the mask has learnt from */
} pf_template_t;

/* PF_NOTE_NOTHING, and *out is as it was: no feature has this id, or there are no masks. */
PF_API pf_status_t pf_get_template(const pf_slam_t* slam, uint32_t feature, pf_template_t* out);

enum {
  PF_STAGE_PYRAMID = 0,  /* image levels */
  PF_STAGE_PREDICT = 1,  /* motion, predicted pixels, innovation covariance */
  PF_STAGE_SEARCH = 2,   /* warps, search, sub-pixel refinement */
  PF_STAGE_GATE = 3,     /* inliers and outliers among the matches */
  PF_STAGE_UPDATE = 4,   /* covariance and state */
  PF_STAGE_MAP = 5,      /* conversion, eviction, corners, new features */
  PF_STAGE_IMU = 6,      /* samples, in place of the motion in PF_STAGE_PREDICT */
  PF_STAGE_PATCH = 7,    /* patches on walls: prediction, alignment, update, new ones */
  PF_STAGE_TEMPLATE = 8, /* masks and normals of templates */
  PF_STAGE_ADJUST = 9,   /* of the window: adjusting keyframes and points */
  PF_STAGE_COUNT = 10
};

/* The calibration as estimated so far, and the covariance of its numbers (may be null): 10x10,
 * row-major, of (fx, fy, cx, cy, distortion[0] .. distortion[4], readout_s); zero in the rows of
 * what is exact. */
PF_API pf_status_t pf_get_camera(const pf_slam_t* slam, pf_camera_t* camera,
                                 double covariance[100]);

/* Why a frame was not tracked. */
typedef enum pf_frame_reason {
  PF_FRAME_REASON_NONE = 0, /* it was, or there is no pose yet */
  /* Nothing was searched for: nothing of the map is in view of the prediction, and no kept view is
   * like the image. */
  PF_FRAME_REASON_NOTHING_IN_VIEW = 1,
  /* Fewer features were found than a pose needs: dark, smeared, covered, or elsewhere. */
  PF_FRAME_REASON_FEW_FOUND = 2,
  PF_FRAME_REASON_DISAGREE = 3, /* enough were found, and too few of them agree with one pose */
  /* Enough agree, and chance may be the reason: log_odds is below 6.2. */
  PF_FRAME_REASON_IMPROBABLE = 4,
  PF_FRAME_REASON_UNCERTAIN = 5, /* the pose's covariance is too large to be used */
  /* The image is larger or smaller than by the calibration: zoom, focus, another sensor. */
  PF_FRAME_REASON_LENS = 6
} pf_frame_reason_t;

typedef struct pf_report {
  int64_t t_ns;
  int32_t state;  /* pf_state_t */
  int32_t frames; /* frames pushed since create or reset */
  /* Features searched for, found, and used; a patch counts as eight in each of the three */
  int32_t attempts, matches, inliers;
  int32_t new_features, evicted; /* that began in this frame, and that were removed in it */
  int32_t features, features_point, features_inverse_depth, features_folded, features_fixed;
  int32_t features_trial; /* that began on a plane, and count among none of the kinds before */
  int32_t planes;
  int32_t state_dim;      /* rows of the covariance */
  int32_t state_dim_held; /* of them considered only: without gain */
  /* rows that the same map would need with 3-D points in place of folded ones */
  int32_t state_dim_points_only;
  uint32_t map_id;    /* as in pf_pose_t; of the first map 1, and one more for each new one */
  int32_t kept_views; /* of capacity.max_kept_views */
  /* Normalised innovation squared of this frame's inliers, jointly, and its degrees of freedom; of
   * matches in images with the noise that one match has by itself */
  double nis;
  int32_t nis_dof;
  int32_t kernels;          /* pf_kernels_t in use */
  int32_t patches, cameras; /* patches on walls, and the reference cameras that saw them first */
  /* of `frames`: images that were byte for byte the one before, see pf_push_frame */
  int64_t duplicates;
  int64_t stage_ns[PF_STAGE_COUNT]; /* all zero without a clock */
  /* Noise of matches in images, as estimated so far (lib/docs/theory/noise.md): of one match by
   * itself, root mean square over recent inliers [px]; of what it adds to those of other frames,
   * sigma_gate_px * sqrt(correlation_frames) [px]; and for how many frames an error stays with its
   * feature. Pushed observations have the sigma_px that they state. */
  double sigma_gate_px, sigma_info_px, correlation_frames;
  /* Of `frames`: those at whose end a part of the estimate's covariance was not positive
   * semidefinite, beyond rounding, and its variances were raised until it was
   * (lib/docs/theory/float.md). 0 is normal; where it grows, the covariances of poses are too
   * small. */
  int64_t covariance_repairs;
  /* With map.masks: templates that learnt from this frame, and the mean share of their pixels on
   * the dominant plane (0 without any). */
  int32_t templates;
  int32_t keyframes; /* of the window: that are kept */
  double template_area;
  /* ln(p / (1 - p)) of the probability that the map's pose in this frame is right, with the frame's
   * evidence (lib/docs/theory/belief.md): 3 is wrong once in 20, and a frame is tracked from 6.2
   * on, once in 500. -13.8 .. 13.8; 0 before there is a pose. */
  double log_odds;
  /* Features that agree with the best of the poses that this frame was searched for; `inliers` of
   * them were used, if that pose was accepted. */
  int32_t consensus;
  int32_t reason;          /* pf_frame_reason_t */
  int32_t places;          /* of capacity.max_places: that are kept */
  int32_t places_returned; /* since the beginning: how often one has come back to window or state */
  /* By how much poses that were given out before have moved in this frame, where the camera is now:
   * what was at p in W, with the rotation R_WC, is at
   *
   *   p_new = correction_scale R p + correction_p,   R_new = R R_WC    R by correction_q (w x y z)
   *
   * Exact for all of the map where it moves as a whole: it gets its scale, is joined to another
   * one, or is placed by walls or samples. Else it is that of one camera: with PF_BACKEND_WINDOW,
   * after an adjustment, of this frame's; with PF_BACKEND_FILTER, after updates, of the newest copy
   * of a camera in the state (of an anchor, a mark, a patch or a place); without one updates are
   * not reported. Each anchor moves by itself. The identity where nothing moves, in a new map,
   * while starting, and where a camera is found again: its jump is no correction. */
  double correction_scale, correction_q[4], correction_p[3];
  /* The map in whose W those poses were given out: map_id, unless the map goes on under another id
   * (MAPS). All that was given out in it is then of map_id once it is corrected. */
  uint32_t correction_from_map_id;
  /* Of the image, since the beginning: what stands still in it while the rest moves, and is
   * masked (lib/docs/theory/belief.md) [1/1000]. Without what pf_set_mask masks. */
  uint32_t masked_permille;
} pf_report_t;

PF_API pf_status_t pf_get_report(const pf_slam_t* slam, pf_report_t* report);

/* Why samples do not move the pose, or why lengths are not metres. Behind each, what reason_value
 * of pf_imu_report_t is. */
typedef enum pf_imu_reason {
  PF_IMU_REASON_NONE = 0,
  PF_IMU_REASON_WAITS_FOR_ROTATION = 1, /* the delay or the axes are open, and not measured yet */
  /* gravity and scale are not known yet: relative sigma of the scale so far, 0: none */
  PF_IMU_REASON_WAITS_FOR_MOTION = 2,
  PF_IMU_REASON_CONTRADICTS = 3,      /* innovations that no plausible noise explains */
  PF_IMU_REASON_GYRO_IN_DEGREES = 4,  /* rates are too large by this factor, about 57.3 */
  PF_IMU_REASON_GYRO_SCALE = 5,       /* the same, another factor */
  PF_IMU_REASON_AXES = 6,             /* other axes fit (reason_q_BC), so many degrees away */
  PF_IMU_REASON_LEFT_HANDED = 7,      /* only a reflection fits: an axis has the wrong sign */
  PF_IMU_REASON_CLOCK = 8,            /* the delay that would fit [s] */
  PF_IMU_REASON_RATES_DO_NOT_FIT = 9, /* share of the camera's rotations not explained */
  PF_IMU_REASON_COLUMNS_SWAPPED = 10, /* the rates are as large as gravity: their mean length */
  PF_IMU_REASON_ACCEL_IN_G = 11,      /* mean specific force, about 1 */
  PF_IMU_REASON_ACCEL_WITHOUT_GRAVITY = 12, /* mean specific force, about 0 */
  PF_IMU_REASON_ACCEL_UNIT = 13,            /* mean specific force, neither */
  PF_IMU_REASON_ACCEL_SIGN = 14             /* accelerations have the opposite sign */
} pf_imu_reason_t;

/* What came in through pf_push_imu since create or reset. */
typedef struct pf_imu_report {
  int64_t samples;
  int64_t since_frame; /* of them after the last frame was pushed */
  int64_t last_frame;  /* of them between the last frame and the one before (or the beginning) */
  int64_t late; /* of them with a time that is not after that of the frame pushed before them */
  int64_t saturated; /* of them with a number at the end of the ranges in the config */
  int64_t gaps;      /* intervals longer than 1.5 medians */
  int64_t missing;   /* samples that would fill the gaps */
  int64_t first_t_ns, last_t_ns;
  int64_t longest_ns; /* interval */
  double rate_hz;     /* mean from the first sample to the last; 0 of fewer than two */
  double median_s;    /* interval, a running median; 0 of fewer than two */
  int32_t kept;       /* samples in the buffer */
  int32_t used; /* 1 when poses depend on the samples: PF_MOTION_INERTIAL, and samples have come */
  /* With PF_MOTION_INERTIAL. 1: pictures contradict the samples, which this map does not use any
   * more (up to scale: until the gyro agrees again); the motion is that of
   * PF_MOTION_CONSTANT_VELOCITY. A map that had been in metres for less than 5 s begins anew, up to
   * scale. */
  int32_t rejected;
  double rejected_s; /* for how long in all */
  int32_t reason;    /* pf_imu_reason_t, now */
  double reason_value;
  double reason_q_BC[4]; /* w x y z; of the axes that fit, where the reason is about axes */
  /* Densities as estimated so far, from samples and innovations: between a third and ten times
   * those of the config. 0 without PF_MOTION_INERTIAL */
  double gyro_density, accel_density;
} pf_imu_report_t;

PF_API pf_status_t pf_get_imu_report(const pf_slam_t* slam, pf_imu_report_t* report);

/* Estimates of the inertial unit and of gravity, at the last frame. */
typedef struct pf_inertial {
  double gravity_W[3];  /* [m/s^2] */
  double gyro_bias[3];  /* [rad/s] in B */
  double accel_bias[3]; /* [m/s^2] in B */
  /* Row-major 8x8 of (g, gyro bias, accelerometer bias), g two angles about the axes below [rad]:
   * gravity_true = Exp(g1 axis1 + g2 axis2) gravity_W. */
  double covariance[64];
  double gravity_axes_W[2][3]; /* unit, across gravity and each other */
  /* 1: lengths are metres, by the samples; 0: gravity is not known yet, and only the gyroscope is
   * used. It becomes 1 when the camera has been at rest for a second (a map of unknown scale that
   * began less than 15 s ago begins anew then; in the window only where the scale is known), or
   * when a map of unknown scale has seen enough motion (it goes on in metres, under another
   * map_id). In the window it becomes 0 again where the unit is rejected soon after that. */
  uint32_t metric;
  uint32_t from_motion; /* 1: it became 1 by motion, 0: at rest, or not yet */
  uint32_t map_id;      /* as in pf_pose_t */
  /* 1: in this frame the pose is held, since samples and pictures have been at rest for a second at
   * least. Images alone or samples alone are never enough. */
  uint32_t resting;
  uint32_t rests; /* begun since the beginning */
  /* Mounting and delay as estimated so far; those of the config where they are not estimated. */
  double q_BC[4], p_BC[3], delay_s;
  double readout_s; /* of the camera's rows */
  /* What readings become, row-major: w_B = gyro_matrix (gyro - gyro_bias), and in the same way the
   * specific force. Identity where they are not estimated. */
  double gyro_matrix[9], accel_matrix[9];
  /* Standard deviations. Negative: not estimated, or not known yet. */
  struct {
    double gravity_rad[2];           /* about gravity_axes_W */
    double gyro_bias[3];             /* [rad/s] */
    double accel_bias[3];            /* [m/s^2] */
    double mount_rad[3], mount_m[3]; /* of q_BC about the axes of B, and of p_BC */
    double delay_s, readout_s;
    double log_scale; /* of the best known length */
    double scale;     /* of the two matrices, the largest of their entries */
  } sigma;
} pf_inertial_t;

/* PF_NOTE_NOTHING, and *inertial is as it was, before the start and without PF_MOTION_INERTIAL. */
PF_API pf_status_t pf_get_inertial(const pf_slam_t* slam, pf_inertial_t* inertial);

/* Copy of the kept samples, the oldest first. *count is how many there are; PF_NOTE_TRUNCATED if
 * capacity was smaller. */
PF_API pf_status_t pf_get_imu_samples(const pf_slam_t* slam, pf_imu_sample_t* samples,
                                      size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif

#endif
