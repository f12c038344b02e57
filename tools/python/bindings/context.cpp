#include "context.h"

#include <nanobind/ndarray.h>

#include <chrono>

namespace pf::python {

namespace {

int64_t steady_ns(void*) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Context::Use::Use(Context& context, const char* call)
    : context_(context), outermost_(context.user_ == std::thread::id()) {
  if (!outermost_ && context.user_ != std::this_thread::get_id()) {
    raise_error(PF_ERROR_STATE, std::string(call) + ": another thread is using this Slam; a lock keeps them apart");
  }
  context.user_ = std::this_thread::get_id();
}

Context::Use::~Use() {
  if (outermost_) context_.user_ = std::thread::id();
}

Context::Context(const pf_config_t& config, nb::object log, bool has_clock) : config_(config), log_(std::move(log)) {
  config_.clock_ns = has_clock ? steady_ns : nullptr;
  config_.log = log_.is_none() ? nullptr : write_log;
  config_.user = this;
  const char* field = nullptr;
  const pf_status_t status = pf_config_check(&config_, &field);
  check(status, "Slam", field);
  check(pf_memory_query(&config_, &memory_), "Slam");
  block_ = nb::module_::import_("numpy").attr("empty")(memory_.bytes + memory_.alignment, "uint8");
  auto* begin = static_cast<uint8_t*>(nb::cast<nb::ndarray<uint8_t>>(block_).data());
  const size_t past = reinterpret_cast<uintptr_t>(begin) % memory_.alignment;
  const Use use(*this, "Slam");
  finish(pf_create(&config_, begin + (past > 0 ? memory_.alignment - past : 0), memory_.bytes, &slam_), "Slam");
}

void Context::write_log(void* user, const char* line) {
  auto& context = *static_cast<Context*>(user);
  const nb::gil_scoped_acquire acquired;
  try {
    context.log_(line);
  } catch (...) {
    if (!context.raised_) context.raised_ = std::current_exception();
  }
}

pf_status_t Context::finish(pf_status_t status, const char* call) {
  if (raised_) std::rethrow_exception(std::exchange(raised_, nullptr));
  return checked(status, call);
}

}  // namespace pf::python
