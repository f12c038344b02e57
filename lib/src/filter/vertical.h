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
/// gravity, a translation and a change of scale do not change z. src lib/docs/inertial.md
void predict_vertical(const State& state, int plane, VerticalMeasurement* out);

/// Updates the filter with a plane that is vertical within sigma [rad]. False, with nothing changed, where the plane's NIS is above
/// max_nis. *sigma_before: the standard deviation of z before [rad].
bool take_vertical(Filter& filter, int plane, Scalar sigma, Scalar max_nis, Scalar* sigma_before);

/// Adds back to a plane's tilt against gravity, and to all that has learnt from it, the variance that it had before take_vertical.
void forget_vertical(Filter& filter, int plane, Scalar sigma_before);

}  // namespace pf
