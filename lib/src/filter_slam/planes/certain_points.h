#pragma once

#include "filter/filter.h"
#include "frame/settings.h"
#include "map/map.h"

namespace pf {

/// Which features are known well enough to say something of planes.
class CertainPoints {
 public:
  CertainPoints(const Settings& settings, const Filter& filter, const Map& map)
      : settings_(settings), filter_(filter), map_(map) {}

  /// Takes the row of the global scale as the state is now: points that it was made of may be gone or planar since.
  void update_scale() { filter_.scale_row(&scale_); }
  bool knows_scale() const;

  /// Whether a feature is a converged 3-D point that was not found elsewhere since. That it was missed, or has left the view, says nothing
  /// against its place. Points of the target are not folded: their place is known.
  bool is_converged(int entry) const;
  /// Whether it was found when it was last looked for as well. What decides about whole planes asks for that.
  bool is_settled(int entry) const;
  /// Whether a converged point is known well enough to be folded or to support a new plane. The covariance is relative to the camera and
  /// to the global scale.
  bool is_certain(int entry, Mat3* covariance) const;

 private:
  const Settings& settings_;
  const Filter& filter_;
  const Map& map_;
  ScaleRow scale_;  ///< picks the log scale out of an error
};

}  // namespace pf
