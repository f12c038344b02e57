#pragma once

#include <vector>

namespace pfsim {

/// Value below which a chi-square variable with that many degrees of freedom lies with probability p, 0 < p < 1.
double chi_square_quantile(double p, double degrees);

/// e^T P^-1 e for the n x n block of P (row-major, leading dimension ld) that starts at `first`; negative when the
/// block is not positive definite.
double normalised_error(const double* e, const double* P, int n, int ld, int first);

/// Largest eigenvalue of A^-1/2 B A^-1/2 for symmetric n x n (n <= 7), A positive definite; NaN when it is not.
double largest_ratio(const double* A, const double* B, int n, int ld);

double median(std::vector<double> values);

}  // namespace pfsim
