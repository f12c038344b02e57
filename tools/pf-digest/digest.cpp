// Writes a digest of every public value after each frame. The linker hands the programs' calls to here (--wrap), so that any
// program becomes one that writes digests, without a change to it; PLANEFOLD_DIGEST names the file, and without it nothing is done.
//
// One line a frame: the frames since create or reset, then one hash per kind of value. Values are hashed as numbers in the
// order of this file and not as structures, so that names and layouts may change. The file is appended to in whole lines.
//
// With PLANEFOLD_DIGEST_CONTINUE=N each Nth frame is followed by a save of the context (PF_MAP_CONTINUE), which goes on in a block that
// holds nothing else: the digests must be those of a run without.

#include <fcntl.h>
#include <planefold/planefold_research.h>
#include <unistd.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

extern "C" {
pf_status_t __real_pf_create(const pf_config_t* config, void* block, size_t bytes, pf_slam_t** slam);
pf_status_t __wrap_pf_create(const pf_config_t* config, void* block, size_t bytes, pf_slam_t** slam);
pf_status_t __real_pf_push_frame(pf_slam_t* slam, const pf_image_t* image);
pf_status_t __wrap_pf_push_frame(pf_slam_t* slam, const pf_image_t* image);
pf_status_t __real_pf_push_observations(pf_slam_t* slam, int64_t t_ns, const pf_observation_t* observations,
                                        size_t count);
pf_status_t __wrap_pf_push_observations(pf_slam_t* slam, int64_t t_ns, const pf_observation_t* observations,
                                        size_t count);
}

