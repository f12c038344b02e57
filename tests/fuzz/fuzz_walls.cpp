// Walls files: whatever the text, walls that a context accepts or one line that names the file.
#include <planefold/planefold.h>
#include <planefold_platform/walls.h>

#include <cstdlib>
#include <cstring>
#include <memory>

#include "bytes.h"

namespace {

/// A context that was started and takes walls.
pf_slam_t* started() {
  static pf_slam_t* slam = [] {
    pf_config_t config;
    require(pf_config_default(&config) == PF_OK, "a default config");
    config.camera = {PF_CAMERA_PINHOLE,  320, 240, 205, 205, 159.5, 119.5, {}, 0, PF_CAMERA_EXACT,
                     PF_TIMESTAMPS_REAL, 0,   0,   0,   {}};
    config.capacity.max_planes = PF_WALLS_MAX;
    pf_memory_t need;
    require(pf_memory_query(&config, &need) == PF_OK, "a possible config");
    void* block =
        std::aligned_alloc(need.alignment, (need.bytes + need.alignment - 1) / need.alignment * need.alignment);
    pf_slam_t* created = nullptr;
    require(block != nullptr && pf_create(&config, block, need.bytes, &created) == PF_OK, "a context");
    return created;
  }();
  pf_pose_t pose{};
  double velocity[36] = {};
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = velocity[7 * i] = 0.01;
  require(pf_reset(slam) == PF_OK && pf_start_from_pose(slam, &pose, velocity) == PF_OK, "a start");
  return slam;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto walls = std::make_unique<pf_walls_t>();
  char message[PF_WALLS_MESSAGE] = "";
  if (pf_parse_walls(reinterpret_cast<const char*>(data), size, "plan.json", walls.get(), message) != 0) {
    require(std::strstr(message, "plan.json") != nullptr && std::strchr(message, '\n') == nullptr,
            "a refusal is one line");
    return 0;
  }
  require(walls->count > 0 && walls->count <= PF_WALLS_MAX, "a plan has walls");
  pf_slam_t* slam = started();
  for (int32_t i = 0; i < walls->count; ++i) {
    uint32_t id = 0;
    require(std::memchr(walls->wall[i].name, '\0', PF_WALLS_NAME) != nullptr, "a name ends");
    const pf_status_t status = pf_add_wall(slam, &walls->wall[i].prior, &id);
    require(status == PF_OK || status == PF_ERROR_FULL, "a wall of a plan is a wall");
  }
  return 0;
}
