#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <optional>

#include "arrays.h"
#include "docs.h"
#include "errors.h"
#include "functions.h"

namespace pf::python {

namespace {

std::string version() {
  const uint32_t number = pf_version();
  return std::to_string(number >> 16) + "." + std::to_string(number >> 8 & 255) + "." + std::to_string(number & 255);
}

void check_config(const pf_config_t& config) {
  const char* field = nullptr;
  const pf_status_t status = pf_config_check(&config, &field);
  check(status, "check_config", field);
}

void set_research(pf_config_t& config, const std::optional<pf_research_t>& research) {
  check(pf_config_set_research(&config, research ? &*research : nullptr), "set_research");
}

pf_research_t get_research(const pf_config_t& config) {
  pf_research_t research{};
  check(pf_config_get_research(&config, &research), "get_research");
  return research;
}

Vector project(const pf_camera_t& camera, const ArrayLike& p_C) {
  double pixel[2] = {};
  check(pf_camera_project(&camera, numbers<3>(p_C, "p_C").data(), pixel), "project");
  return to_vector(pixel, 2);
}

Vector unproject(const pf_camera_t& camera, const ArrayLike& pixel) {
  double ray[3] = {};
  check(pf_camera_unproject(&camera, numbers<2>(pixel, "pixel").data(), ray), "unproject");
  return to_vector(ray, 3);
}

pf_memory_t query_memory(const pf_config_t& config) {
  pf_memory_t memory{};
  check_config(config);
  check(pf_memory_query(&config, &memory), "query_memory");
  return memory;
}

}  // namespace

void add_library(nb::module_& module) {
  module.def("version", version, doc::pf_version);
  module.def(
      "status_text", [](int status) { return std::string(pf_status_text(static_cast<pf_status_t>(status))); },
      nb::arg("status"), doc::pf_status_text);
  module.def("check_config", check_config, nb::arg("config"),
             "Raises planefold.Error where a field is out of its range; its .field names it.");
  module.def("set_research", set_research, nb::arg("config"), nb::arg("research") = nb::none(),
             doc::pf_config_set_research);
  module.def("get_research", get_research, nb::arg("config"), doc::pf_config_get_research);
  module.def("query_memory", query_memory, nb::arg("config"),
             "Block and stack that a Slam with this configuration takes.");
  module.def("project", project, nb::arg("camera"), nb::arg("p_C"), doc::pf_camera_project);
  module.def("unproject", unproject, nb::arg("camera"), nb::arg("pixel"), doc::pf_camera_unproject);
}

}  // namespace pf::python
