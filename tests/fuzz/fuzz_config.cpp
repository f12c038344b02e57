// The config door: whatever the config holds, it is refused by name, or a context can be made from it and works.
#include <planefold/planefold.h>

#include <cstdlib>
#include <vector>

#include "bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes bytes(data, size);
  pf_config_t config;
  require(pf_config_default(&config) == PF_OK, "the default config is given");
  config.camera = {PF_CAMERA_PINHOLE,  64, 48, 50.0, 50.0, 31.5, 23.5, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,  0,  0,    {}};
  if (bytes.take<uint8_t>() % 8 == 0) {
    bytes.take(&config, sizeof(config));
  } else {
    // A few bytes of a config that is right otherwise.
    while (!bytes.empty()) {
      const size_t at = bytes.take<uint16_t>() % sizeof(config);
      reinterpret_cast<uint8_t*>(&config)[at] = bytes.take<uint8_t>();
    }
  }
  config.clock_ns = nullptr;
  config.log = nullptr;
  config.user = nullptr;

  const char* field = nullptr;
  const pf_status_t checked = pf_config_check(&config, &field);
  require(checked <= PF_OK, "a check is right or an error");
  require(checked == PF_OK || (field != nullptr && field[0] != '\0'), "a bad config names a field");

  pf_memory_t need;
  const pf_status_t queried = pf_memory_query(&config, &need);
  require((queried == PF_OK) == (checked == PF_OK), "query and check agree");
  if (queried != PF_OK || need.bytes > (size_t{32} << 20)) return 0;

  void* block = nullptr;
  if (posix_memalign(&block, need.alignment < sizeof(void*) ? sizeof(void*) : need.alignment, need.bytes) != 0)
    return 0;
  pf_slam_t* slam = nullptr;
  require(pf_create(&config, block, need.bytes - 1, &slam) == PF_ERROR_MEMORY, "a block that is too small is refused");
  require(slam == nullptr, "no context after an error");
  require(pf_create(&config, block, need.bytes, &slam) == PF_OK, "a config that was checked makes a context");

  const size_t pixels = static_cast<size_t>(config.camera.width) * static_cast<size_t>(config.camera.height);
  std::vector<uint8_t> picture(pixels);
  for (size_t i = 0; i < pixels; ++i) picture[i] = static_cast<uint8_t>((i / 7 * 31) ^ (i * 5));
  for (int64_t i = 0; i < 2; ++i) {
    const pf_image_t image = {picture.data(), config.camera.width, config.camera.height, config.camera.width,
                              i * 33000000};
    require(pf_push_frame(slam, &image) >= PF_OK, "a frame that fits is taken");
  }
  require(pf_reset(slam) == PF_OK, "reset");
  std::free(block);
  return 0;
}
