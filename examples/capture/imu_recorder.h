#ifndef PLANEFOLD_CAPTURE_IMU_RECORDER_H
#define PLANEFOLD_CAPTURE_IMU_RECORDER_H

#include <planefold/planefold.h>

#include <string>

#include "text_file.h"

namespace pf::capture {

/// Samples to mav0/imu0/data.csv of a recording, on the clock of the frames and to the last digit.
class ImuRecorder {
 public:
  /// false: error is one line.
  bool open(const std::string& folder, std::string& error);
  void add(const pf_imu_sample_t& sample);
  /// The samples that were added since, to the file. false: error is one line.
  bool write(std::string& error) { return file_.write_rows(error); }
  /// false: not everything could be written, and error is one line.
  bool close(std::string& error);

 private:
  TextFile file_;
};

}  // namespace pf::capture

#endif
