#pragma once

#include "base/status.h"
#include "filter/imu_log.h"
#include "planefold/planefold.h"
#include "slam/filter_slam.h"

/// The one door between C and C++: what a pf_slam_t is.

struct pf_slam {
  std::uint64_t magic;
  pf_slam* self;  ///< a block that was copied or moved is no context
  pf_config_t config;
  pf::Settings settings;
  pf::FilterSlam slam;
  pf::ImuLog imu;
  bool takes_frames;
  bool takes_observations;
  double gravity_W[3];  ///< zero: not known
};

namespace pf {

constexpr std::uint64_t kMagic = 0x646c6f66656e616cULL;

inline bool is_context(const pf_slam_t* slam) {
  return reinterpret_cast<std::uintptr_t>(slam) % alignof(pf_slam) == 0 && slam->magic == kMagic && slam->self == slam;
}

inline pf_status_t to_c(Status status) { return static_cast<pf_status_t>(status); }

inline bool finite(const double* values, int count) {
  for (int i = 0; i < count; ++i)
    if (!(values[i] - values[i] == 0.0)) return false;
  return true;
}

Status settings_from(const pf_config_t& config, Settings* settings, const char** field);

}  // namespace pf

/// Null and broken contexts are refused in one line.
#define PF_REQUIRE_CONTEXT(slam)                        \
  do {                                                  \
    if ((slam) == nullptr) return PF_ERROR_NULL;        \
    if (!pf::is_context(slam)) return PF_ERROR_CONTEXT; \
  } while (false)
