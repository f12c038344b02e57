/// What the module offers beside Slam.
#pragma once

#include <nanobind/nanobind.h>

namespace pf::python {

namespace nb = nanobind;

void add_library(nb::module_& module);    ///< version, status texts, configuration, camera models
void add_sim(nb::module_& module);        ///< rendered scenes
void add_sequences(nb::module_& module);  ///< images on disk
void add_files(nb::module_& module);      ///< calibrations, targets, walls, inertial samples

}  // namespace pf::python
