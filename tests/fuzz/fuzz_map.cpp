// Saved maps: whatever the bytes are, a map that a context begins in and can save again, or a refusal after which the context is as it
// was. Half of the inputs get CRCs that fit, so that the numbers behind them are reached.
#include <planefold/planefold.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "bytes.h"
#include "memory/crc32c.h"
#include "memory/map_bytes.h"

namespace {

pf_slam_t* created(int32_t backend) {
  pf_config_t config;
  require(pf_config_default(&config) == PF_OK, "a default config");
  config.camera = {PF_CAMERA_PINHOLE,  320, 240, 205, 205, 159.5, 119.5, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,   0,   0,   {}};
  config.backend = backend;
  config.capacity.max_places = 16;
  pf_memory_t need;
  require(pf_memory_query(&config, &need) == PF_OK, "a possible config");
  void* block = std::aligned_alloc(need.alignment, (need.bytes + need.alignment - 1) / need.alignment * need.alignment);
  pf_slam_t* slam = nullptr;
  require(block != nullptr, "memory");
  std::memset(block, 0x7f, need.bytes);
  require(pf_create(&config, block, need.bytes, &slam) == PF_OK, "a context");
  return slam;
}

pf_slam_t* fresh(int32_t backend) {
  static pf_slam_t* const filter = created(PF_BACKEND_FILTER);
  static pf_slam_t* const window = created(PF_BACKEND_WINDOW);
  pf_slam_t* const slam = backend == PF_BACKEND_FILTER ? filter : window;
  require(pf_reset(slam) == PF_OK, "a reset");
  return slam;
}

void set_number(std::vector<uint8_t>* map, size_t at, uint32_t value) {
  for (size_t i = 0; i < 4; ++i) (*map)[at + i] = static_cast<uint8_t>(value >> (8 * i));
}

/// Makes all CRCs fit, as far as the sections lead.
void forge(std::vector<uint8_t>* map) {
  if (map->size() < pf::kMapHeader) return;
  std::memcpy(map->data(), pf::kMapMagic, sizeof(pf::kMapMagic));
  uint64_t total = map->size();
  std::memcpy(map->data() + 16, &total, sizeof(total));
  set_number(map, 28, pf::crc32c(map->data(), 28));
  for (size_t at = pf::kMapHeader; at + pf::kSectionHeader <= map->size();) {
    uint64_t length = 0;
    std::memcpy(&length, map->data() + at + 8, sizeof(length));
    if (length > map->size() - at - pf::kSectionHeader) return;
    const size_t count = static_cast<size_t>(length);
    set_number(map, at + 16,
               pf::crc32c(map->data() + at + pf::kSectionHeader, count, pf::crc32c(map->data() + at, 16)));
    at += pf::kSectionHeader + count;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  std::vector<uint8_t> map(data + 1, data + size);
  if (data[0] % 2 == 1) forge(&map);
  pf_slam_t* slam = fresh(data[0] / 2 % 2 == 1 ? PF_BACKEND_FILTER : PF_BACKEND_WINDOW);
  pf_report_t before, after;
  require(pf_get_report(slam, &before) == PF_OK, "a report");
  const pf_status_t status = pf_load_map(slam, map.data(), map.size());
  require(pf_get_report(slam, &after) == PF_OK, "a report");
  if (status != PF_OK) {
    require(status == PF_ERROR_MAP || status == PF_ERROR_FULL, "a map is refused as what it is");
    require(std::memcmp(&before, &after, sizeof(before)) == 0, "a refusal changes nothing");
    return 0;
  }
  require(after.state == PF_STATE_LOST && after.places > 0, "a run begins lost in a map");
  pf_anchor_t anchors[64];
  size_t num_anchors = 0;
  require(pf_get_anchors(slam, anchors, 64, &num_anchors) == PF_OK, "anchors that were loaded");
  for (size_t i = 0; i < num_anchors; ++i) {
    for (const double number : anchors[i].covariance) require(std::isfinite(number), "an anchor has a covariance");
    for (const double number : anchors[i].p_WA) require(std::isfinite(number), "an anchor is somewhere");
  }
  std::vector<uint8_t> again(map.size());
  size_t used = 0;
  const pf_status_t saved = pf_save_map(slam, PF_MAP_PORTABLE, again.data(), again.size(), &used);
  require(saved == PF_OK || saved == PF_ERROR_MEMORY, "what was loaded can be saved");
  std::vector<uint8_t> grey(320 * 240);
  for (size_t i = 0; i < grey.size(); ++i) grey[i] = static_cast<uint8_t>(i * 2654435761u >> 24);
  for (int64_t t_ns = 1; t_ns < 4; ++t_ns) {
    const pf_image_t image = {grey.data(), 320, 240, 320, t_ns * 33333333};
    require(pf_push_frame(slam, &image) >= PF_OK, "a frame is taken");
    grey[static_cast<size_t>(t_ns)] ^= 0xff;
  }
  return 0;
}
