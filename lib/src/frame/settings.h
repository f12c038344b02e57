#pragma once

#include <cstdint>

#include "base/hooks.h"
#include "base/parts.h"
#include "covariance/kernels.h"
#include "filter/filter.h"
#include "filter/imu_log.h"
#include "filter/imu_path.h"
#include "filter/motion.h"
#include "geometry/lens.h"
#include "vision/image_mask.h"
#include "vision/planar_template.h"

namespace pf {

/// With the numbers of pf_backend_t.
enum class BackEnd : std::uint8_t { kFilter = 1, kWindow = 2 };

/// Room for a mask of the images, and the session's mask in it, which pf_set_mask writes.
struct MaskRoom {
  bool is_asked_for = false;
  ImageMask* mask = nullptr;  ///< null: no room
};

/// What is kept of earlier views, and of what the caller has set in them.
struct KeptRoom {
  int views = 0;
  int places = 0;  ///< of the window
  int anchors = 0;
};

/// Number of inertial samples that are kept, and the ranges of their unit.
struct ImuRoom {
  int buffer = 0;
  ImuRanges ranges;
};

/// Parts of the method that comparisons switch off (planefold_research.h).
struct ResearchForms {
  bool keep_gauge = true;    ///< keeps the covariance consistent with what a camera cannot observe
  bool gate_patches = true;  ///< rejects patches whose corners fail their gate
};

/// The config after it was checked, in the library's own types.
struct Settings {
  Camera camera;
  LensPrior lens;  ///< its prior; no rows where the lens is exact
  const Kernels* kernels = nullptr;

  int max_state_dim = 0;
  int max_features = 0;  ///< of the window, its points
  int max_observations = 0;
  int max_planes = 0;
  KeptRoom kept;
  MaskRoom mask;

  bool constant_velocity =
      true;  ///< velocities of the state move the body, with accelerations where its layout has them
  PartSwitch<kHasInertial>
      inertial;  ///< the samples of an inertial unit move the body; else one of the other two models
  ImuUnit unit;
  BodyLayout body;
  MotionNoise motion_noise = {};
  bool readout_ignored = false;  ///< the camera has a rolling shutter, but no times for its rows
  std::uint8_t window_keyframes = 0, window_fixed = 0;

  Scalar sigma_px = 0;
  Scalar gate = 0;  ///< chi-square bound with two degrees of freedom

  Scalar start_depth = 1;
  bool depth_from_map = true;
  Scalar inverse_depth_relative_sigma = 0;
  Scalar linearity_index = 0;

  bool planes = false;
  std::uint8_t max_patches = 0, patch_side_px = 100, max_cameras = 0;
  int plane_min_points = 0;
  Scalar plane_distance = 0;
  Scalar plane_radius = 0;
  Scalar fold_sigma = 0;
  Scalar fix_sigma = 0;
  FoldRule fold;
  FixForm fix = FixForm::kConsider;

  int features_in_view = 0;
  int min_inliers = 0;  ///< of a frame that counts as tracked
  int border_px = 0;
  float max_misfit = 1;  ///< of a template with a mask, TemplateMatcher::init
  std::int64_t max_coast_ns = 0;
  std::int64_t restart_ns = 0;  ///< of usable images while lost, after which a new map begins; 0: never
  ResearchForms research;
  MaskMode masks = MaskMode::kNone;
  std::uint8_t template_px = 0;  ///< side of templates with masks
  BackEnd backend = BackEnd::kFilter;

  ImuRoom imu;

  Hooks hooks;
};

}  // namespace pf
