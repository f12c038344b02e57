#include <cstdio>

#include "camera_device.h"

namespace pf::capture {

#ifdef PLANEFOLD_HAVE_V4L2

namespace {

struct V4l2 : platform::V4l2 {
  static constexpr const char* kStamps[] = {"arrival", "end of exposure", "start of exposure"};

  static std::string id(const Info& info) { return info.device.path; }
  static nlohmann::ordered_json describe(const Info& info) {
    return {{"name", info.device.name},
            {"format", format_name(info.format)},
            {"read_slowness", info.read_slowness},
            {"restarts", info.restarts}};
  }
};

}  // namespace

std::unique_ptr<Camera> open_v4l2_camera(const Options& options, const pf_camera_t& camera, double& rate_hz,
                                         std::string& error) {
  pf_v4l2_options_t wanted = device_options<V4l2>(options, camera, rate_hz);
  wanted.focus = options.focus;
  wanted.dma_buf = options.dma_buf ? 1 : 0;
  auto device = open_device<V4l2>(options, wanted, error);
  if (device == nullptr) {
    return nullptr;
  }
  const pf_v4l2_info_t info = device->info();
  rate_hz = info.rate_hz > 0.0 ? info.rate_hz : wanted.rate_hz;
  return device;
}

int list_v4l2_cameras() {
  pf_v4l2_device_t devices[32];
  const int count = pf_v4l2_list(devices, 32);
  bool refused = false;
  for (int i = 0; i < count && i < 32; ++i) {
    const pf_v4l2_device_t& device = devices[i];
    const std::string formats = format_names<V4l2>(device.formats);
    if (device.refused != 0) {
      refused = true;
      std::printf("camera  v4l2:%-14s this user may not open it\n", device.path);
    } else {
      std::printf("camera  v4l2:%-14s %s (%s)  %s\n", device.path, device.name, device.bus, formats.c_str());
    }
  }
  if (refused) {
    std::fprintf(stderr,
                 "pf-capture: note: cameras belong to the group video; as root: usermod -a -G video USER, then log in "
                 "again\n");
  }
  return count;
}

#else

std::unique_ptr<Camera> open_v4l2_camera(const Options& options, const pf_camera_t&, double&, std::string& error) {
  error = "source '" + options.source + "': this build has no V4L2";
  return nullptr;
}

int list_v4l2_cameras() { return 0; }

#endif

}  // namespace pf::capture
