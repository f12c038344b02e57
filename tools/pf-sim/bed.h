#pragma once

#include <cstdint>
#include <vector>

#include "planefold/planefold.h"
#include "sim/trajectory.h"

namespace pfsim {

/// What the world of a run is drawn from.
enum class Layout {
  kModel,  ///< depths from the filter's own prior: each point is placed when it begins
  kRoom    ///< 200 points of a room, half of them on its walls
};

struct BedOptions {
  Layout layout = Layout::kModel;
  bool circle = false;          ///< the paper's fixed circle; otherwise motion drawn from the model, with steering
  bool look_inward = true;      ///< on the circle: across the middle; otherwise away from it
  double circle_seconds = 180;  ///< for one loop
  double fov_deg = 80;          ///< horizontal
  int frames = 1800;
  double rate_hz = 30;
  int points_in_view = 44;       ///< kModel: points begin while fewer are in view
  int first_birth = 15;          ///< frame from which points other than the target's begin
  int target_points = 9;         ///< on a square grid of target_size
  double target_size = 0.25;     ///< [m]
  double target_distance = 0.7;  ///< [m]
  double target_slant_deg = 35;  ///< between its normal and the line of sight
  double sigma_start_m = 0.02, sigma_start_deg = 1;
  double sigma_start_v = 0.1, sigma_start_w = 0.1;  ///< [m/s], [rad/s]
  double room_half_height = 0.5;                    ///< of the points [m]
  double steer_seconds = 45;                        ///< for one turn of the nominal view
  bool draw_lens =
      false;  ///< the true camera is drawn from the standard deviations that the filter's calibration states
};

/// A point of the world. Points are told to the filter by their index here.
struct WorldPoint {
  pf::sim::Vec3 p_W;
  bool begun = false;    ///< was ever observed
  bool retired = false;  ///< the filter gave it up; it does not come back
  int wall = -1;         ///< that it lies on, 0 .. 3
};

/// One run's truth: where the camera is, what it sees, and the starting knowledge, all drawn from one seed.
///
/// Steering is computed from the filter's estimate, which it knows, and never from the truth.
class Bed {
 public:
  Bed(const BedOptions& options, const pf_config_t& config, std::uint64_t seed);

  static pf_camera_t camera(double fov_deg);

  const pf_target_t& target() const { return target_; }
  const pf_pose_t& start() const { return start_; }
  const double* velocity_covariance() const { return velocity_covariance_; }
  const std::vector<WorldPoint>& points() const { return points_; }
  const pf::sim::MotionState& truth() const { return truth_; }
  /// The true camera.
  const pf_camera_t& lens() const { return lens_; }

  /// Of a room's wall 0 .. 3, into the room.
  static pf::sim::Vec3 wall_normal(int wall);

  /// Steering that brings the estimate towards the nominal way.
  void steer(int frame, const pf_pose_t& estimate, double dv_C[3], double dw_C[3]) const;

  /// Moves the camera to the next frame.
  void move(int frame, const double dv_C[3], const double dw_C[3]);

  /// What the camera measures at this frame; may place new points. `births` counts those seen for the first time.
  std::vector<pf_observation_t> observe(int frame, int* births);

  /// The filter does not have this point (any more): it is not offered again.
  void retire(std::uint32_t id) { points_[id].retired = true; }

 private:
  pf::sim::Pose nominal(int frame) const;
  void draw_lens(std::uint64_t seed);
  void place_target();
  void place_room();
  bool in_view(const pf::sim::Vec3& p_W, double pixel[2]) const;

  BedOptions options_;
  pf_config_t config_;
  pf_camera_t lens_;
  pf::sim::Random world_, motion_, noise_, start_draw_;
  pf::sim::MotionState truth_;
  pf_target_t target_{};
  pf_pose_t start_{};
  double velocity_covariance_[36] = {};
  std::vector<WorldPoint> points_;
};

}  // namespace pfsim
