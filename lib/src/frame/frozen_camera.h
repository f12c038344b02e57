#pragma once

#include <cstdint>

#include "base/elapsed.h"
#include "vision/fingerprint.h"

/// Recognises images that are byte for byte the one before: a recording or a driver repeats a frame where it has no new one.

namespace pf {

class Archive;

class FrozenCamera {
 public:
  void init() { data_ = Data(); }

  /// Whether the image repeats the one before. Times must not run back.
  bool is_duplicate(const ImageView& image, std::int64_t t_ns) {
    const std::uint64_t print = fingerprint(image);
    const bool duplicate = data_.has_image && print == data_.fingerprint;
    if (!duplicate) data_ = {true, print, t_ns};
    return duplicate;
  }
  /// Time since the repeated image came first.
  std::int64_t frozen_ns(std::int64_t t_ns) const { return elapsed_ns(data_.first_ns, t_ns); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    bool has_image = false;
    std::uint64_t fingerprint = 0;
    std::int64_t first_ns = 0;  ///< time at which the image came first
  };
  Data data_;
};

}  // namespace pf
