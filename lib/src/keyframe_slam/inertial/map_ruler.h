#pragma once

#include "filter/filter.h"
#include "geometry/similarity.h"
#include "vision/appearance.h"

/// Where a filter that knows a body alone has the map that measures this body (lib/docs/theory/window.md, "An inertial unit").

namespace pf {

class Archive;

/// The filter's state holds one place o of the map and, as an inverse depth rho, one of its lengths. With z_o and d the same in the
/// coordinates of the map, which are known, a place z of the map is
///
///   p = o + s (z - z_o),   s = 1 / (rho d)
///
/// so that errors of (p, o, rho) are one of z:   e_z = (e_p - e_o) / s + d (p - o) e_rho
class MapRuler {
 public:
  /// Pose and velocities (theta, p, v, w) in the map by errors of the state: of the body's pose and velocity, the gyroscope's bias, o, rho.
  using MotionRows = RowsOf<12, 16, 4>;
  using PoseMeasurement = MeasurementOf<6, 16, 4>;

  explicit MapRuler(Filter& filter) : filter_(filter) {}

  /// The filter has begun with the body at a place of the map, in the map's coordinates: these are the filter's. length: of the map, known
  /// to a share. False where there is no room.
  bool begin(const Vec3& at, Scalar length, Scalar share);

  /// s.
  Scalar scale() const { return 1 / (rho() * length_); }
  Scalar scale_variance() const;  ///< of ln s
  /// From the map's coordinates to the filter's.
  Similarity to_filter() const;
  /// The body in the map.
  Body body() const;
  void set_rows(const Mat3& rate_by_bias, MotionRows* out) const;
  /// Sets what the map has measured of the body's pose.
  void set_measurement(const Quat& q_WC, const Vec3& z, const Mat6& R, PoseMeasurement* out) const;

  /// The map is moved as a whole, and the filter's W with it but for its lengths. keeps_lengths: those of the filter are the right ones;
  /// else they are the map's.
  void move(const Similarity& T, bool keeps_lengths);
  /// The map about the body is moved to where it has this pose, in W as it was.
  void move_about(const CameraView& before, const CameraView& now);
  /// The map about z has moved on in W, by (theta, p) with this covariance, and its size has changed by a share.
  void drift(const Mat6& Q, const Vec3& z, Scalar sigma_scale);

  /// The state has what this refers to.
  bool is_sound() const;
  void carry(Archive& archive);  ///< base/archive.h

 private:
  Vec3 place() const { return filter_.state().block[place_slot_].xyz(); }
  Scalar rho() const { return filter_.state().block[length_slot_].inverse_depth().rho; }
  void rotate_body(const Quat& q, bool with_gravity);

  Filter& filter_;
  int place_slot_ = -1, length_slot_ = -1;
  Vec3 z_o_ = Vec3::Zero();
  Scalar length_ = 1;  ///< d
};

}  // namespace pf
