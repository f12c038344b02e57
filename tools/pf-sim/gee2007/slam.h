#pragma once

#include <map>
#include <vector>

#include "discovery.h"
#include "ekf.h"
#include "world.h"

namespace pfsim::gee {

/// What the filter believes and where it is cautious; the paper's values where it gives them.
struct SlamOptions {
  double sigma_px = 1;
  double sigma_turn = 0.002, sigma_step = 0.002;              ///< of eq. 1 for one frame [rad], [m]
  double rho = 1 / 1.2, sigma_rho = 0.5 / 1.2;                ///< prior of inverse depth [1/m]
  double linearity = 0.1;                                     ///< below it an inverse depth becomes a 3-D point
  int first_birth = 15;                                       ///< frame from which points begin
  double sigma_start_turn = 0.0175, sigma_start_step = 0.02;  ///< of the first pose [rad], [m]
  bool planes = false, fixing = false;
  double sigma_fix = 0.001;  ///< [m]
  DiscoveryOptions discovery;
};

enum class Kind { kInverseDepth, kPoint, kPlanar, kFixed };

struct Feature {
  Kind kind = Kind::kInverseDepth;
  int block = -1;  ///< of the filter; -1 when fixed
  int plane = -1;
  Vec2 fixed{0, 0};  ///< in its plane [m]
};

/// A plane of the state, and the points that were folded into it, by their ids.
struct Plane {
  int block;
  std::vector<int> points;
};

/// The paper's system, frame by frame: random walk, inverse depth, 3-D points, planes, planar points, fixed points.
class Slam {
 public:
  /// known: points whose place is told without error; they are measured and are no part of the state.
  Slam(const SlamOptions& options, const Camera& camera, const Vec7& first_pose, const std::vector<Vec3>& known,
       std::uint64_t seed);

  /// One frame; false when the estimate is no longer a number or the update was impossible.
  bool step(int frame, const std::vector<Measurement>& seen);

  Vec7 pose() const { return ekf_.value(0); }
  MatX pose_covariance() const { return ekf_.covariance(0); }
  int dimension() const { return ekf_.dimension(); }
  const std::map<int, Feature>& features() const { return features_; }
  const std::vector<Plane>& planes() const { return planes_; }
  Vec7 plane(int index) const { return ekf_.value(planes_[static_cast<std::size_t>(index)].block); }

  /// A feature's place in W; J its derivatives with respect to the blocks it hangs on; null to skip.
  Vec3 place(const Feature& feature, std::vector<Touch>* J = nullptr) const;
  Mat3 place_covariance(const Feature& feature) const;

 private:
  bool update(const std::vector<Measurement>& seen);
  void begin(const std::vector<Measurement>& seen);
  void drop_behind();
  void convert();
  void fold();
  void discover();
  void fix();
  double largest_sigma(int block) const;
  int best_plane(const Vec3& m) const;

  SlamOptions options_;
  Camera camera_;
  Ekf ekf_;
  std::vector<Vec3> known_;
  std::map<int, Feature> features_;
  std::vector<Plane> planes_;
  Discovery discovery_;
};

}  // namespace pfsim::gee
