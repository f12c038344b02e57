#include "imu_recorder.h"

#include <cerrno>
#include <cinttypes>
#include <cstring>
#include <filesystem>

namespace pf::capture {

bool ImuRecorder::open(const std::string& folder, std::string& error) {
  const std::filesystem::path table = std::filesystem::path(folder) / "mav0" / "imu0" / "data.csv";
  std::error_code failure;
  std::filesystem::create_directories(table.parent_path(), failure);
  path_ = table.string();
  file_.reset(std::fopen(path_.c_str(), "w"));
  if (!file_) {
    error = path_ + ": cannot be written (" + std::strerror(errno) + "); choose another --record";
    return false;
  }
  std::fprintf(file_.get(),
               "#timestamp [ns],w_x [rad s^-1],w_y [rad s^-1],w_z [rad s^-1],a_x [m s^-2],a_y [m s^-2],a_z [m s^-2]\n");
  return true;
}

void ImuRecorder::add(const pf_imu_sample_t& sample) {
  if (file_) {
    const double* w = sample.gyro;
    const double* a = sample.accel;
    std::fprintf(file_.get(), "%" PRId64 ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", sample.t_ns, w[0], w[1], w[2], a[0],
                 a[1], a[2]);
  }
}

bool ImuRecorder::close(std::string& error) {
  if (file_ && (std::fflush(file_.get()) != 0 || std::ferror(file_.get()) != 0)) {
    error = path_ + ": could not be written completely; is the disk full?";
    return false;
  }
  file_.reset();
  return true;
}

}  // namespace pf::capture
