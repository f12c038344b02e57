#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "frame/frame.h"
#include "map/map.h"

/// Where points on planes are by themselves. Such a point has no depth of its own: its pixels update the plane, and a point not on the
/// plane bends it until they fit. So the depth is estimated beside the filter as well, along the ray on which the point was seen
/// when it was folded or began on the plane, from its pixels alone, at the poses that the filter has:
///
///   p(s) = x + s d,   d = (x - c) / |x - c|            x, c  places of point and camera at the fold, or at the first match
///   N += J^T J,   b += J^T (z - pi(p(s_k)) + J s_k),   J = d pi(p(s)) / ds,   s = b / N [m],  its variance sigma_z^2 / N
///
/// Drifted poses move all of these places alike, so a comparison of the places with each other is not affected (map/plane_majority.h).

namespace pf {

class Archive;

class OwnPlaces {
 public:
  OwnPlaces(const Filter& filter, const Map& map, const Frame& frame) : filter_(filter), map_(map), frame_(frame) {}

  bool layout(Arena& arena, int max_features);
  void init();

  /// Takes in this frame's matches of points on planes. A plane that has gone since end_with_planes() went because the map began again.
  void update();
  /// Points of planes that ended in this frame were on none.
  void end_with_planes();
  /// Id of the plane that a feature was on when the map began again with the same features, and that has not been found since; 0: none.
  std::uint32_t lost_plane(int feature) const;
  /// It is not looked for any more.
  void give_up(std::uint32_t plane);
  /// The map's lengths are multiplied by s, about W's origin.
  void scale(Scalar s);
  /// Begins again with the points of a plane, which has moved.
  void forget(int plane_slot);
  /// Place of a folded feature, and the variance of its distance from a plane with this normal, for pixels that are known to one pixel.
  /// False where its pixels have measured nothing yet.
  bool find(int feature, const Vec3& n_W, Vec3* p_W, Scalar* variance) const;

  /// The depth of a feature by its own pixels, along the ray: how much farther it is than where it was put [m], the variance of that for
  /// pixels that are known to one pixel, and the ray. False where they have measured nothing yet.
  bool depth(int feature, Scalar* farther, Scalar* variance, Vec3* ray_W) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// In float in both libraries.
  struct Own {
    std::uint32_t id = 0, plane = 0;  ///< of the feature and its plane; 0: there is none
    float place_W[3] = {0, 0, 0};     ///< x
    float ray_W[3] = {0, 0, 0};       ///< x - c
    float N = 0, b = 0;               ///< [px²/m², px²/m]; N < 0: the map began again without the plane
  };

  void begin(int feature, std::uint32_t plane);
  bool is_lost(int feature) const { return own_[feature].N < 0; }
  void add(const Match& match, const struct CameraAt& camera);

  const Filter& filter_;
  const Map& map_;
  const Frame& frame_;
  Own* own_ = nullptr;  ///< of each row of the feature table
};

}  // namespace pf
