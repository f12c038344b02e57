/// A file's name: a string, or whatever of Python is a path.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

namespace pf::python {

struct Path {
  std::string text;
  const char* c_str() const { return text.c_str(); }
};

}  // namespace pf::python

namespace nanobind::detail {

template <>
struct type_caster<pf::python::Path> {
  NB_TYPE_CASTER(pf::python::Path, const_name("str | os.PathLike[str]"))

  bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
    const object name = steal(PyOS_FSPath(source.ptr()));
    const char* text = name.is_valid() && PyUnicode_Check(name.ptr()) ? PyUnicode_AsUTF8(name.ptr()) : nullptr;
    PyErr_Clear();
    if (text != nullptr) value.text = text;
    return text != nullptr;
  }
};

}  // namespace nanobind::detail
