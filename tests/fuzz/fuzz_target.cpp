// Target files: whatever the text, a target that a context accepts or one line that names the file.
#include <planefold_platform/sequence.h>

#include <cmath>
#include <cstring>

#include "bytes.h"
#include "text_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const TextFile file("target.yaml");
  pf_target_t target;
  char message[PF_SEQUENCE_MESSAGE] = "";
  file.write(data, size);
  if (pf_read_target(file.path(), &target, message) != 0) {
    require(std::strstr(message, "target.yaml") != nullptr && std::strchr(message, '\n') == nullptr,
            "a refusal is one line");
    return 0;
  }
  require(target.kind == PF_TARGET_RECTANGLE || target.kind == PF_TARGET_POINTS, "a target has a kind");
  require(std::isfinite(target.sigma) && target.sigma > 0, "a target has a sigma");
  if (target.kind == PF_TARGET_RECTANGLE) {
    require(target.width > 0 && target.height > 0 && std::isfinite(target.width + target.height),
            "a rectangle has a size");
    return 0;
  }
  require(target.count >= 4 && target.count <= PF_TARGET_MAX_POINTS, "a target has points");
  for (int i = 0; i < target.count; ++i)
    for (double v : target.points_W[i]) require(std::isfinite(v), "a point is finite");
  double norm = 0;
  for (double q : target.first_pose.q_WC) norm += q * q;
  require(std::fabs(norm - 1) < 1e-9, "a first pose has a rotation");
  return 0;
}
