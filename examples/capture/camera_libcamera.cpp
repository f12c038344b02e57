#include <cstdio>

#include "camera_device.h"

namespace pf::capture {

#ifdef PLANEFOLD_HAVE_LIBCAMERA

namespace {

struct Libcamera : platform::Libcamera {
  static constexpr const char* kStamps[] = {"arrival", "buffer", "sensor"};

  static std::string id(const Info& info) { return info.device.id; }
  static nlohmann::ordered_json describe(const Info& info) {
    return {{"name", info.device.model}, {"libcamera", pf_libcamera_version()}, {"format", format_name(info.format)}};
  }
};

}  // namespace

std::unique_ptr<Camera> open_libcamera_camera(const Options& options, const pf_camera_t& camera, double& rate_hz,
                                              std::string& error) {
  if (options.focus >= 0) {
    error =
        "--focus " + std::to_string(options.focus) + ": libcamera has no steps; --focus -1 holds the lens where it is";
    return nullptr;
  }
  const pf_libcamera_options_t wanted = device_options<Libcamera>(options, camera, rate_hz);
  rate_hz = wanted.rate_hz;
  return open_device<Libcamera>(options, wanted, error);
}

int list_libcamera_cameras() {
  pf_libcamera_device_t devices[32];
  const int count = pf_libcamera_list(devices, 32);
  for (int i = 0; i < count && i < 32; ++i) {
    const std::string formats = format_names<Libcamera>(devices[i].formats);
    std::printf("camera  libcamera:%-9d %s (%s)  %s\n", i, devices[i].id, devices[i].model, formats.c_str());
  }
  return count;
}

#else

std::unique_ptr<Camera> open_libcamera_camera(const Options& options, const pf_camera_t&, double&, std::string& error) {
  error = "source '" + options.source + "': this build has no libcamera (Debian: libcamera-dev); use v4l2:";
  return nullptr;
}

int list_libcamera_cameras() { return 0; }

#endif

}  // namespace pf::capture
