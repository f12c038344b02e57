#include "outputs.h"

#include <planefold_platform/sequence.h>

#include <cerrno>
#include <cinttypes>
#include <cstring>

#include "plane_outputs.h"

namespace pf::capture {

namespace {

/// Nanoseconds as decimal seconds, exactly.
void put_seconds(std::FILE* file, int64_t t_ns) {
  const uint64_t size = t_ns < 0 ? 0 - static_cast<uint64_t>(t_ns) : static_cast<uint64_t>(t_ns);
  std::fprintf(file, "%s%" PRIu64 ".%09" PRIu64, t_ns < 0 ? "-" : "", size / 1000000000, size % 1000000000);
}

/// TUM: timestamp tx ty tz qx qy qz qw
void put_tum(std::FILE* file, const pf_pose_t& pose) {
  put_seconds(file, pose.t_ns);
  const double* p = pose.p_WC;
  const double* q = pose.q_WC;
  std::fprintf(file, " %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", p[0], p[1], p[2], q[1], q[2], q[3], q[0]);
}

const char* track_name(uint32_t status) {
  constexpr const char* kNames[] = {"unknown", "inlier", "outlier", "missed", "new"};
  return kNames[status <= 4 ? status : 0];
}

const char* kind_name(uint32_t kind) {
  constexpr const char* kNames[] = {"unknown", "inverse_depth", "point", "folded", "fixed"};
  return kNames[kind <= 4 ? kind : 0];
}

}  // namespace

bool Outputs::claim(const std::string& name, std::string& error) const {
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (pf_add_output_file(folder_.c_str(), name.c_str(), message) == 0) {
    return true;
  }
  error = message;
  return false;
}

Outputs::File Outputs::create(const char* name, std::string& error) const {
  if (!claim(name, error)) {
    return nullptr;
  }
  File file(std::fopen(path(name).c_str(), "w"));
  if (!file) {
    error = path(name) + ": cannot be written (" + std::strerror(errno) + "); choose another --out";
  }
  return file;
}

bool Outputs::open(const std::string& folder, bool tracks, bool truth, std::string& error) {
  folder_ = folder;
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (pf_open_output_folder(folder.c_str(), "--out", message) != 0) {
    error = message;
    return false;
  }
  error.clear();
  trajectory_ = create("trajectory.txt", error);
  trajectory_all_ = create("trajectory_all.txt", error);
  covariance_ = create("covariance.csv", error);
  frames_ = create("frames.csv", error);
  if (tracks) {
    tracks_ = create("tracks.csv", error);
  }
  if (truth) {
    truth_ = create("truth.tum", error);
  }
  if (!error.empty()) {
    return false;
  }
  std::fprintf(trajectory_.get(), "# T_WC of the tracked frames: timestamp tx ty tz qx qy qz qw\n");
  std::fprintf(trajectory_all_.get(),
               "# T_WC of every frame with a pose, coasting ones too: timestamp tx ty tz qx qy qz qw\n");
  std::fprintf(covariance_.get(), "# rows of trajectory.txt: timestamp, 6x6 of (theta, p) in W, row-major [rad, m]\n");
  std::fprintf(frames_.get(), "t_s,state,attempts,matches,inliers,features,state_dim,ms,nis,nis_dof\n");
  if (tracks_) {
    std::fprintf(tracks_.get(), "frame,id,status,kind,predicted_u,predicted_v,s_uu,s_uv,s_vv,measured_u,measured_v\n");
  }
  if (truth_) {
    std::fprintf(truth_.get(), "# true T_WC: timestamp tx ty tz qx qy qz qw\n");
  }
  return true;
}

void Outputs::write(const FrameView& view) {
  const pf_report_t& report = view.report;
  put_seconds(frames_.get(), view.image.t_ns);
  std::fprintf(frames_.get(), ",%s,%d,%d,%d,%d,%d,%.4f,%.6g,%d\n", state_name(report.state), report.attempts,
               report.matches, report.inliers, report.features, report.state_dim, view.ms, report.nis, report.nis_dof);
  if (view.has_pose) {
    put_tum(trajectory_all_.get(), view.pose);
  }
  if (view.tracked) {
    put_tum(trajectory_.get(), view.pose);
    put_seconds(covariance_.get(), view.pose.t_ns);
    for (double value : view.pose.covariance) {
      std::fprintf(covariance_.get(), ",%.9g", value);
    }
    std::fprintf(covariance_.get(), "\n");
  }
  if (tracks_) {
    for (const pf_track_t& t : view.tracks) {
      std::fprintf(tracks_.get(), "%" PRId64 ",%u,%s,%s,%.3f,%.3f,%.4g,%.4g,%.4g", view.index, t.id,
                   track_name(t.status), kind_name(t.kind), t.predicted_px[0], t.predicted_px[1], t.covariance_px[0],
                   t.covariance_px[1], t.covariance_px[3]);
      if (t.status == PF_TRACK_MISSED) {
        std::fprintf(tracks_.get(), ",,\n");
      } else {
        std::fprintf(tracks_.get(), ",%.3f,%.3f\n", t.measured_px[0], t.measured_px[1]);
      }
    }
  }
}

void Outputs::write_truth(const pf_pose_t& pose) {
  if (truth_) {
    put_tum(truth_.get(), pose);
  }
}

bool Outputs::write_true_planes(const std::vector<std::array<double, 4>>& planes, std::string& error) const {
  if (planes.empty()) {
    return true;
  }
  const File file = create("truth_planes.json", error);
  if (!file) {
    return false;
  }
  std::fprintf(file.get(), "{\"planes\": [");
  for (size_t i = 0; i < planes.size(); ++i) {
    const auto& p = planes[i];
    std::fprintf(file.get(), "%s\n  {\"name\": \"%zu\", \"normal\": [%.17g, %.17g, %.17g], \"distance\": %.17g}",
                 i == 0 ? "" : ",", i, p[0], p[1], p[2], p[3]);
  }
  std::fprintf(file.get(), "\n]}\n");
  if (std::fflush(file.get()) != 0) {
    error = path("truth_planes.json") + ": could not be written completely; is the disk full?";
  }
  return error.empty();
}

bool Outputs::finish(const FrameView& last, const std::vector<double>& sigmas_in_map, const pf_camera_t& camera,
                     const std::string& report, std::string& error) {
  error.clear();
  File ply = create("map.ply", error);
  File json = create("report.json", error);
  if (!error.empty()) {
    return false;
  }
  write_ply(ply.get(), last.features, sigmas_in_map, last.planes);
  std::fputs(report.c_str(), json.get());
  const File* files[] = {&trajectory_, &trajectory_all_, &covariance_, &frames_, &tracks_, &truth_, &ply, &json};
  for (const File* file : files) {
    if (*file && (std::fflush(file->get()) != 0 || std::ferror(file->get()) != 0)) {
      error = folder_.string() + ": could not be written completely (" + std::strerror(errno) + "); is the disk full?";
    }
  }
  char message[PF_SEQUENCE_MESSAGE];
  if (!claim("calib.yaml", error)) {
    return false;
  }
  if (pf_write_calibration(path("calib.yaml").c_str(), PF_CALIBRATION_PLAIN, &camera, 0.0, message) != 0) {
    error = message;
  }
  return error.empty();
}

}  // namespace pf::capture
