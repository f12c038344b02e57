#include "model/place.h"

#include "model/tuning.h"

namespace pf {

bool Place::resolve() {
  if (w_column < 0) return true;
  if (!(w > tuning::inverse_depth::kMinRho)) return false;
  const Scalar depth = Scalar(1) / w;
  for (int c = 0; c < columns; ++c) J_o.col(c) += depth * J_b.col(c);
  J_o.col(w_column) = -depth * depth * b;
  o = o + depth * b;
  w_column = -1;
  return true;
}

}  // namespace pf
