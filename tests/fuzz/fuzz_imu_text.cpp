// Tables of inertial samples: whatever the text, samples in order or one line that says what is wrong.
#include <planefold_platform/sequence.h>

#include <cmath>
#include <cstring>

#include "bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pf_imu_sample_t* samples = nullptr;
  size_t count = 0;
  char message[PF_SEQUENCE_MESSAGE];
  const char* text = size > 0 ? reinterpret_cast<const char*>(data) : "";
  if (pf_parse_imu(text, size, "fuzz.csv", &samples, &count, message) != 0) {
    require(samples == nullptr && std::strstr(message, "fuzz.csv") != nullptr, "a refusal names the file");
    return 0;
  }
  require(samples != nullptr && count > 0, "samples");
  for (size_t i = 0; i < count; ++i) {
    require(i == 0 || samples[i - 1].t_ns < samples[i].t_ns, "in order of time");
    for (int k = 0; k < 3; ++k)
      require(std::isfinite(samples[i].gyro[k]) && std::isfinite(samples[i].accel[k]), "finite");
  }
  pf_free_imu(samples);
  return 0;
}
