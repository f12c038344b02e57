#include "api/context.h"
#include "covariance/select.h"
#include "session/live_map.h"

namespace {

pf::LiveOrigin origin_of(const pf_slam_t& slam) {
  const pf::Settings& settings = slam.session.settings();
  return {PF_VERSION, sizeof(pf::Scalar), pf::kernels_id(settings.kernels), pf::config_crc(slam.config),
          pf::bytes_needed(settings)};
}

/// What is only counted, or written, changes nothing.
pf_status_t write_map(const pf_slam_t* slam, int32_t kind, pf::MapWriter* out) {
  if (kind != PF_MAP_CONTINUE) return pf::to_c(slam->session.view().save_map(slam->session.given_gravity_W(), out));
  return pf::to_c(write_live(origin_of(*slam), const_cast<pf_slam_t*>(slam)->session, out));
}

pf_status_t check_kind(const pf_slam_t* slam, int32_t kind) {
  if (kind == PF_MAP_PORTABLE) return PF_OK;
  if (kind != PF_MAP_CONTINUE) return PF_ERROR_RANGE;
  return pf::kHasMemory && !slam->in_call ? PF_OK : PF_ERROR_STATE;
}

pf::Status go_on(pf_slam_t* slam, const std::uint8_t* buffer, std::size_t bytes, const char** wrong) {
  if (!pf::kHasMemory || slam->is_told) return pf::Status::kState;
  bool is_changed = false;
  *wrong = read_live(origin_of(*slam), buffer, bytes, &slam->session, &is_changed);
  if (*wrong != nullptr && is_changed) slam->session.init();
  return *wrong != nullptr ? pf::Status::kMap : pf::Status::kOk;
}

}  // namespace

pf_status_t pf_map_size(const pf_slam_t* slam, int32_t kind, size_t* bytes) {
  PF_REQUIRE_CONTEXT(slam);
  if (bytes == nullptr) return PF_ERROR_NULL;
  const pf_status_t wrong = check_kind(slam, kind);
  if (wrong != PF_OK) return wrong;
  pf::MapWriter out(nullptr, 0);
  const pf_status_t status = write_map(slam, kind, &out);
  if (status == PF_OK) *bytes = out.used();
  return status;
}

pf_status_t pf_save_map(const pf_slam_t* slam, int32_t kind, void* buffer, size_t bytes, size_t* used) {
  PF_REQUIRE_CONTEXT(slam);
  if (buffer == nullptr || used == nullptr) return PF_ERROR_NULL;
  size_t needed = 0;
  const pf_status_t wrong = pf_map_size(slam, kind, &needed);
  if (wrong != PF_OK) return wrong;
  if (bytes < needed) return PF_ERROR_MEMORY;
  pf::MapWriter out(static_cast<std::uint8_t*>(buffer), bytes);
  const pf_status_t status = write_map(slam, kind, &out);
  if (status == PF_OK) *used = out.used();
  return status;
}

pf_status_t pf_load_map(pf_slam_t* slam, const void* buffer, size_t bytes) {
  PF_BEGIN_CHANGE(slam);
  if (buffer == nullptr) return PF_ERROR_NULL;
  const std::uint8_t* const map = static_cast<const std::uint8_t*>(buffer);
  const char* wrong = nullptr;
  pf::Vec3 gravity_W = pf::Vec3::Zero();
  const pf::Status status = pf::map_kind(map, bytes) == pf::kContinuedMap
                                ? go_on(slam, map, bytes, &wrong)
                                : slam->session.map_calls().load(map, bytes, &wrong, &gravity_W);
  if (wrong != nullptr) slam->session.settings().hooks.say("map rejected: ", wrong);
  if (status == pf::Status::kOk && gravity_W.squaredNorm() > pf::Scalar(0)) slam->session.set_gravity(gravity_W);
  return in_call.end(status);
}
