#include <nanobind/nanobind.h>

#include "context.h"
#include "functions.h"
#include "tables.h"

// lib/docs/guide/python.md shows how these are used.
NB_MODULE(_core, module) {
  module.doc() = "The C library behind the package planefold.";
  pf::python::add_enums(module);
  pf::python::add_records(module);
  pf::python::add_library(module);
  pf::python::add_slam(module);
  pf::python::add_sim(module);
#ifdef PLANEFOLD_HAVE_SEQUENCE
  pf::python::add_sequences(module);
  pf::python::add_files(module);
#endif
}
