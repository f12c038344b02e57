#pragma once

#include <cstdint>

#include "base/elapsed.h"
#include "vision/fingerprint.h"

/// Recognises images that are byte for byte the one before: a recording or a driver repeats a frame where it has no new one.

namespace pf {

class FrozenCamera {
 public:
  void init() { data_ = Data(); }

  /// Whether the image is the one before. Its time is not before those of earlier images.
  bool is_duplicate(const ImageView& image, std::int64_t t_ns) {
    const std::uint64_t print = fingerprint(image);
    const bool duplicate = data_.has_image && print == data_.fingerprint;
    if (!duplicate) data_ = {true, print, t_ns};
    return duplicate;
  }
  /// How long ago the image came for the first time.
  std::int64_t frozen_ns(std::int64_t t_ns) const { return elapsed_ns(data_.first_ns, t_ns); }

 private:
  struct Data {
    bool has_image = false;
    std::uint64_t fingerprint = 0;
    std::int64_t first_ns = 0;  ///< time of the image when it came first
  };
  Data data_;
};

}  // namespace pf
