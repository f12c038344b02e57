#pragma once

// Linear algebra of large dense matrices for the formulas of the textbook. Compiled once: decompositions are slow to compile.

#include <vector>

#include "base/eigen.h"

namespace pf {

using Dense = Eigen::MatrixXd;

Dense inverse_of(const Dense& A);
/// A^-1 b of a symmetric positive definite A.
Dense solved(const Dense& A, const Dense& b);
/// L of a symmetric positive definite S = L L^T.
Dense lower_factor(const Dense& S);
/// Of a symmetric matrix, ascending; vectors (null to skip) are columns.
Eigen::VectorXd eigenvalues_of(const Dense& A, Dense* vectors = nullptr);

/// Root mean square of what is left of `found` after the similarity that takes it closest to `truth`.
double error_after_sim3(const std::vector<Eigen::Vector3d>& found, const std::vector<Eigen::Vector3d>& truth);

}  // namespace pf
