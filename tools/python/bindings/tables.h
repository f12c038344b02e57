/// What tables_from_headers.py makes of the headers.
#pragma once

#include <nanobind/nanobind.h>

namespace pf::python {

namespace nb = nanobind;

void add_enums(nb::module_& module);
void add_records(nb::module_& module);

}  // namespace pf::python
