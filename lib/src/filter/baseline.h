#pragma once

#include "filter/measurement.h"

namespace pf {

class Filter;
struct State;

/// Measurement of the camera's position against an anchor's, over the body and the anchor.
using BaselineMeasurement = MeasurementOf<3, 6, 2>;

/// The baseline between an anchor and the camera, measured as zero:
///
///   z = p - o_W,   e_z = e_p - e_o
///
/// anchor      its block
/// covariance  of the baseline, from another source than the pixels' linearisation [m^2]
void predict_baseline(const State& state, int anchor, const Mat3& covariance, BaselineMeasurement* out);

/// Updates the filter with the baseline. False, with nothing changed, where S is no covariance.
bool take_baseline(Filter& filter, int anchor, const Mat3& covariance);

}  // namespace pf
