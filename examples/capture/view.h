#ifndef PLANEFOLD_CAPTURE_VIEW_H
#define PLANEFOLD_CAPTURE_VIEW_H

#include <planefold/planefold.h>

#include <cstdint>
#include <string>
#include <vector>

#include "hits.h"
#include "plane_colour.h"
#include "plane_view.h"

namespace pf::capture {

/// The motion of the camera over one window of frames.
struct MotionWindow {
  pf_motion_t motion{};
  int map = 1;           ///< of the run, as in FrameView
  double nees = -1.0;    ///< against the truth; negative where there is none
  int64_t nees_dof = 0;  ///< its degrees of freedom
};

/// Everything that one frame left behind, copied out of the library: what is written down and what is drawn.
struct FrameView {
  int64_t index = 0;  ///< of the frames of this run, from 0
  int64_t count = 0;  ///< 0: nobody knows
  pf_image_t image{};
  std::vector<uint8_t> pixels;  ///< what image.pixels points to
  pf_status_t status = PF_OK;
  pf_report_t report{};
  bool has_pose = false;
  bool tracked = false;  ///< at least 8 inliers in this frame, and a pose that comes from them
  pf_pose_t pose{};
  pf_camera_t camera{};       ///< the lens that the pose belongs to: the calibration, as it is known now
  bool has_inertial = false;  ///< poses depend on a unit's samples, and it has begun
  pf_inertial_t inertial{};
  bool has_gravity = false;  ///< by the user or by the unit: planes have classes
  int map = 1;               ///< of the run, from 1; a map in which nothing was tracked leaves its number to the next
  double ms = 0.0;
  std::vector<pf_match_t> tracks;
  std::vector<pf_feature_t> features;
  std::vector<pf_patch_t> patches;
  std::vector<PlaneView> planes;
  std::vector<Hit> hits;  ///< what the user pointed at so far
  std::vector<pf_anchor_t> anchors;
};

/// Of a plane in this frame: that of its class where gravity is known, else that of its number.
PlaneColour colour_of_plane(const FrameView& view, uint32_t id);

inline const char* state_name(int32_t state) {
  switch (state) {
    case PF_STATE_STARTING:
      return "starting";
    case PF_STATE_TRACKING:
      return "tracking";
    case PF_STATE_COASTING:
      return "coasting";
    default:
      return "lost";
  }
}

/// Why a frame was not tracked; "none" where it was.
inline const char* reason_name(int32_t reason) {
  static const char* const kNames[] = {"none",       "nothing_in_view", "few_found", "disagree",
                                       "improbable", "uncertain",       "lens"};
  return reason >= 0 && reason <= PF_FRAME_REASON_LENS ? kNames[reason] : "unknown";
}

}  // namespace pf::capture

#endif
