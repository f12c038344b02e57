#pragma once

#include "covariance/tuned/factor.h"
#include "covariance/tuned/gather.h"
#include "covariance/tuned/held.h"
#include "covariance/tuned/moves.h"
#include "covariance/tuned/predict.h"
#include "covariance/tuned/transform_many.h"

namespace pf {
namespace {

constexpr Kernels kTable = {gather, cholesky,    solve_lower, downdate,       predict, augment, transform,
                            remove, gather_many, replace,     transform_many, project, combine, add_product};

}  // namespace
}  // namespace pf
