#include "outputs.h"

#include <planefold_platform/sequence.h>

#include <cerrno>
#include <cinttypes>
#include <cstring>

#include "anchors.h"
#include "plane_outputs.h"

namespace pf::capture {

namespace {

/// Nanoseconds as decimal seconds, exactly.
void put_seconds(std::string& rows, int64_t t_ns) {
  const uint64_t size = t_ns < 0 ? 0 - static_cast<uint64_t>(t_ns) : static_cast<uint64_t>(t_ns);
  append(rows, "%s%" PRIu64 ".%09" PRIu64, t_ns < 0 ? "-" : "", size / 1000000000, size % 1000000000);
}

/// TUM: timestamp tx ty tz qx qy qz qw
void put_tum(std::string& rows, const pf_pose_t& pose) {
  put_seconds(rows, pose.t_ns);
  const double* p = pose.p_WC;
  const double* q = pose.q_WC;
  append(rows, " %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", p[0], p[1], p[2], q[1], q[2], q[3], q[0]);
}

/// T_KC over a window, 6x6 of (theta, p) in K; the last two fields are empty without truth.
void put_window(std::string& rows, const MotionWindow& window) {
  const pf_motion_t& motion = window.motion;
  put_seconds(rows, motion.mark_t_ns);
  rows += ',';
  put_seconds(rows, motion.t_ns);
  append(rows, ",%d", window.map);
  for (const double value : motion.q_KC) {
    append(rows, ",%.9g", value);
  }
  for (const double value : motion.p_KC) {
    append(rows, ",%.9g", value);
  }
  for (const double value : motion.covariance) {
    append(rows, ",%.9g", value);
  }
  if (window.nees >= 0.0) {
    append(rows, ",%.6g,%" PRId64 "\n", window.nees, window.nees_dof);
  } else {
    rows += ",,\n";
  }
}

/// The lens that the pose at this time belongs to.
void put_lens(std::string& rows, int64_t t_ns, const pf_camera_t& camera) {
  put_seconds(rows, t_ns);
  append(rows, ",%.9g,%.9g,%.9g,%.9g", camera.fx, camera.fy, camera.cx, camera.cy);
  for (int i = 0; i < 5; ++i) {
    append(rows, ",%.9g", camera.distortion[i]);
  }
  rows += '\n';
}

constexpr const char* kInertialHeader =
    "t_s,map,metric,resting,gravity_x,gravity_y,gravity_z,gyro_bias_x,gyro_bias_y,gyro_bias_z,"
    "accel_bias_x,accel_bias_y,accel_bias_z,delay_s,readout_s,"
    "sigma_gravity_1,sigma_gravity_2,sigma_gyro_x,sigma_gyro_y,sigma_gyro_z,"
    "sigma_accel_x,sigma_accel_y,sigma_accel_z,sigma_delay_s,sigma_readout_s\n";

/// Standard deviations as pf_inertial_t says; negative: not estimated.
void put_inertial(std::string& rows, const FrameView& view) {
  const pf_inertial_t& unit = view.inertial;
  put_seconds(rows, view.pose.t_ns);
  append(rows, ",%d,%u,%u", view.map, unit.metric, unit.resting);
  for (const double* vector : {unit.gravity_W, unit.gyro_bias, unit.accel_bias}) {
    append(rows, ",%.9g,%.9g,%.9g", vector[0], vector[1], vector[2]);
  }
  append(rows, ",%.9g,%.9g", unit.delay_s, unit.readout_s);
  append(rows, ",%.6g,%.6g", unit.sigma.gravity_rad[0], unit.sigma.gravity_rad[1]);
  for (const double* three : {unit.sigma.gyro_bias, unit.sigma.accel_bias}) {
    append(rows, ",%.6g,%.6g,%.6g", three[0], three[1], three[2]);
  }
  append(rows, ",%.6g,%.6g\n", unit.sigma.delay_s, unit.sigma.readout_s);
}

/// Corners that were measured, or else predicted.
void put_patch(std::string& rows, int64_t frame, const pf_patch_t& patch) {
  append(rows, "%" PRId64 ",%u,%u,%s,%d,%.3f", frame, patch.id, patch.plane,
         patch.status == 0 ? "unseen" : match_name(patch.status), patch.frames, patch.weight);
  for (const auto& corner : patch.corners_px) {
    append(rows, ",%.3f,%.3f", corner[0], corner[1]);
  }
  rows += '\n';
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

bool Outputs::create(TextFile& file, const std::string& name, std::string& error) const {
  if (!claim(name, error)) {
    return false;
  }
  if (!file.create(path(name))) {
    error = path(name) + ": cannot be written (" + std::strerror(errno) + "); choose another --out";
    return false;
  }
  return true;
}

bool Outputs::open_again(TextFile& file, const std::string& name, std::string& error) const {
  if (!file.open_again(path(name))) {
    error = path(name) + ": cannot be written (" + std::strerror(errno) + "); choose another --out";
    return false;
  }
  return true;
}

bool Outputs::open(const std::string& folder, bool tracks, bool patches, bool truth, bool relative,
                   const pf_camera_t& camera, bool inertial, std::string& error) {
  folder_ = folder;
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (pf_open_output_folder(folder.c_str(), "--out", message) != 0) {
    error = message;
    return false;
  }
  if (!open_map(1, error) || !create(frames_, "frames.csv", error) ||
      (tracks && !(create(tracks_, "tracks.csv", error) && create(planes_, "planes.csv", error))) ||
      (patches && !create(patches_, "patches.csv", error)) || (truth && !create(truth_, "truth.tum", error)) ||
      (relative && !create(relative_, "relative.csv", error)) ||
      (camera.estimate == PF_CAMERA_ESTIMATE && !create(lens_, "lens.csv", error)) ||
      (inertial && !create(inertial_, "inertial.csv", error))) {
    return false;
  }
  for (const char* name : {"calib.yaml", "map.ply", "map.ply.part", "report.json", "report.json.part"}) {
    if (!claim(name, error)) {
      return false;
    }
  }
  if (pf_write_calibration(path("calib.yaml").c_str(), PF_CALIBRATION_PLAIN, &camera, 0.0, message) != 0) {
    error = message;
    return false;
  }
  frames_.rows() =
      "t_s,state,attempts,matches,inliers,features,state_dim,ms,nis,nis_dof,planes,folded,trial,fixed,rows_points_only,"
      "tracked,log_odds,consensus,reason,masked_permille\n";
  tracks_.rows() = TrackRows::kTracksHeader;
  planes_.rows() = TrackRows::kPlanesHeader;
  patches_.rows() = "frame,id,wall,status,frames,weight,u0,v0,u1,v1,u2,v2,u3,v3\n";
  relative_.rows() = "mark_t_s,t_s,map,qw,qx,qy,qz,px,py,pz";
  for (int i = 0; i < 36; ++i) {
    append(relative_.rows(), ",c%d%d", i / 6, i % 6);
  }
  relative_.rows() += ",nees,nees_dof\n";
  lens_.rows() =
      "# lens of the poses of tracked frames: timestamp, fx, fy, cx, cy [px], distortion[0] .. distortion[4]\n";
  inertial_.rows() = kInertialHeader;
  truth_.rows() = "# true T_WC: timestamp tx ty tz qx qy qz qw\n";
  return true;
}

/// Opens the files of poses in the world of a map, in place of those of the map before; of a map that the run has come back to, again.
bool Outputs::open_map(int map, std::string& error) {
  const std::string end = map == 1 ? "" : "_" + std::to_string(map);
  if (map <= maps_opened_) {
    map_ = map;
    return open_again(trajectory_, "trajectory" + end + ".txt", error) &&
           open_again(trajectory_all_, "trajectory_all" + end + ".txt", error) &&
           open_again(covariance_, "covariance" + end + ".csv", error);
  }
  if (!create(trajectory_, "trajectory" + end + ".txt", error) ||
      !create(trajectory_all_, "trajectory_all" + end + ".txt", error) ||
      !create(covariance_, "covariance" + end + ".csv", error)) {
    return false;
  }
  trajectory_.rows() = "# T_WC of the tracked frames: timestamp tx ty tz qx qy qz qw\n";
  trajectory_all_.rows() = "# T_WC of every frame with a pose, coasting ones too: timestamp tx ty tz qx qy qz qw\n";
  covariance_.rows() = "# rows of trajectory" + end + ".txt: timestamp, 6x6 of (theta, p) in W, row-major [rad, m]\n";
  map_ = maps_opened_ = map;
  return true;
}

bool Outputs::open_anchors(std::string& error) {
  if (!create(anchors_, "anchors.csv", error)) {
    return false;
  }
  anchors_.rows() = kAnchorsHeader;
  for (int i = 0; i < 36; ++i) {
    append(anchors_.rows(), ",c%d%d", i / 6, i % 6);
  }
  anchors_.rows() += '\n';
  return true;
}

/// A row of corrections.csv where poses that were given out before have moved, or their map goes on under another id.
bool Outputs::put_correction(const FrameView& view, std::string& error) {
  const pf_report_t& r = view.report;
  const double* const q = r.correction_q;
  const double* const p = r.correction_p;
  const bool has_moved = r.correction_scale != 1 || q[0] != 1 || p[0] != 0 || p[1] != 0 || p[2] != 0;
  if (!has_moved && r.correction_from_map_id == r.map_id) {
    return true;
  }
  if (!corrections_.is_open()) {
    if (!create(corrections_, "corrections.csv", error)) {
      return false;
    }
    corrections_.rows() = "t_s,from_map,map,scale,qw,qx,qy,qz,px,py,pz\n";
  }
  std::string& rows = corrections_.rows();
  put_seconds(rows, view.image.t_ns);
  append(rows, ",%u,%u,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", r.correction_from_map_id, r.map_id,
         r.correction_scale, q[0], q[1], q[2], q[3], p[0], p[1], p[2]);
  return true;
}

bool Outputs::write(const FrameView& view, Source& source, const MotionWindow* window, std::string& error) {
  pf_pose_t truth{};
  const pf_report_t& report = view.report;
  if (view.map != map_ && !open_map(view.map, error)) {
    return false;
  }
  std::string& frames = frames_.rows();
  put_seconds(frames, view.image.t_ns);
  append(frames, ",%s,%d,%d,%d,%d,%d,%.4f,%.6g,%d,%d,%d,%d,%d,%d,%d,%.2f,%d,%s,%u\n", state_name(report.state),
         report.attempts, report.matches, report.inliers, report.features, report.state_dim, view.ms, report.nis,
         report.nis_dof, report.planes, report.features_folded, report.features_trial, report.features_fixed,
         report.state_dim_points_only, view.tracked ? 1 : 0, report.log_odds, report.consensus,
         reason_name(report.reason), report.masked_permille);
  if (view.has_pose) {
    put_tum(trajectory_all_.rows(), view.pose);
  }
  if (view.tracked) {
    put_tum(trajectory_.rows(), view.pose);
    std::string& covariance = covariance_.rows();
    put_seconds(covariance, view.pose.t_ns);
    for (double value : view.pose.covariance) {
      append(covariance, ",%.9g", value);
    }
    covariance += '\n';
    if (lens_.is_open()) put_lens(lens_.rows(), view.pose.t_ns, view.camera);
  }
  if (inertial_.is_open() && view.has_pose && view.has_inertial) {
    put_inertial(inertial_.rows(), view);
  }
  if (source.truth(truth)) {
    put_tum(truth_.rows(), truth);
  }
  if (window != nullptr) {
    put_window(relative_.rows(), *window);
  }
  if (tracks_.is_open()) {
    track_rows_.add(view, source, tracks_.rows(), planes_.rows());
  }
  if (patches_.is_open()) {
    for (const pf_patch_t& patch : view.patches) put_patch(patches_.rows(), view.index, patch);
  }
  if (!view.anchors.empty() && !anchors_.is_open() && !open_anchors(error)) {
    return false;
  }
  if (anchors_.is_open()) {
    put_anchors(anchors_.rows(), view);
  }
  if (!put_correction(view, error)) {
    return false;
  }
  bool written = true;
  // The covariance before the trajectory, so that whatever ends the program leaves one for every pose.
  for (TextFile* file : {&covariance_, &trajectory_, &trajectory_all_, &tracks_, &planes_, &patches_, &truth_,
                         &relative_, &lens_, &inertial_, &anchors_, &corrections_, &frames_}) {
    written = file->write_rows(error) && written;
  }
  return written;
}

bool Outputs::write_true_planes(const std::vector<std::array<double, 4>>& planes, std::string& error) const {
  if (planes.empty()) {
    return true;
  }
  std::string text = "{\"planes\": [";
  for (size_t i = 0; i < planes.size(); ++i) {
    const auto& p = planes[i];
    append(text, "%s\n  {\"name\": \"%zu\", \"normal\": [%.17g, %.17g, %.17g], \"distance\": %.17g}", i == 0 ? "" : ",",
           i, p[0], p[1], p[2], p[3]);
  }
  text += "\n]}\n";
  return claim("truth_planes.json", error) && replace_file(path("truth_planes.json"), text, error);
}

bool Outputs::write_state(const FrameView& last, const std::vector<double>& sigmas_in_map, const std::string& report,
                          std::string& error) const {
  return replace_file(path("map.ply"), to_ply(last.features, sigmas_in_map, last.planes), error) &&
         replace_file(path("report.json"), report, error);
}

}  // namespace pf::capture
