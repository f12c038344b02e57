#include "arrays.h"

#include <cstring>
#include <memory>

namespace pf::python {

namespace {

using AnyArray = nb::ndarray<nb::ro, nb::device::cpu>;

std::string shape_text(const AnyArray& array) {
  std::string text;
  for (size_t i = 0; i < array.ndim(); ++i) text += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  return "(" + text + (array.ndim() == 1 ? ",)" : ")");
}

template <class Element>
nb::capsule owner_of(Element* values) {
  return nb::capsule(values, [](void* memory) noexcept { delete[] static_cast<Element*>(memory); });
}

double* copy_of(const double* values, size_t count) {
  auto* copy = new double[count];
  std::memcpy(copy, values, count * sizeof(double));
  return copy;
}

}  // namespace

void read_numbers(const ArrayLike& given, const char* name, double* out, size_t count) {
  const nb::object made = nb::module_::import_("numpy").attr("ascontiguousarray")(given.given, "float64");
  const auto array = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(made);
  if (array.size() != count) {
    throw nb::value_error((std::string(name) + ": takes " + std::to_string(count) + " numbers, and was given " +
                           std::to_string(array.size()))
                              .c_str());
  }
  std::memcpy(out, array.data(), count * sizeof(double));
}

Vector to_vector(const double* values, size_t count) {
  double* copy = copy_of(values, count);
  return Vector(copy, {count}, owner_of(copy));
}

Matrix to_matrix(const double* values, size_t rows, size_t columns) {
  double* copy = copy_of(values, rows * columns);
  return Matrix(copy, {rows, columns}, owner_of(copy));
}

void refuse_seconds() { throw nb::type_error("t_ns: takes whole nanoseconds; of seconds take round(1e9 * seconds)"); }

int64_t to_time(nb::handle t_ns) {
  int64_t time = 0;
  if (!nb::try_cast<int64_t>(t_ns, time)) refuse_seconds();
  return time;
}

pf_image_t to_image(nb::handle image, int64_t t_ns) {
  AnyArray pixels;
  if (!nb::try_cast<AnyArray>(image, pixels)) {
    const std::string given = nb::str(image.type().attr("__name__")).c_str();
    throw nb::type_error(("image: is a " + given + "; a grey image is an array of uint8, rows by columns").c_str());
  }
  if (pixels.dtype() != nb::dtype<uint8_t>()) {
    throw nb::type_error("image: its pixels are not uint8; scale them to 0 .. 255 and take image.astype(numpy.uint8)");
  }
  if (pixels.ndim() != 2) {
    throw nb::value_error(("image: its shape is " + shape_text(pixels) +
                           ", and a grey image has rows and columns alone; cv2.cvtColor makes grey of colour")
                              .c_str());
  }
  constexpr size_t kMaxSide = 1u << 20;
  if (pixels.shape(0) > kMaxSide || pixels.shape(1) > kMaxSide) {
    throw nb::value_error(("image: " + shape_text(pixels) + " pixels are more than any camera has").c_str());
  }
  if ((pixels.shape(1) > 1 && pixels.stride(1) != 1) ||
      (pixels.shape(0) > 1 && (pixels.stride(0) < 0 || pixels.stride(0) > INT32_MAX))) {
    throw nb::value_error(
        "image: its columns do not lie side by side, or its rows run backwards; take numpy.ascontiguousarray(image)");
  }
  const auto width = static_cast<int32_t>(pixels.shape(1));
  const int32_t stride = pixels.shape(0) > 1 ? static_cast<int32_t>(pixels.stride(0)) : width;
  return {static_cast<const uint8_t*>(pixels.data()), width, static_cast<int32_t>(pixels.shape(0)), stride, t_ns};
}

GreyImage copy_image(const pf_image_t& image) {
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  auto copy = std::make_unique<uint8_t[]>(width * height);
  for (size_t row = 0; row < height; ++row) {
    std::memcpy(copy.get() + row * width, image.pixels + row * static_cast<size_t>(image.stride), width);
  }
  uint8_t* pixels = copy.release();
  return GreyImage(pixels, {height, width}, owner_of(pixels));
}

}  // namespace pf::python
