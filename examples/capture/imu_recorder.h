#ifndef PLANEFOLD_CAPTURE_IMU_RECORDER_H
#define PLANEFOLD_CAPTURE_IMU_RECORDER_H

#include <planefold/planefold.h>

#include <cstdio>
#include <memory>
#include <string>

namespace pf::capture {

/// Samples to mav0/imu0/data.csv of a recording, on the clock of the frames and to the last digit.
class ImuRecorder {
 public:
  /// false: error is one line.
  bool open(const std::string& folder, std::string& error);
  void add(const pf_imu_sample_t& sample);
  /// false: not everything could be written, and error is one line.
  bool close(std::string& error);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace pf::capture

#endif
