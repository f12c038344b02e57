// The calibration reader: whatever the text holds, the answer is a calibration with finite numbers, or one line.
#include <planefold/planefold.h>
#include <planefold_platform/sequence.h>

#include <cmath>
#include <cstring>

#include "bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pf_camera_t camera;
  double rate_hz = 0;
  char message[PF_SEQUENCE_MESSAGE];
  std::memset(message, 'x', sizeof(message));
  const int result =
      pf_parse_calibration(reinterpret_cast<const char*>(data), size, "fuzz.yaml", &camera, &rate_hz, message);
  if (result == 0) {
    pf_config_t config;
    pf_config_default(&config);
    config.camera = camera;
    // A distortion that folds the image is for the library to refuse, by name; numbers and sizes are for the reader.
    const char* field = nullptr;
    require(pf_config_check(&config, &field) == PF_OK || field != nullptr, "the library takes it or names a field");
    double sum = camera.fx + camera.fy + camera.cx + camera.cy;
    for (const double k : camera.distortion) sum += k;
    require(std::isfinite(sum), "what was read is finite");
    require(camera.width > 0 && camera.height > 0 && camera.fx > 0 && camera.fy > 0, "sizes are positive");
  } else {
    const char* end = static_cast<const char*>(std::memchr(message, '\0', sizeof(message)));
    require(end != nullptr && end != message, "a refusal says why");
    require(std::strchr(message, '\n') == nullptr, "in one line");
  }
  return 0;
}
