#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "bed.h"

namespace replay {

/// The session: loops on a circle in a room, looking across it; its 200 points all find room in the map.
pfsim::BedOptions session_bed(int frames);
pf_config_t session_config(const pfsim::BedOptions& bed, bool planes);

/// A feature is of this kind from here on.
struct Decision {
  std::uint32_t external_id = 0;
  std::int32_t kind = 0;
};

/// What one frame of the recorded run was given and gave. `observations` are those that it accepted.
struct Frame {
  std::int64_t t_ns = 0;
  double dv_C[3] = {}, dw_C[3] = {};
  std::vector<pf_observation_t> observations;
  std::vector<Decision> decisions;
  std::int32_t tracked = 0, offered = 0, inliers = 0, features = 0, state_dim = 0;
  pf_pose_t pose = {};
};

/// A file of frames, and of the map at the end. The same machine writes and reads it.
class Tape {
 public:
  Tape(const std::string& file, bool write) : file_(std::fopen(file.c_str(), write ? "wb" : "rb")) {}
  ~Tape() {
    if (file_ != nullptr) std::fclose(file_);
  }
  Tape(const Tape&) = delete;
  Tape& operator=(const Tape&) = delete;
  bool ok() const { return file_ != nullptr; }

  template <class T>
  bool write(const T& value) {
    return std::fwrite(&value, sizeof value, 1, file_) == 1;
  }
  template <class T>
  bool read(T& value) {
    return std::fread(&value, sizeof value, 1, file_) == 1;
  }
  template <class T>
  bool write(const std::vector<T>& values) {
    return write(values.size()) && std::fwrite(values.data(), sizeof(T), values.size(), file_) == values.size();
  }
  template <class T>
  bool read(std::vector<T>& values) {
    std::size_t count = 0;
    if (!read(count) || count > 1000000) return false;
    values.resize(count);
    return std::fread(values.data(), sizeof(T), count, file_) == count;
  }
  bool write(const Frame& frame);
  bool read(Frame& frame);

 private:
  std::FILE* file_;
};

/// Everything that the map holds.
std::vector<pf_feature_t> map_of(const pf_slam_t* slam);

}  // namespace replay
