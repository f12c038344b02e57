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
  if (!file_.create(table)) {
    error = table.string() + ": cannot be written (" + std::strerror(errno) + "); choose another --record";
    return false;
  }
  file_.rows() =
      "#timestamp [ns],w_x [rad s^-1],w_y [rad s^-1],w_z [rad s^-1],a_x [m s^-2],a_y [m s^-2],a_z [m s^-2]\n";
  return true;
}

void ImuRecorder::add(const pf_imu_sample_t& sample) {
  if (file_.is_open()) {
    const double* w = sample.gyro;
    const double* a = sample.accel;
    append(file_.rows(), "%" PRId64 ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", sample.t_ns, w[0], w[1], w[2], a[0], a[1],
           a[2]);
  }
}

bool ImuRecorder::close(std::string& error) {
  const bool written = file_.write_rows(error);
  file_.close();
  return written;
}

}  // namespace pf::capture
