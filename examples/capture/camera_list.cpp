#include <cstdio>

#include "camera.h"

namespace pf::capture {

int list_devices() {
  const int by_v4l2 = list_v4l2_cameras();
  const int by_libcamera = list_libcamera_cameras();
  if (by_v4l2 + by_libcamera == 0) {
    std::printf("no camera\n");
  }
  return kExitDone;
}

}  // namespace pf::capture
