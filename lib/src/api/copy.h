#pragma once

namespace pf {

/// Copies the library's numbers into the caller's doubles.
template <typename Vector>
void copy(const Vector& from, int count, double* to) {
  for (int i = 0; i < count; ++i) to[i] = static_cast<double>(from[i]);
}

/// Row-major.
template <typename Matrix>
void copy_matrix(const Matrix& from, double* to) {
  const int rows = static_cast<int>(from.rows()), columns = static_cast<int>(from.cols());
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) to[i * columns + j] = static_cast<double>(from(i, j));
}

}  // namespace pf
