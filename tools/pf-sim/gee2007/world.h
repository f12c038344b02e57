#pragma once

#include <vector>

#include "camera.h"
#include "sim/random.h"

namespace pfsim::gee {

/// The paper's room and circle, and what the paper leaves open about them.
struct WorldOptions {
  int frames = 10800, frames_per_loop = 5400;
  double fov_deg = 43, sigma_px = 1;
  bool look_inward = true;   ///< radially across the middle; otherwise away from it, at the wall nearby
  bool upright = false;      ///< y of the world is the vertical, so that every wall holds the pole of eq. 5
  double half_height = 1;    ///< of the points [m]
  double nearest = 0.2;      ///< nothing nearer is seen [m]
  int target_frames = 300;   ///< after so many the known square is taken away; 0: it stays
  double clear_radius = 0;   ///< about the middle, without points on no wall [m]
  double target_size = 0.2;  ///< square whose four corners are known [m]
  double target_distance = 0.7, target_slant_deg = 35;
};

struct WorldPoint {
  Vec3 p_W;
  int wall;  ///< 0 to 3, -1 for points on none
};

struct Measurement {
  int id;  ///< of the world's points
  Vec2 z;  ///< [px]
};

/// One run's truth, drawn from one seed: 200 points, a square room of 4 m, a circle of 1 m about its centre.
class World {
 public:
  World(const WorldOptions& options, std::uint64_t seed);

  static constexpr int kTarget = 4;  ///< the first points are the known ones

  const std::vector<WorldPoint>& points() const { return points_; }
  const Camera& camera() const { return camera_; }
  /// v = (q, t) of the camera at a frame.
  Vec7 pose(int frame) const;
  /// What it sees there, with noise: to be called for each frame once, in order.
  std::vector<Measurement> observe(int frame);
  /// Whether a point is in the picture, without noise.
  bool in_view(int id, int frame) const;
  /// From the world to the room's own axes: x and y along walls, z up.
  const Mat3& R_room_W() const { return R_room_W_; }

 private:
  WorldOptions options_;
  Camera camera_;
  pf::sim::Random layout_, noise_;
  Mat3 R_room_W_;
  std::vector<WorldPoint> points_;
};

}  // namespace pfsim::gee