namespace {

constexpr int kFormat = 3;  // grows when what is hashed changes: files of different formats cannot be compared
constexpr int kGaugeEvery = 100;

enum Kind {
  kState,
  kPose,
  kPredicted,
  kFeatures,
  kPlanes,
  kMatches,
  kReport,
  kHits,
  kImu,
  kGauge,
  kPatches,
  kTemplates,
  kLens,
  kInertial,
  kCorrection,
  kKinds
};
constexpr const char* kNames[kKinds] = {"state",   "pose",      "predicted", "features", "planes",
                                        "matches", "report",    "hits",      "imu",      "gauge",
                                        "patches", "templates", "lens",      "inertial", "correction"};

/// FNV-1a over whole numbers; all zeros are one number, and so are all NaN.
class Hash {
 public:
  Hash& operator<<(double value) {
    std::uint64_t bits = 0x7ff8000000000000U;
    value += 0.0;  // -0 becomes 0
    if (!std::isnan(value)) std::memcpy(&bits, &value, sizeof bits);
    hash_ = (hash_ ^ bits) * 0x100000001b3U;
    hash_ ^= hash_ >> 29;
    if (values != nullptr) values->push_back(value);
    return *this;
  }
  template <std::size_t n>
  Hash& operator<<(const double (&array)[n]) {
    for (const double value : array) *this << value;
    return *this;
  }
  std::uint64_t value() const { return hash_; }
  std::vector<double>* values = nullptr;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

void add(Hash& h, const pf_pose_t& p) {
  h << static_cast<double>(p.t_ns) << p.q_WC << p.p_WC << p.covariance << p.v_W << p.w_C << p.map_id;
}

void add(Hash& h, const pf_feature_t& f) {
  h << f.id << f.external_id << f.kind << f.is_target << f.plane << f.map_id << f.p_W << f.covariance << f.observations
    << f.attempts;
}

void add(Hash& h, const pf_plane_t& p) {
  h << p.id << p.orientation << p.points << p.fixed_points << p.map_id << p.normal_W << p.distance << p.R_WP << p.p_WP
    << p.covariance << p.is_wall << p.rejected << p.outline_count;
  for (int i = 0; i < p.outline_count; ++i) h << p.outline_P[i];
  h << p.area;
}

void add(Hash& h, const pf_match_t& t) {
  h << t.id << t.status << t.kind << t.predicted_px << t.covariance_px << t.measured_px << t.nis;
}

void add(Hash& h, const pf_report_t& r) {  // without the cost of stages
  h << static_cast<double>(r.t_ns) << r.state << r.frames << r.attempts << r.matches << r.inliers << r.new_features
    << r.evicted << r.features << r.features_point << r.features_inverse_depth << r.features_folded + r.features_trial
    << r.features_fixed << r.planes << r.state_dim << r.state_dim_held << r.state_dim_points_only << r.map_id
    << r.kept_views << r.nis << r.nis_dof << r.kernels << r.patches << r.cameras << static_cast<double>(r.duplicates)
    << r.sigma_gate_px << r.sigma_info_px << r.correlation_frames << static_cast<double>(r.covariance_repairs)
    << r.templates << r.keyframes << r.template_area << r.places << r.places_returned;
}

void add(Hash& h, const pf_patch_t& p) {
  h << p.id << p.plane << p.status << p.frames;
  for (const auto& corner : p.corners_px) h << corner;
  h << p.covariance_px << p.weight;
}

void add(Hash& h, const pf_inertial_t& i) {
  h << i.gravity_W << i.gyro_bias << i.accel_bias << i.covariance << i.gravity_axes_W[0] << i.gravity_axes_W[1]
    << i.metric << i.from_motion << i.map_id << i.resting << i.rests << i.q_BC << i.p_BC << i.delay_s << i.readout_s
    << i.sigma.gravity_rad << i.sigma.gyro_bias << i.sigma.accel_bias << i.sigma.mount_rad << i.sigma.mount_m
    << i.sigma.delay_s << i.sigma.readout_s << i.sigma.log_scale;
}

void add(Hash& h, const pf_imu_report_t& r) {
  const std::int64_t counts[] = {r.samples, r.since_frame, r.last_frame, r.late,      r.saturated,
                                 r.gaps,    r.missing,     r.first_t_ns, r.last_t_ns, r.longest_ns};
  for (const std::int64_t count : counts) h << static_cast<double>(count);
  h << r.rate_hz << r.median_s << r.kept << r.used << r.rejected << r.rejected_s;
}

void add(Hash& h, const pf_imu_sample_t& s) { h << static_cast<double>(s.t_ns) << s.gyro << s.accel; }

/// Everything that a getter copies into an array.
template <class T>
void add_all(Hash& h, const pf_slam_t* slam, pf_status_t (*get)(const pf_slam_t*, T*, std::size_t, std::size_t*)) {
  std::vector<T> items(256);
  std::size_t count = 0;
  pf_status_t status = get(slam, items.data(), items.size(), &count);
  if (status == PF_NOTE_TRUNCATED) {
    items.resize(count);
    status = get(slam, items.data(), items.size(), &count);
  }
  h << status << static_cast<double>(count);
  for (std::size_t i = 0; status >= 0 && i < count; ++i) add(h, items[i]);
}

void add_predictions(Hash& h, const pf_slam_t* slam, std::int64_t t_ns) {
  for (const std::int64_t ahead_ns : {0, 20000000}) {
    pf_pose_t pose{};
    const pf_status_t status = pf_predict_pose(slam, t_ns + ahead_ns, &pose);
    h << status;
    if (status >= 0) add(h, pose);
  }
  for (const double x : {-0.3, 0.1, 0.4}) {
    const double p_W[3] = {x, 0.2 - x, 1.5};
    double pixel[2] = {}, covariance[4] = {};
    const pf_status_t status = pf_project_point(slam, p_W, pixel, covariance);
    h << status;
    if (status >= 0) h << pixel << covariance;
  }
}

void add_hits(Hash& h, const pf_slam_t* slam, const pf_camera_t& camera) {
  for (const double v : {0.25, 0.5, 0.75}) {
    for (const double u : {0.2, 0.4, 0.6, 0.8}) {
      const double pixel[2] = {u * camera.width, v * camera.height};
      pf_hit_t hit{};
      const pf_status_t status = pf_hit_test(slam, pixel, &hit);
      h << status;
      if (status == PF_OK) h << hit.plane << hit.p_W << hit.covariance << hit.range;
    }
  }
}

void add_gauge(Hash& h, const pf_slam_t* slam, int state_dim) {
  const auto n = static_cast<std::size_t>(state_dim);
  std::vector<double> scratch(n * (n + 8));
  double information[49] = {};
  h << pf_get_gauge_information(slam, scratch.data(), scratch.size(), information) << information;
}

void add_templates(Hash& h, const pf_slam_t* slam) {
  std::vector<pf_feature_t> features(1000);
  std::size_t count = 0;
  pf_get_features(slam, features.data(), features.size(), &count);
  for (std::size_t i = 0; i < count && i < features.size(); ++i) {
    pf_template_t t{};
    const pf_status_t status = pf_get_template(slam, features[i].id, &t);
    h << status;
    if (status != PF_OK) continue;
    h << t.feature << t.side << t.normal_W << t.sigma_normal_rad << t.centre_px << t.frames;
    for (std::int32_t k = 0; k < t.side * t.side; ++k) h << t.grey[k] << t.mask[k];
  }
}

void add_lens(Hash& h, const pf_slam_t* slam) {
  pf_camera_t camera{};
  double covariance[100] = {};
  h << pf_get_camera(slam, &camera, covariance);
  h << camera.fx << camera.fy << camera.cx << camera.cy << camera.distortion << camera.readout_s << covariance;
}

/// What a context was created with.
struct Created {
  pf_config_t config;
  void* block;
  std::size_t bytes;
  std::int64_t frames = 0;  ///< since then
};

std::map<const pf_slam_t*, Created>& contexts() {
  static std::map<const pf_slam_t*, Created> all;
  return all;
}

[[noreturn]] void stop(const char* what, pf_status_t status) {
  std::fprintf(stderr, "pf-digest: %s: %s\n", what, pf_status_text(status));
  std::_Exit(1);
}

/// The context goes on from its bytes alone: whatever else its block held is overwritten.
void continue_anew(pf_slam_t* slam) {
  static const char* const every = std::getenv("PLANEFOLD_DIGEST_CONTINUE");
  Created& created = contexts()[slam];
  if (every == nullptr || ++created.frames % std::atoll(every) != 0) return;
  std::size_t bytes = 0, used = 0;
  pf_status_t status = pf_map_size(slam, PF_MAP_CONTINUE, &bytes);
  std::vector<std::uint8_t> saved(bytes);
  if (status == PF_OK) status = pf_save_map(slam, PF_MAP_CONTINUE, saved.data(), saved.size(), &used);
  if (status != PF_OK) stop("saving", status);
  std::memset(created.block, 0xa5, created.bytes);
  pf_slam_t* same = nullptr;
  status = __real_pf_create(&created.config, created.block, created.bytes, &same);
  if (status == PF_OK && same == slam) status = pf_load_map(slam, saved.data(), used);
  if (status != PF_OK) stop("going on", status);
}

/// A file that is appended to; each process opens it anew. Without a name nothing is written.
class Output {
 public:
  explicit Output(const char* variable) {
    const char* name = std::getenv(variable);
    if (name == nullptr) return;
    file_ = open(name, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (file_ < 0) give_up(name);
  }
  explicit operator bool() const { return file_ >= 0; }
  bool is_empty() const { return lseek(file_, 0, SEEK_END) == 0; }
  void write(const void* bytes, std::size_t size) const {
    if (::write(file_, bytes, size) != static_cast<ssize_t>(size)) give_up("the digest");
  }

 private:
  [[noreturn]] static void give_up(const char* name) {
    std::perror(name);
    std::_Exit(1);
  }
  int file_ = -1;
};

void write_digest(const pf_slam_t* slam, pf_status_t pushed) {
  static const Output hashes("PLANEFOLD_DIGEST"), numbers("PLANEFOLD_DIGEST_VALUES");
  if (!hashes) return;

  Hash h[kKinds];
  std::vector<double> values[kKinds];
  for (int k = 0; k < kKinds; ++k) h[k].values = numbers ? &values[k] : nullptr;
  pf_state_t state{};
  h[kState] << pushed << pf_get_state(slam, &state) << state;
  pf_report_t report{};
  h[kReport] << pf_get_report(slam, &report);
  add(h[kReport], report);
  pf_pose_t pose{};
  const pf_status_t has_pose = pf_get_pose(slam, &pose);
  h[kPose] << has_pose;
  if (has_pose >= 0) add(h[kPose], pose);
  add_predictions(h[kPredicted], slam, report.t_ns);
  add_all(h[kFeatures], slam, pf_get_features);
  add_all(h[kPlanes], slam, pf_get_planes);
  add_all(h[kMatches], slam, pf_get_matches);
  add_hits(h[kHits], slam, contexts()[slam].config.camera);
  pf_imu_report_t imu{};
  h[kImu] << pf_get_imu_report(slam, &imu);
  add(h[kImu], imu);
  add_all(h[kImu], slam, pf_get_imu_samples);
  if (report.frames % kGaugeEvery == 0) add_gauge(h[kGauge], slam, report.state_dim);
  add_all(h[kPatches], slam, pf_get_patches);
  add_templates(h[kTemplates], slam);
  add_lens(h[kLens], slam);
  pf_inertial_t inertial{};
  const pf_status_t has_inertial = pf_get_inertial(slam, &inertial);
  h[kInertial] << has_inertial;
  if (has_inertial == PF_OK) add(h[kInertial], inertial);
  h[kCorrection] << report.correction_scale << report.correction_q << report.correction_p
                 << report.correction_from_map_id;

  std::string line;
  if (hashes.is_empty()) {
    line = "format " + std::to_string(kFormat) + "\nframe";
    for (const char* name : kNames) line += std::string(" ") + name;
    line += "\n";
  }
  line += std::to_string(report.frames);
  for (const Hash& hash : h) {
    char text[24];
    std::snprintf(text, sizeof text, " %016" PRIx64, hash.value());
    line += text;
  }
  line += "\n";
  hashes.write(line.data(), line.size());
  for (const std::vector<double>& of_kind : values) {
    if (!numbers) break;
    const auto count = static_cast<double>(of_kind.size());
    numbers.write(&count, sizeof count);
    numbers.write(of_kind.data(), of_kind.size() * sizeof(double));
  }
}

}  // namespace

pf_status_t __wrap_pf_create(const pf_config_t* config, void* block, size_t bytes, pf_slam_t** slam) {
  const pf_status_t status = __real_pf_create(config, block, bytes, slam);
  if (status >= 0) contexts()[*slam] = {*config, block, bytes};
  return status;
}

pf_status_t __wrap_pf_push_frame(pf_slam_t* slam, const pf_image_t* image) {
  const pf_status_t status = __real_pf_push_frame(slam, image);
  write_digest(slam, status);
  continue_anew(slam);
  return status;
}

pf_status_t __wrap_pf_push_observations(pf_slam_t* slam, int64_t t_ns, const pf_observation_t* observations,
                                        size_t count) {
  const pf_status_t status = __real_pf_push_observations(slam, t_ns, observations, count);
  write_digest(slam, status);
  continue_anew(slam);
  return status;
}
