#pragma once

#include "filter/measurement.h"

namespace pf {

class Filter;
struct State;

/// How upright a plane is, over the plane and gravity's direction.
using VerticalMeasurement = MeasurementOf<1, 5, 2>;

/// The component of a plane's unit normal along gravity's direction g = R_WG e_z, measured as zero: the plane is vertical.
///
///   z = n_W . g,   e_z = g^T J_n_x e_x + n^T E d,   E = (-R_WG e_y, R_WG e_x)
///
/// x is the plane's (a, b, h), d the error of gravity's direction (model/body.h). The state has gravity. A rotation of the world with
/// gravity, a translation and a change of scale do not change z. src lib/docs/theory/inertial.md
void predict_vertical(const State& state, int plane, VerticalMeasurement* out);

/// What a plane was stated to be vertical with: sigma and directions.
struct VerticalRow {
  Scalar sigma = 0;         ///< [rad] as stated; 0: not stated
  Scalar before = 0;        ///< [rad] of the plane's tilt before
  Vec3 n_W = Vec3::Zero();  ///< the plane's normal, as it was estimated then
  Vec3 g_W = Vec3::Zero();  ///< gravity's direction then

  bool is_told() const { return sigma > Scalar(0); }
};

/// Updates the filter with a plane that is vertical within sigma [rad]. False, with nothing changed, where the plane's NIS is above
/// max_nis. *told: for forget_vertical.
bool take_vertical(Filter& filter, int plane, Scalar sigma, Scalar max_nis, VerticalRow* told);

/// Removes what take_vertical contributed to a plane's tilt against gravity and to all that is correlated with it, and nothing that came
/// from others since.
void forget_vertical(Filter& filter, int plane, const VerticalRow& told);

/// After `gone` was removed: what was known before another plane was stated to be vertical may have come from it.
void allow_for_forgotten(const VerticalRow& gone, VerticalRow* other);

}  // namespace pf
