#pragma once

#include <string>
#include <vector>

#include "homography_frames.h"
#include "suite.h"

namespace bench {

/// A patch in stored frames whose homographies are known.
class StoredPatchFrames : public PatchFrames {
 public:
  /// Reads the one source, patch and truth of the options. null: message is one line.
  static std::unique_ptr<StoredPatchFrames> read(const SuiteOptions& options, std::string& message);

  const HomographyOptions& options() const { return options_; }
  const std::string& name() const { return name_; }
  int left() const override { return left_; }
  int top() const override { return top_; }
  const Homography& truth(int frame) const override { return truth_[static_cast<std::size_t>(frame)]; }
  const std::vector<std::uint8_t>& draw(int frame) override { return pixels_[static_cast<std::size_t>(frame)]; }

 private:
  HomographyOptions options_;
  std::string name_;
  int left_ = 0, top_ = 0;
  std::vector<Homography> truth_;
  std::vector<std::vector<std::uint8_t>> pixels_;
};

}  // namespace bench
