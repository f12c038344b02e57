#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "context.h"
#include "docs.h"

namespace pf::python {

namespace {

int visit(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (nb::inst_ready(self)) {
    nb::object& log = nb::inst_ptr<Context>(self)->log();
    Py_VISIT(log.ptr());
  }
  return 0;
}

int clear(PyObject* self) {
  nb::inst_ptr<Context>(self)->log() = nb::none();
  return 0;
}

PyType_Slot slots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(visit)}, {Py_tp_clear, reinterpret_cast<void*>(clear)}, {0, nullptr}};

constexpr char kDoc[] =
    "A camera's pose and a map, from its frames, in one block of memory that NumPy allocates.\n\n"
    "log    called with each line on what the library decided; it may ask this object, and change nothing\n"
    "clock  True: reports say how long each stage took (stage_ns)\n\n"
    "A context belongs to one thread at a time: a call from a second one, while the first is inside, raises. Other "
    "threads of "
    "Python go on during push_frame.";

pf_config_t config_of(const Context& context) {
  pf_config_t config = context.config();
  config.clock_ns = nullptr;
  config.log = nullptr;
  config.user = nullptr;
  return config;
}

}  // namespace

void add_slam(nb::module_& module) {
  nb::class_<Context> slam(module, "Slam", nb::type_slots(slots), kDoc);
  slam.def(
      "__init__",
      [](Context* self, const pf_config_t& config, nb::object log, bool clock) {
        new (self) Context(config, std::move(log), clock);
      },
      nb::arg("config"), nb::kw_only(), nb::arg("log").none() = nb::none(), nb::arg("clock") = false,
      nb::sig("def __init__(self, config: Config, *, log: collections.abc.Callable[[str], object] | None = None, "
              "clock: bool = False) -> None"),
      doc::pf_create);
  slam.def(
      "reset", [](Context& self) { self.run("reset", [](pf_slam_t* context) { return pf_reset(context); }); },
      doc::pf_reset);
  slam.def_prop_ro("config", config_of, "A copy of the configuration.");
  slam.def_prop_ro(
      "memory_bytes", [](const Context& self) { return self.memory().bytes; }, "Size of the block.");
  slam.def_prop_ro(
      "stack_bytes", [](const Context& self) { return self.memory().stack_bytes; },
      "The most stack that any call uses (a tested bound).");
  add_starts(slam);
  add_inputs(slam);
  add_poses(slam);
  add_maps(slam);
  add_reports(slam);
}

}  // namespace pf::python
