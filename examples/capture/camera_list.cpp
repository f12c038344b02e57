#include <cstdio>

#include "camera.h"

#ifdef PLANEFOLD_HAVE_V4L2
#include <planefold_platform/v4l2.h>
#endif
#ifdef PLANEFOLD_HAVE_LIBCAMERA
#include <planefold_platform/libcamera.h>
#endif

namespace pf::capture {

namespace {

/// formats: bit 1 << f for each that a camera has.
[[maybe_unused]] std::string format_names(uint32_t formats, uint32_t count, const char* (*name)(uint32_t)) {
  std::string names;
  for (uint32_t f = 1; f < count; ++f) {
    if ((formats & (1u << f)) != 0) {
      names += std::string(names.empty() ? "" : " ") + name(f);
    }
  }
  return names.empty() ? "no format that is known here" : names;
}

int list_v4l2() {
#ifdef PLANEFOLD_HAVE_V4L2
  pf_v4l2_device_t devices[32];
  const int count = pf_v4l2_list(devices, 32);
  bool refused = false;
  for (int i = 0; i < count && i < 32; ++i) {
    const pf_v4l2_device_t& device = devices[i];
    const std::string formats = format_names(device.formats, PF_V4L2_FORMATS, pf_v4l2_format_name);
    if (device.refused != 0) {
      refused = true;
      std::printf("camera  v4l2:%-14s this user may not open it\n", device.path);
    } else {
      const std::string others =
          device.formats == 0 && device.others[0] != '\0' ? std::string(": ") + device.others : "";
      std::printf("camera  v4l2:%-14s %s (%s)  %s%s\n", device.path, device.name, device.bus, formats.c_str(),
                  others.c_str());
    }
  }
  if (refused) {
    std::fprintf(stderr,
                 "pf-capture: note: cameras belong to the group video; as root: usermod -a -G video USER, then log in "
                 "again\n");
  }
  return count;
#else
  return 0;
#endif
}

int list_libcamera() {
#ifdef PLANEFOLD_HAVE_LIBCAMERA
  pf_libcamera_device_t devices[32];
  const int count = pf_libcamera_list(devices, 32);
  for (int i = 0; i < count && i < 32; ++i) {
    const std::string formats = format_names(devices[i].formats, PF_LIBCAMERA_FORMATS, pf_libcamera_format_name);
    std::printf("camera  libcamera:%-9d %s (%s)  %s\n", i, devices[i].id, devices[i].model, formats.c_str());
  }
  return count;
#else
  return 0;
#endif
}

}  // namespace

int list_devices() {
  const int by_v4l2 = list_v4l2();
  const int by_libcamera = list_libcamera();
  if (by_v4l2 + by_libcamera == 0) {
    std::printf("no camera\n");
  }
  return kExitDone;
}

}  // namespace pf::capture
