#include "covariance/reference/reference.h"

namespace pf {

const Kernels& reference_kernels() {
  using namespace reference;
  static constexpr Kernels kSet = {gather, cholesky,    solve_lower, downdate,       predict, augment, transform,
                                   remove, gather_many, replace,     transform_many, project, combine, add_product};
  return kSet;
}

}  // namespace pf
