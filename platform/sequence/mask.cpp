#include "mask.h"

#include <algorithm>
#include <string>

#include "decode.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kMaxBytes = size_t{64} << 20;

struct Decoded : pf_decoded_t {
  Decoded() : pf_decoded_t{} {}
  Decoded(const Decoded&) = delete;
  Decoded& operator=(const Decoded&) = delete;
  ~Decoded() { pf_decode_free(this); }
};

std::string size_text(std::int32_t width, std::int32_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

fs::path find_mask(const fs::path& frame, const fs::path& root) {
  const fs::path images = frame.parent_path();
  for (const fs::path& folder : {images, images.parent_path(), root}) {
    if (!folder.empty() && is_file(folder / kMaskName)) {
      return folder / kMaskName;
    }
  }
  return {};
}

std::vector<std::uint8_t> read_mask(const fs::path& path, std::int32_t width, std::int32_t height) {
  std::vector<unsigned char> bytes;
  read_bytes(path, kMaxBytes, "mask", bytes);
  Decoded image;
  char why[PF_DECODE_WHY] = "";
  if (pf_decode_png(bytes.data(), bytes.size(), &image, why) != 0) {
    refuse(path.string() + ": " + why + "; a mask is a PNG of 0 (ignored) and 255 (scene)");
  }
  if (image.width != width || image.height != height) {
    refuse(path.string() + ": is " + size_text(image.width, image.height) + " pixels, but the images are " +
           size_text(width, height) + "; make the mask of one of them");
  }
  const std::uint8_t* end = image.pixels + static_cast<size_t>(width) * static_cast<size_t>(height);
  const std::uint8_t* other =
      std::find_if(image.pixels, const_cast<std::uint8_t*>(end), [](std::uint8_t v) { return v != 0 && v != 255; });
  if (other != end) {
    const auto at = other - image.pixels;
    refuse(path.string() + ": has a grey level of " + std::to_string(*other) + " at pixel " +
           std::to_string(at % width) + ", " + std::to_string(at / width) +
           "; a mask has 0 (ignored) and 255 (scene) alone");
  }
  return {image.pixels, const_cast<std::uint8_t*>(end)};
}

}  // namespace pf::sequence
