#pragma once

#include <cstdint>

#include "geometry/so3.h"
#include "model/block.h"
#include "model/body.h"

namespace pf {

/// How an error changes when the whole world is translated (columns 0-2), rotated (3-5) and scaled by exp(s) (6). A model cannot
/// observe some of these directions. Observable directions keep their columns, too.
namespace gauge {
inline constexpr int kTranslation = 0, kRotation = 3, kScale = 6, kDirections = 7;

/// A bit for each direction that a model cannot observe; State::unobservable has the model's.
using Set = std::uint8_t;
inline constexpr Set kBareCamera = 0x7f;  ///< all of them
inline constexpr Set kMetric = 0x3f;      ///< all but the scale

constexpr bool contains(Set set, int direction) { return (set >> direction & 1) != 0; }
}  // namespace gauge

template <int kRows>
using GaugeRowsOf = Eigen::Matrix<Scalar, kRows, gauge::kDirections>;
using GaugeRows = GaugeRowsOf<Block::kMaxRows>;

/// Columns translation, rotation, scale of axes of a place in W:  (I, -[p]x, p) along each axis.
template <int kRows, typename Rows>
void put_place(const Eigen::Matrix<Scalar, kRows, 3>& axes, const Vec3& p_W, Rows* N) {
  for (int i = 0; i < kRows; ++i) {
    const Vec3 axis = axes.row(i).transpose();
    const Vec3 moment = p_W.cross(axis);  // -axisᵀ [p]x
    for (int k = 0; k < 3; ++k) {
      (*N)(i, k) = axis(k);
      (*N)(i, 3 + k) = moment(k);
    }
    (*N)(i, 6) = axis.dot(p_W);
  }
}

/// Gauge rows of one part of the body.
struct BodyGaugeRows {
  int first = 0, size = 0;
  GaugeRowsOf<3> N;
};

/// The body's gauge rows, one entry for each of its parts that has any. Velocities in W rotate and scale with the world; angular velocities
/// and biases, in axes of the body, do not change; accelerations in such axes scale. Gravity rotates with the world, about all axes but its
/// own. An inertial unit keeps its distance from the camera when the world is scaled, so only the camera's part of its velocity scales.
/// Returns how many.
inline constexpr int kMaxBodyGaugeParts = 4;
int body_gauge_rows(const Body& body, const BodyLayout& layout, const Mounting& mounting, BodyGaugeRows* out);

/// Calls f(first row, size, rows) for each of them.
template <typename F>
void for_each_body_gauge(const Body& body, const BodyLayout& layout, const Mounting& mounting, F&& f) {
  BodyGaugeRows part[kMaxBodyGaugeParts];
  const int count = body_gauge_rows(body, layout, mounting, part);
  for (int k = 0; k < count; ++k) f(part[k].first, part[k].size, part[k].N);
}

/// Sums gauge rows over the whole state, one dense row per direction, each times sign.
struct GaugeSum {
  Scalar sign;
  Scalar* N_T;  ///< null where translations are left out
  Scalar* N_R;
  Scalar* N_s;
  int ld;

  template <typename Rows>
  void add(int first, int size, const Rows& N) const {
    for (int i = 0; i < size; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        if (N_T != nullptr) N_T[axis * ld + first + i] += sign * N(i, axis);
        N_R[axis * ld + first + i] += sign * N(i, 3 + axis);
      }
      N_s[first + i] += sign * N(i, 6);
    }
  }
  /// Of a point in W: I, -[p]x, p.
  void add_point(int first, const Vec3& p_W) const {
    const Vec3 p = sign * p_W;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      if (N_T != nullptr) N_T[i * ld + first + i] += sign;
      N_R[j * ld + first + i] += p(k);
      N_R[k * ld + first + i] -= p(j);
      N_s[first + i] += p(i);
    }
  }
};

}  // namespace pf
