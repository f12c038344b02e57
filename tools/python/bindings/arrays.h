/// Numbers, points and images from NumPy, and back.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <planefold/planefold.h>

#include <array>
#include <string>

namespace pf::python {

namespace nb = nanobind;

/// An argument that is whatever NumPy makes an array of.
struct ArrayLike {
  nb::object given;
};

/// `count` numbers in any shape that has as many; `name` is that of the argument.
void read_numbers(const ArrayLike& given, const char* name, double* out, size_t count);

template <size_t N>
std::array<double, N> numbers(const ArrayLike& given, const char* name) {
  std::array<double, N> out{};
  read_numbers(given, name, out.data(), N);
  return out;
}

using Vector = nb::ndarray<nb::numpy, double, nb::ndim<1>>;
using Matrix = nb::ndarray<nb::numpy, double, nb::ndim<2>>;

Vector to_vector(const double* values, size_t count);
Matrix to_matrix(const double* values, size_t rows, size_t columns);

/// A grey image in the caller's own memory. Refused in one line: another type than uint8, another number of dimensions, and columns that
/// do not lie side by side. Rows may lie apart.
pf_image_t to_image(nb::handle image, int64_t t_ns);

/// Whole nanoseconds. A number with a fraction, which would be seconds, is refused.
int64_t to_time(nb::handle t_ns);
[[noreturn]] void refuse_seconds();

using GreyImage = nb::ndarray<nb::numpy, uint8_t, nb::ndim<2>>;
GreyImage copy_image(const pf_image_t& image);

}  // namespace pf::python

namespace nanobind::detail {

template <>
struct type_caster<pf::python::ArrayLike> {
  NB_TYPE_CASTER(pf::python::ArrayLike, const_name("numpy.typing.ArrayLike"))

  bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
    value.given = borrow(source);
    return true;
  }
};

}  // namespace nanobind::detail
