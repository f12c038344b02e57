// The calibration reader: whatever the text holds, the answer is a calibration that the library takes, or one line.
#include <planefold_platform/sequence.h>

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
    require(pf_config_check(&config, nullptr) == PF_OK, "a calibration that was read is one that the library takes");
  } else {
    const char* end = static_cast<const char*>(std::memchr(message, '\0', sizeof(message)));
    require(end != nullptr && end != message, "a refusal says why");
    require(std::strchr(message, '\n') == nullptr, "in one line");
  }
  return 0;
}
