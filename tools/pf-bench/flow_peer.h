#pragma once

#include <cstdint>
#include <string>

namespace bench {

/// OpenCV's sparse optical flow, where this build found OpenCV.
class FlowPeer {
 public:
  FlowPeer();
  bool is_there() const { return time_us_ != nullptr; }
  const std::string& name() const { return name_; }  ///< or why it is not there

  /// Microseconds of one call on 100 corners of previous; negative where there are none. Corners are found untimed.
  double time_us(const uint8_t* previous, const uint8_t* next, int width, int height) const;

 private:
  using Time = double (*)(const uint8_t*, const uint8_t*, int, int, int*, int*);
  Time time_us_ = nullptr;
  std::string name_;
};

}  // namespace bench
