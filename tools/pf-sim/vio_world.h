#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "planefold_platform/sim.h"
#include "sim/trajectory.h"

namespace pfsim {

/// Points of a room, and a walk through it. W has y down.
class VioWorld {
 public:
  VioWorld(std::uint64_t seed, int points, double seconds, double rest_s, double turn_rad_s);
  /// A camera that moves from the first frame on, faster or slower, with more or less of a hand's shaking.
  enum class Motion { kVaried, kRotation, kEven };
  VioWorld(std::uint64_t seed, int points, double seconds, Motion motion);
  /// A rendered scene, and the walk that belongs to it, with `shake` times its hand's shaking.
  VioWorld(std::uint64_t seed, const std::string& scene, double rest_s, double shake);

  const pf_camera_t& camera() const { return camera_; }
  const pf::sim::Trajectory& path() const { return path_; }
  /// The rendered scene, or null.
  const pf_sim_t* scene() const { return room_.get(); }
  const std::vector<pf::sim::Vec3>& points() const { return points_; }
  /// A hand of kHand points, 0.4 m before the camera, that waves about: pixels with noise, their ids behind those of the points.
  void wave(double t, double sigma_px, pf::sim::Random& noise, std::vector<pf_observation_t>* seen) const;
  /// Pixels with noise of the points that the camera sees at time t, each row at its own time: the whole picture takes readout_s.
  std::vector<pf_observation_t> observe(double t, double readout_s, double sigma_px, pf::sim::Random& noise) const;
  /// How far from the camera the rendered scene is along the rays of points in the camera's axes [m]; negative: nothing is seen there.
  std::vector<double> distances(const pf::sim::Pose& pose, const std::vector<pf::sim::Vec3>& p_C) const;
  /// The picture that the camera sees at time t, in `grey`, each row from its own time's pose: the whole picture takes readout_s. False
  /// where nothing is rendered.
  bool draw(double t, double readout_s, double noise_grey, pf::sim::Random& noise,
            std::vector<std::uint8_t>* grey) const;

 private:
  /// When a row is read out, from the frame's time [s].
  double row_time(double readout_s, double row) const;
  bool project(const pf::sim::Pose& pose, const pf::sim::Vec3& point, double pixel[2]) const;

  pf_camera_t camera_;
  std::shared_ptr<pf_sim_t> room_;
  pf::sim::Trajectory path_;
  std::vector<pf::sim::Vec3> points_;
};

}  // namespace pfsim
