#include "filter_slam/patches/initialisation/patch_obstacles.h"

#include "filter_slam/patches/tuning.h"
#include "model/camera_at.h"

namespace pf {

using namespace tuning::patch_selection;

Scalar PatchSquare::reach() const { return half() * (Scalar(1) + kMargin); }

bool PatchObstacles::are_in(const PatchSquare& square) const {
  for (int k = 0; k < count; ++k)
    if ((pixel[k] - square.middle()).cwiseAbs().maxCoeff() < square.reach()) return true;
  return false;
}

PatchObstacles find_obstacles(const Filter& filter, const Map& map, const Frame& frame, const PatchRefusals& refusals,
                              int wall) {
  const PlaneEntry& plane = map.planes[wall];
  const Scalar noise = plane.roughness * plane.roughness;
  PatchObstacles obstacles;
  const CameraAt camera = camera_at(filter.state(), Scalar(0));
  refusals.for_each(plane.id, [&](const Vec3& middle_W) {
    Vec2 pixel;
    if (project(filter.lens(), Vec3(camera.q_WC.conjugate() * (middle_W - camera.p_W)), &pixel)) obstacles.add(pixel);
  });
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    Scalar d, variance;
    if (match.feature < 0 || match.status != MatchStatus::kInlier) continue;
    if (filter.distance(plane.slot, map.features[match.feature].slot, &d, &variance) &&
        d * d > kObstacleGate * (variance + noise))
      obstacles.add(match.measured);
  }
  return obstacles;
}

}  // namespace pf
