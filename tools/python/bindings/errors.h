/// Refusals as Python exceptions of one line.
#pragma once

#include <nanobind/nanobind.h>
#include <planefold/planefold.h>

#include <string>

namespace pf::python {

namespace nb = nanobind;

/// planefold.Error where the status is one. `call` is the Python name of what was called, `field` that of the config's bad field.
void check(pf_status_t status, const char* call, const char* field = nullptr);

/// The same, and tells the status on, which then says something to know.
inline pf_status_t checked(pf_status_t status, const char* call) {
  check(status, call);
  return status;
}

/// planefold.Error with a line of its own.
[[noreturn]] void raise_error(pf_status_t status, const std::string& line, const char* field = nullptr);

/// planefold.Refused: what was given cannot be used.
[[noreturn]] void raise_refused(const std::string& line);

}  // namespace pf::python
