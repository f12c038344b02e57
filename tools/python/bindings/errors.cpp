#include "errors.h"

#include <nanobind/stl/string.h>

namespace pf::python {

namespace {

[[noreturn]] void raise(const char* type, const nb::object& error) {
  PyErr_SetObject(nb::module_::import_("planefold._errors").attr(type).ptr(), error.ptr());
  throw nb::python_error();
}

}  // namespace

void check(pf_status_t status, const char* call, const char* field) {
  if (status >= PF_OK) return;
  const std::string line =
      field != nullptr
          ? std::string(field) + " is out of its range; the documentation of this field says what is possible"
          : pf_status_text(status);
  raise_error(status, std::string(call) + ": " + line, field);
}

void raise_error(pf_status_t status, const std::string& line, const char* field) {
  const nb::object type = nb::module_::import_("planefold._errors").attr("Error");
  raise("Error", type(line, static_cast<int>(status), field));
}

void raise_refused(const std::string& line) {
  raise("Refused", nb::module_::import_("planefold._errors").attr("Refused")(line));
}

}  // namespace pf::python
