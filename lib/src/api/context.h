#pragma once

#include "api/checks.h"
#include "base/status.h"
#include "planefold/planefold.h"
#include "session/session.h"

/// What a pf_slam_t is, and the checks that every call begins with.

struct pf_slam {
  std::uint64_t magic;
  pf_slam* self;  ///< own address, by which a block that was copied or moved is detected
  pf_config_t config;
  pf::Session session;
  bool is_told;  ///< something has changed it since pf_create or pf_reset
  bool in_call;  ///< a call that changes it has not returned: others of this kind, from its callbacks, are rejected
};

namespace pf {

constexpr std::uint64_t kMagic = 0x646c6f66656e616cULL;

inline bool is_context(const pf_slam_t* slam) {
  return reinterpret_cast<std::uintptr_t>(slam) % alignof(pf_slam) == 0 && slam->magic == kMagic && slam->self == slam;
}

inline pf_status_t to_c(Status status) { return static_cast<pf_status_t>(status); }

std::size_t bytes_needed(const Settings& settings);

/// CRC-32C of all that a config says, but for kernels and callbacks.
std::uint32_t config_crc(const pf_config_t& config);

Status settings_from(const pf_config_t& config, Settings* settings, const char** field);

/// Marks a context as busy while the caller's callbacks may run.
class InCall {
 public:
  explicit InCall(pf_slam_t* slam) : slam_(slam) { slam_->in_call = true; }
  ~InCall() { slam_->in_call = false; }
  InCall(const InCall&) = delete;
  InCall& operator=(const InCall&) = delete;

  /// What the call returns. A call that was rejected, or found nothing to change, has not changed the context.
  pf_status_t end(pf_status_t status) const {
    if (status >= PF_OK && status != PF_NOTE_NOTHING) slam_->is_told = true;
    return status;
  }
  pf_status_t end(Status status) const { return end(to_c(status)); }

 private:
  pf_slam_t* slam_;
};

}  // namespace pf

/// Returns an error from the calling function when the context is null or broken.
#define PF_REQUIRE_CONTEXT(slam)                        \
  do {                                                  \
    if ((slam) == nullptr) return PF_ERROR_NULL;        \
    if (!pf::is_context(slam)) return PF_ERROR_CONTEXT; \
  } while (false)

/// The same for a call that changes the context: also rejected from inside a callback of the same context. Such a call returns errors as
/// they are, and all else through in_call.end().
#define PF_BEGIN_CHANGE(slam)                 \
  PF_REQUIRE_CONTEXT(slam);                   \
  if ((slam)->in_call) return PF_ERROR_STATE; \
  const pf::InCall in_call(slam)
