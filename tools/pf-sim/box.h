#pragma once

#include <cstdint>
#include <vector>

#include "planefold/planefold.h"
#include "planefold_platform/sim.h"
#include "sim/scene_box.h"
#include "sim/trajectory.h"

/// A box of 1 m with posters on its four sides, circled by a hand at 2 m, and a plan of it whose angles are wrong by up to 6 degrees: the
/// first experiment of Servant 2008, section 3 (lib/docs/theory/walls.md).

namespace pfsim {

/// What the filter is told about the box.
enum class Plan {
  kNone,     ///< nothing: points only
  kRefined,  ///< four walls, with the standard deviations that their errors are drawn from
  kExact,    ///< the same wrong walls, as if they were exact (sigmas of 1e-6)
  kUngated,  ///< likewise, and patches are taken in whatever their innovation, as in the paper's comparison
  kAbsent,   ///< likewise refined, and a fifth wall half a metre before one side, which is not there
  kShifted,  ///< one of the four is 1 m off, and its sigma is that of the others
  kMissing,  ///< three walls: what kShifted is compared with
  kHalf      ///< two walls opposite each other
};

using pf::sim::kBoxSides;

struct BoxOptions {
  int frames = 930;
  double rate_hz = 30;
  double loop_seconds = 30;     ///< once around, after one second at rest; of points only
  int points_on_side = 40;      ///< of a poster of 0.9 m
  double max_angle_deg = 6;     ///< of a wall's normal in the plan; directions and angles spread evenly over that cone
  double sigma_offset = 0.002;  ///< of a wall in the plan [m]
  double sigma_start_m = 0.002, sigma_start_deg = 0.1;  ///< of the first pose
  double shake_m = 0.01, shake_rad = 0.01;              ///< of the hand
  double black_from_s = 0, black_s = 0;                 ///< frames that are black; rendered ones only
  double gross = 0;  ///< share of patches that are found at a wrong place (GrossPatches), likewise
};

/// One run's truth and its plan, drawn from one seed. Every plan of a seed has the same walls, views and noise.
class Box {
 public:
  /// film: rendered frames of it, whose path is the truth; null: points and a path of its own.
  Box(const BoxOptions& options, const pf_camera_t& camera, double sigma_px, std::uint64_t seed,
      const pf_sim_t* film = nullptr);

  /// Of a side 0 .. 3, as it truly is: out of the box, and its centre.
  static pf::sim::Vec3 normal(int side);
  static pf::sim::Vec3 centre(int side);

  const pf_pose_t& start() const { return start_; }
  const double* velocity_covariance() const { return velocity_covariance_; }
  pf::sim::Pose truth(int frame) const { return path_(frame / options_.rate_hz); }
  std::vector<pf_wall_prior_t> walls(Plan plan) const;
  /// The wall of walls(plan) that is not where the plan has it, or -1.
  static int wrong_wall(Plan plan) { return plan == Plan::kAbsent ? kBoxSides : plan == Plan::kShifted ? 1 : -1; }

  /// Pixels of the frame; frames must come in order.
  std::vector<pf_observation_t> observe(int frame);
  /// Points of the posters that are seen through the outline of a wall in this frame, if it stood there.
  int count_behind(const pf_wall_prior_t& wall, int frame) const;

 private:
  struct Point {
    pf::sim::Vec3 p_W;
    int side;
  };
  bool in_view(const Point& point, const pf::sim::Pose& pose, double pixel[2]) const;

  BoxOptions options_;
  pf_camera_t camera_;
  double sigma_px_;
  pf::sim::Random noise_;
  pf::sim::Trajectory path_;
  std::vector<Point> points_;
  pf_wall_prior_t plan_[kBoxSides] = {};
  pf_pose_t start_{};
  double velocity_covariance_[36] = {};
};

}  // namespace pfsim
