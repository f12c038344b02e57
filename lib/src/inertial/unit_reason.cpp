#include "inertial/unit_reason.h"

#include "inertial/force_check.h"
#include "inertial/moving_start.h"
#include "inertial/unit_watch.h"

namespace pf {

UnitReason reason_of(const UnitWatch& watch, const ForceCheck& forces, const MovingStart& moving, UnitsMap map,
                     Scalar* value, Mat3* R_CB) {
  const UnitReason of_watch = watch.reason(value, R_CB);
  if (of_watch > UnitReason::kContradicts) return of_watch;
  Scalar read = 0;
  const UnitReason of_force = forces.reason(&read);
  if (of_force != UnitReason::kNone) {
    *value = read;
    return of_force;
  }
  if (moving.is_reversed() && !map.is_metric) return UnitReason::kAccelSign;
  if (of_watch != UnitReason::kNone || map.is_metric || !map.has_pose) return of_watch;
  *value = moving.sigma_scale();
  return UnitReason::kWaitsForMotion;
}

}  // namespace pf
