/// A context of the library: its block, which NumPy allocates, its callbacks, and the thread that uses it.
#pragma once

#include <nanobind/nanobind.h>
#include <planefold/planefold.h>

#include <exception>
#include <string>
#include <thread>

#include "errors.h"

namespace pf::python {

namespace nb = nanobind;

class Context {
 public:
  Context(const pf_config_t& config, nb::object log, bool has_clock);
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// Runs ask(slam) and raises where it refuses. A context that another thread is using is refused; `call` is the Python name.
  template <class Ask>
  pf_status_t run(const char* call, const Ask& ask) {
    const Use use(*this, call);
    return finish(ask(slam_), call);
  }

  /// The same for what takes long: other threads of Python go on in the meantime.
  template <class Ask>
  pf_status_t run_released(const char* call, const Ask& ask) {
    const Use use(*this, call);
    pf_status_t status = PF_OK;
    {
      const nb::gil_scoped_release released;
      status = ask(slam_);
    }
    return finish(status, call);
  }

  const pf_config_t& config() const { return config_; }
  const pf_memory_t& memory() const { return memory_; }

  /// For Python's collector of cycles: the callback may lead back here.
  nb::object& log() { return log_; }

 private:
  /// From one call to its end this thread alone may use the context; its own log may ask from inside.
  class Use {
   public:
    Use(Context& context, const char* call);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    Context& context_;
    bool outermost_;
  };

  static void write_log(void* user, const char* line);
  pf_status_t finish(pf_status_t status, const char* call);

  pf_config_t config_;
  pf_memory_t memory_{};
  nb::object block_;
  nb::object log_;
  std::exception_ptr raised_;  ///< by the log; the call that wrote the line raises it
  std::thread::id user_;       ///< read and written with Python's lock held
  pf_slam_t* slam_ = nullptr;
};

/// What the class Slam offers, by what it is for.
void add_slam(nb::module_& module);
void add_starts(nb::class_<Context>& slam);
void add_inputs(nb::class_<Context>& slam);
void add_poses(nb::class_<Context>& slam);
void add_maps(nb::class_<Context>& slam);
void add_reports(nb::class_<Context>& slam);

}  // namespace pf::python
