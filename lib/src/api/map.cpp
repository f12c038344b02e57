#include "api/context.h"

namespace {

/// PF_OK, or what is wrong with a kind. A caller who asks for what is not there yet is told so by name.
pf_status_t check_kind(const pf_slam_t* slam, int32_t kind) {
  if (kind == PF_MAP_PORTABLE) return PF_OK;
  if (kind == PF_MAP_CONTINUE)
    slam->session.settings().hooks.say("PF_MAP_CONTINUE is not in this release; PF_MAP_PORTABLE is");
  return PF_ERROR_RANGE;
}

}  // namespace

pf_status_t pf_map_size(const pf_slam_t* slam, int32_t kind, size_t* bytes) {
  PF_REQUIRE_CONTEXT(slam);
  if (bytes == nullptr) return PF_ERROR_NULL;
  const pf_status_t wrong = check_kind(slam, kind);
  if (wrong != PF_OK) return wrong;
  pf::MapWriter out(nullptr, 0);
  const pf::Status status = slam->session.view().save_map(slam->session.given_gravity_W(), &out);
  if (status == pf::Status::kOk) *bytes = out.used();
  return pf::to_c(status);
}

pf_status_t pf_save_map(const pf_slam_t* slam, int32_t kind, void* buffer, size_t bytes, size_t* used) {
  PF_REQUIRE_CONTEXT(slam);
  if (buffer == nullptr || used == nullptr) return PF_ERROR_NULL;
  size_t needed = 0;
  const pf_status_t wrong = pf_map_size(slam, kind, &needed);
  if (wrong != PF_OK) return wrong;
  if (bytes < needed) return PF_ERROR_MEMORY;
  pf::MapWriter out(static_cast<std::uint8_t*>(buffer), bytes);
  const pf::Status status = slam->session.view().save_map(slam->session.given_gravity_W(), &out);
  if (status == pf::Status::kOk) *used = out.used();
  return pf::to_c(status);
}

pf_status_t pf_load_map(pf_slam_t* slam, const void* buffer, size_t bytes) {
  PF_REQUIRE_IDLE(slam);
  if (buffer == nullptr) return PF_ERROR_NULL;
  const char* wrong = nullptr;
  pf::Vec3 gravity_W = pf::Vec3::Zero();
  const pf::Status status =
      slam->session.map_calls().load(static_cast<const std::uint8_t*>(buffer), bytes, &wrong, &gravity_W);
  if (status == pf::Status::kOk && gravity_W.squaredNorm() > pf::Scalar(0)) slam->session.set_gravity(gravity_W);
  const pf::Hooks& hooks = slam->session.settings().hooks;
  if (wrong != nullptr) hooks.say("map rejected: ", wrong);
  return pf::to_c(status);
}
