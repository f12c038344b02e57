// Image decoders: whatever the bytes, a picture of the size that they say or one line on what is wrong. Buffers are kept from one to the
// next.
#include <cstring>
#include <memory>
#include <vector>

#include "../../platform/sequence/decode.h"
#include "bytes.h"

#ifdef PLANEFOLD_FUZZ_V4L2
#include "../../platform/v4l2/grey.h"
#endif

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::unique_ptr<pf_decoded_t, void (*)(pf_decoded_t*)> image(new pf_decoded_t{}, [](pf_decoded_t* kept) {
    pf_decode_free(kept);
    delete kept;
  });
  const std::vector<uint8_t> exact(data, data + size);  // its end is watched
  char why[PF_DECODE_WHY] = "";
  if (pf_decode_image(exact.data(), exact.size(), image.get(), why) != 0) {
    require(why[0] != '\0' && std::strchr(why, '\n') == nullptr, "a refusal says why in one line");
    return 0;
  }
  require(image->width > 0 && image->height > 0 && image->width <= PF_DECODE_MAX_SIDE &&
              image->height <= PF_DECODE_MAX_SIDE,
          "a picture has a size");
  const size_t pixels = static_cast<size_t>(image->width) * static_cast<size_t>(image->height);
  uint64_t sum = 0;
  for (size_t i = 0; i < pixels; ++i) sum += image->pixels[i];
  require(sum <= 255 * pixels, "every pixel can be read");
#ifdef PLANEFOLD_FUZZ_V4L2
  std::vector<uint8_t> grey(pixels);
  pf_grey_from_jpeg(exact.data(), exact.size(), image->width, image->height, grey.data());
#endif
  return 0;
}
