#pragma once

#include "model/state.h"

namespace pf {

enum class TargetKind : int { kNone = 0, kRectangle = 1, kPoints = 2 };

/// A known object that the camera sees first.
struct Target {
  static constexpr int kMaxPoints = 16;

  TargetKind kind = TargetKind::kNone;
  Scalar width = 0, height = 0;  ///< rectangle [m]; T is its centre, x right, y down, z into the wall
  bool has_place = false;        ///< of a rectangle: T_WT is known; else T is W
  Quat q_WT = Quat::Identity();
  Vec3 p_WT = Vec3::Zero();
  int count = 0;
  Vec3 point_W[kMaxPoints];
  Scalar sigma_m = 0;  ///< of each coordinate of each point
  Body first_pose;     ///< approximate pose of the first camera (points)
  Mat6 first_covariance = Mat6::Zero();
};

/// A known body at the first frame, with its covariance (over the known rows of its layout, row-major).
struct KnownBody {
  bool given = false;
  Body body;
  Scalar covariance[BodyLayout::kVelocityRows * BodyLayout::kVelocityRows] = {};
};

}  // namespace pf
