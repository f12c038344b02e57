#include "vio_run.h"

#include <planefold/planefold_research.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "context.h"
#include "statistics.h"
#include "update_cost.h"
#include "vio_planes.h"
#include "vio_world.h"

namespace pfsim {
namespace {

using pf::sim::Pose;
using pf::sim::Random;
using pf::sim::Vec3;

constexpr std::uint64_t kPoorEvery = 10;  // runs
constexpr int kGaugeEvery = 50;           // frames
constexpr double kScaleAfter = 5;         // [s] of motion, when the scale is judged first
constexpr double kAhead = 3;              // sigmas of the delay by which samples are ahead of their frame
constexpr double kReadoutAfter = 10;      // [s] likewise the readout

constexpr double kAfter = 5;          // [s] from the beginning of a fault, when all should be well again
constexpr double kStill = 1;          // [s] that a unit or a camera stops
constexpr double kReversed = 2;       // [s]
constexpr double kLateBy = 0.02;      // [s]
constexpr double kClockJump = 0.05;   // [s]
constexpr double kJitter = 1e-3;      // [s]
constexpr double kScaleError = 0.01;  // relative
constexpr double kGyroRange = 0.4;    // [rad/s]
constexpr double kAccelRange = 10.5;  // [m/s^2]
constexpr int kDisorderEvery = 10;    // samples

pf_config_t config_of(const VioOptions& o, const pf_camera_t& camera) {
  pf_config_t config;
  pf_config_default(&config);
  config.camera = camera;
  config.camera.readout_s = o.as_global             ? 0
                            : o.told_readout_s >= 0 ? o.told_readout_s
                                                    : o.readout_s - o.sigma_readout_s;
  config.capacity.max_imu_samples = 2000;
  config.clock_ns = thread_clock;
  if (!o.rendered) {
    config.measurement.sigma_px = o.sigma_px;
    config.measurement.gate_probability = 0.9999;  // association is perfect: nothing true should be cut off
    config.capacity.max_features = 120;
    config.capacity.max_state_dim = 420;
    config.first_depth.depth = 2;
    config.plane.enabled = 0;
  }
  if (o.window) use_window(config);
  if (!o.use_imu) return config;
  if (o.fault == VioFault::kSaturated) {
    config.imu.gyro_range = kGyroRange;
    config.imu.accel_range = kAccelRange;
  }
  config.motion.model = PF_MOTION_INERTIAL;
  config.imu.gyro_density = o.imu.gyro_density;
  config.imu.accel_density = o.imu.accel_density;
  config.imu.gyro_walk = o.imu.gyro_walk;
  config.imu.accel_walk = o.imu.accel_walk;
  if (o.axes < 0) {
    const auto q = pf::sim::quaternion_of(o.imu.R_BC);
    std::copy(q.begin(), q.end(), config.imu.q_BC);
    config.imu.p_BC[0] = o.imu.p_BC.x;
    config.imu.p_BC[1] = o.imu.p_BC.y;
    config.imu.p_BC[2] = o.imu.p_BC.z;
  }
  config.imu.delay_s = o.imu.delay_s;
  config.imu.gravity = o.imu.gravity_W.norm();
  config.imu.sigma_mount_rad = o.told_mount_rad;
  config.imu.sigma_mount_m = o.told_mount_m;
  config.imu.sigma_delay_s = o.told_delay_s;
  config.imu.sigma_scale = o.told_scale;
  config.imu.sigma_readout_s = o.sigma_readout_s;
  return config;
}

/// One run, frame by frame. W of the library is the first camera, so truth is told in that.
class Run {
 public:
  Run(const VioOptions& options, std::uint64_t seed, FrameRow* rows, VioSummary* summary)
      : o_(options),
        seed_(seed),
        rows_(rows),
        out_(*summary),
        world_(world(options, seed)),
        noise_(seed, 53),
        unit_(unit(options, seed)),
        sensor_(unit_, world_.path()),
        context_(config_of(options, world_.camera())),
        first_(world_.path()(0)),
        planes_(world_.scene(), first_, options.imu.gravity_W, options.sigma_vertical_rad) {}

  void go() {
    if (context_.slam == nullptr) return;
    out_.done = 1;
    out_.poor = is_poor(o_, seed_);
    const int frames = vio_frames(o_);
    for (int k = 0; k < frames; ++k)
      if (!frame(k)) return;
    out_.scale_error_end = scale_error();
    note_mounting();
    if (out_.readout_error_s < 0) note_readout();
  }

 private:
  static VioWorld world(const VioOptions& o, std::uint64_t seed) {
    if (o.rendered) return VioWorld(seed, o.scene, o.moving ? 0 : o.rest_s, o.shake);
    if (!o.moving) return VioWorld(seed, o.points, o.seconds, o.rest_s, o.turn_rad_s);
    const auto poor = seed / kPoorEvery % 2 == 0 ? VioWorld::Motion::kRotation : VioWorld::Motion::kEven;
    return VioWorld(seed, o.points, 1.4 * o.seconds, is_poor(o, seed) ? poor : VioWorld::Motion::kVaried);
  }

  static pf::sim::ImuOptions unit(const VioOptions& o, std::uint64_t seed) {
    pf::sim::ImuOptions imu = o.imu;
    Random bias(seed, 54);
    imu.gyro_bias = bias.normal3() * o.sigma_gyro_bias;
    imu.accel_bias = bias.normal3() * o.sigma_accel_bias;
    imu.seed = seed;
    Random mounting(seed, 55);  // R_CB_true = Exp(mu) R_CB, and the origin in C
    const Vec3 turn = mounting.normal3() * o.sigma_mount_rad, shift = mounting.normal3() * o.sigma_mount_m;
    const double delay = mounting.normal() * o.sigma_delay_s;
    if (o.sigma_mount_rad > 0 || o.sigma_mount_m > 0) {
      const Vec3 origin_C = imu.R_BC.transposed() * imu.p_BC * -1;
      imu.R_BC = imu.R_BC * pf::sim::rotation_exp(turn * -1);
      imu.p_BC = imu.R_BC * (origin_C + shift) * -1;
    }
    imu.delay_s += delay;
    if (o.axes >= 0) turn_axes(o.axes, &imu);
    if (o.phone) make_phone(seed, o.phone_parts, &imu);
    if (o.fault == VioFault::kGap) {
      imu.gap_at_s = o.fault_at_s;
      imu.gap_s = kStill;
    }
    if (o.fault == VioFault::kJitter) imu.jitter_s = kJitter;
    if (o.fault == VioFault::kScale) imu.gyro_scale = imu.accel_scale = kScaleError;
    if (o.fault == VioFault::kSaturated) {
      imu.gyro_range = kGyroRange;
      imu.accel_range = kAccelRange;
    }
    if (o.fault == VioFault::kMount)  // the truth; the config has it the other way round
      imu.R_BC = pf::sim::rotation_exp({3.14159265358979, 0, 0}) * imu.R_BC;
    return imu;
  }

  /// When the scale should be known.
  double begin_s() const { return !o_.moving ? o_.rest_s : out_.start_s >= 0 ? out_.start_s : 1e9; }

  Pose truth_at(double t) const {
    const Pose now = world_.path()(t);
    const pf::sim::Mat3 R = first_.R_WC.transposed();
    return {R * now.R_WC, R * (now.p_WC - first_.p_WC)};
  }

  bool is_dark(double t) const {
    return o_.blackout_s > 0 && t >= o_.blackout_at_s && t < o_.blackout_at_s + o_.blackout_s;
  }

  static void reverse(pf_imu_sample_t* sample) {
    for (int i = 0; i < 3; ++i) {
      sample->gyro[i] = -sample->gyro[i];
      sample->accel[i] = -sample->accel[i];
    }
  }

  /// Samples up to a frame's time, on their own clock; of a delay that is not known three sigma more, which have come when the picture has.
  void push_samples(std::int64_t t_ns) {
    const auto in_ns = [](double s) { return static_cast<std::int64_t>(std::llround(s * 1e9)); };
    const bool wrong = o_.fault != VioFault::kNone && t_ns >= in_ns(o_.fault_at_s);
    const std::int64_t until_ns = wrong && o_.fault == VioFault::kLate ? t_ns - in_ns(kLateBy) : t_ns;
    std::vector<pf_imu_sample_t> samples;
    while (sensor_.next_ns() <= until_ns + in_ns(kAhead * o_.told_delay_s)) {
      samples.push_back(sensor_.next());
      if (wrong && o_.fault == VioFault::kClockJump) samples.back().t_ns += in_ns(kClockJump);
      if (wrong && o_.fault == VioFault::kReversed && t_ns < in_ns(o_.fault_at_s + kReversed)) reverse(&samples.back());
    }
    if (!o_.use_imu || samples.empty() || (wrong && o_.fault == VioFault::kStop)) return;
    if (wrong && o_.fault == VioFault::kDisorder)
      for (std::size_t i = 1; i < samples.size(); ++i)
        if (++counted_ % kDisorderEvery == 0) std::swap(samples[i - 1], samples[i]);
    if (!wrong) {
      out_.refused += pf_push_imu(context_.slam, samples.data(), samples.size()) != PF_OK;
      return;
    }
    for (const pf_imu_sample_t& sample : samples)  // what is refused is no reason to do without the others
      for (int again = 0; again < (o_.fault == VioFault::kRepeated ? 2 : 1); ++again)
        out_.refused_samples += pf_push_imu(context_.slam, &sample, 1) != PF_OK;
  }

  pf_status_t push_points(std::int64_t t_ns, bool dark) {
    const double t = 1e-9 * static_cast<double>(t_ns);
    auto seen = world_.observe(t, o_.readout_s, o_.sigma_px, noise_);
    if (o_.hand) world_.wave(t, o_.sigma_px, noise_, &seen);
    if (dark) seen.clear();
    return pf_push_observations(context_.slam, t_ns, seen.data(), seen.size());
  }

  pf_status_t push_picture(std::int64_t t_ns, bool dark) {
    if (!world_.draw(1e-9 * static_cast<double>(t_ns), o_.readout_s, o_.noise_grey, noise_, &grey_))
      return PF_ERROR_STATE;
    if (dark) std::fill(grey_.begin(), grey_.end(), static_cast<std::uint8_t>(0));
    const pf_camera_t& camera = world_.camera();
    const pf_image_t image = {grey_.data(), camera.width, camera.height, camera.width, t_ns};
    return pf_push_frame(context_.slam, &image);
  }

  bool frame(int k) {
    const auto t_ns = static_cast<std::int64_t>(std::llround(k * 1e9 / o_.rate_hz));
    const double t = static_cast<double>(t_ns) * 1e-9;
    push_samples(t_ns);
    rows_[k].nees_position = rows_[k].nees_pose = -1;
    if (o_.fault == VioFault::kFramesStop && t >= o_.fault_at_s && t < o_.fault_at_s + kStill) return true;
    Pose truth = truth_at(t);
    const bool dark = is_dark(t);
    const pf_status_t status = o_.rendered ? push_picture(t_ns, dark) : push_points(t_ns, dark);
    pf_pose_t pose;
    pf_report_t report;
    FrameRow& row = rows_[k];
    row.nees_position = row.nees_pose = -1;
    if (status < 0 || pf_get_pose(context_.slam, &pose) != PF_OK) {
      ++out_.refused;
      return false;
    }
    pf_get_report(context_.slam, &report);
    out_.lost |= status == PF_NOTE_LOST;
    out_.frames_tracked += status == PF_OK;
    out_.imu_seconds += 1e-9 * static_cast<double>(report.stage_ns[PF_STAGE_IMU]);
    for (const std::int64_t ns : report.stage_ns) out_.frame_seconds += 1e-9 * static_cast<double>(ns);
    note_blackout(k, dark, status);
    if (begins_anew(pose.map_id)) {
      first_ = world_.path()(t);
      last_ = truth = truth_at(t);
      has_gauge_ = false;
    }
    note_doubt(t, pose);
    const bool judged = note_unit(k, report);
    if (judged && out_.start_s < 0) {
      out_.start_s = t;
      out_.start_tilt_rad = out_.tilt_rad;
    }
    if (o_.rendered) planes_.note(context_.slam, judged, k + 1 == vio_frames(o_), &out_.planes);
    if (judged || !o_.use_imu) {
      row = judge(truth, pose, report);
      if (row.sigma_m > 0 && row.error_m > 1e-4F)
        out_.worst_sigmas = std::max(out_.worst_sigmas, static_cast<double>(row.error_m / row.sigma_m));
    }
    if (o_.fault != VioFault::kNone && t >= o_.fault_at_s + kAfter) {
      ++out_.frames_after;
      out_.tracked_after += status == PF_OK;
      if (row.nees_pose >= 0) {
        ++out_.judged_after;
        out_.nees_after += row.nees_pose;
      }
      if (row.sigma_m > 0)
        out_.worst_sigmas_after = std::max(out_.worst_sigmas_after, static_cast<double>(row.error_m / row.sigma_m));
    }
    if (judged) note_wander(pose);
    if (judged) {
      const Vec3 p{pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]};
      along_ += p.dot(truth.p_WC);
      squares_ += truth.p_WC.dot(truth.p_WC);
    }
    if (k > 0) out_.path_m += (truth.p_WC - last_.p_WC).norm();
    last_ = truth;
    if (judged && out_.start_s == t) out_.start_scale_error = scale_error();
    const Vec3 e = truth.p_WC - Vec3{pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]};
    out_.end_error_m = e.norm();
    if ((judged || !o_.use_imu) && out_.scale_error_5s < 0 && t >= begin_s() + kScaleAfter)
      out_.scale_error_5s = scale_error();
    if (out_.readout_error_s < 0 && t >= begin_s() + kReadoutAfter) note_readout();
    return true;
  }

  void note_blackout(int k, bool dark, pf_status_t status) {
    if (dark) out_.dark_end_frame = k + 1;
    if (out_.dark_end_frame > 0 && !dark && out_.tracked_again_frame < 0 && status == PF_OK)
      out_.tracked_again_frame = k;
  }

  /// A new map up to scale begins with this frame's camera; one that goes on in metres, or begins at rest, stays where it is.
  bool begins_anew(std::uint32_t map_id) const {
    pf_inertial_t unit;
    return o_.use_imu && map_id_ != 0 && map_id != map_id_ && pf_get_inertial(context_.slam, &unit) == PF_OK &&
           unit.metric == 0;
  }

  void note_doubt(double t, const pf_pose_t& pose) {
    pf_imu_report_t imu;
    if (pf_get_imu_report(context_.slam, &imu) != PF_OK) return;
    if (imu.rejected != 0 && out_.doubted_at_s < 0) out_.doubted_at_s = t;
    out_.doubted_s = imu.rejected_s;
    if (pose.map_id != map_id_) out_.maps += map_id_ != 0;
    map_id_ = pose.map_id;
  }

  /// Biases and gravity against the truth; true once lengths are in metres.
  bool note_unit(int k, const pf_report_t& report) {
    pf_inertial_t unit;
    if (pf_get_inertial(context_.slam, &unit) != PF_OK || unit.metric == 0) return false;
    if (out_.metric_frame < 0) {
      out_.metric_frame = k;
      out_.start_scale_sigma = unit.sigma.log_scale;
    }
    out_.resting_frames += unit.resting != 0;
    const Vec3 g = (first_.R_WC.transposed() * o_.imu.gravity_W).unit();
    const Vec3 estimate = Vec3{unit.gravity_W[0], unit.gravity_W[1], unit.gravity_W[2]}.unit();
    const Vec3 turn = estimate.cross(g);
    out_.tilt_rad = std::atan2(turn.norm(), estimate.dot(g));
    tilt_squares_ += out_.tilt_rad * out_.tilt_rad;
    out_.tilt_rms_rad = std::sqrt(tilt_squares_ / (out_.unit_frames + 1));
    double e[8];
    for (int i = 0; i < 2; ++i)
      e[i] = turn.dot({unit.gravity_axes_W[i][0], unit.gravity_axes_W[i][1], unit.gravity_axes_W[i][2]});
    const Vec3 g_bias = sensor_.gyro_bias(), a_bias = sensor_.accel_bias();
    const double truth[6] = {g_bias.x, g_bias.y, g_bias.z, a_bias.x, a_bias.y, a_bias.z};
    for (int i = 0; i < 3; ++i) {
      e[2 + i] = truth[i] - unit.gyro_bias[i];
      e[5 + i] = truth[3 + i] - unit.accel_bias[i];
    }
    for (int i = 2; i < 8; ++i)
      out_.worst_bias_sigmas = std::max(out_.worst_bias_sigmas, std::fabs(e[i]) / std::sqrt(unit.covariance[9 * i]));
    ++out_.unit_frames;
    out_.nees_gravity += normalised_error(e, unit.covariance, 2, 8, 0);
    out_.nees_gyro_bias += normalised_error(e + 2, unit.covariance, 3, 8, 2);
    out_.nees_accel_bias += normalised_error(e + 5, unit.covariance, 3, 8, 5);
    if (k % kGaugeEvery == 0) note_gauge(report.state_dim);
    return true;
  }

  /// The unit's axes where the gyroscope's have no rotation of their own: of a reading (1 + E) w half of E - E^T is one.
  pf::sim::Mat3 gyro_axes() const {
    const auto& e = unit_.gyro_error;
    return pf::sim::rotation_exp(Vec3{e[7] - e[5], e[2] - e[6], e[3] - e[1]} * 0.5);
  }

  /// Of the last frame.
  void note_mounting() {
    pf_inertial_t unit;
    if (pf_get_inertial(context_.slam, &unit) != PF_OK) return;
    const auto axes = o_.told_scale > 0 ? gyro_axes() : pf::sim::Mat3();
    const Vec3 turn = pf::sim::rotation_log(axes * unit_.R_BC * pf::sim::rotation_of(unit.q_BC).transposed());
    const Vec3 shift = axes * unit_.p_BC - Vec3{unit.p_BC[0], unit.p_BC[1], unit.p_BC[2]};
    const double delay = unit_.delay_s - unit.delay_s;
    if (o_.told_mount_rad > 0) out_.mount_error_rad = turn.norm();
    if (o_.told_mount_m > 0) out_.mount_error_m = shift.norm();
    if (o_.told_delay_s > 0) out_.delay_error_s = std::fabs(delay);
    const double e[7] = {turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, delay};
    const auto& s = unit.sigma;
    const double sigma[7] = {s.mount_rad[0], s.mount_rad[1], s.mount_rad[2], s.mount_m[0],
                             s.mount_m[1],   s.mount_m[2],   s.delay_s};
    for (int i = 0; i < 7; ++i)
      if (sigma[i] > 0) out_.mount_sigmas = std::max(out_.mount_sigmas, std::fabs(e[i]) / sigma[i]);
  }

  void note_readout() {
    pf_inertial_t unit;
    if (o_.sigma_readout_s <= 0 || pf_get_inertial(context_.slam, &unit) != PF_OK) return;
    out_.readout_error_s = std::fabs(unit.readout_s - o_.readout_s);
    out_.readout_sigmas = out_.readout_error_s / unit.sigma.readout_s;
  }

  void note_wander(const pf_pose_t& pose) {
    const Pose now{pf::sim::rotation_of(pose.q_WC), {pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]}};
    if (!has_rested_) rested_ = now;
    has_rested_ = true;
    out_.wander_m = std::max(out_.wander_m, (now.p_WC - rested_.p_WC).norm());
    out_.wander_rad = std::max(out_.wander_rad, pf::sim::rotation_log(rested_.R_WC.transposed() * now.R_WC).norm());
  }

  void note_gauge(int state_dim) {
    const auto n = static_cast<std::size_t>(state_dim);
    scratch_.resize(std::max(scratch_.size(), n * (n + 8)));
    double now[49];
    if (pf_get_gauge_information(context_.slam, scratch_.data(), scratch_.size(), now) != PF_OK) return;
    if (has_gauge_)
      out_.gauge_growth = std::max(out_.gauge_growth, largest_ratio(gauge_, now, 6, 7) - 1);
    else
      std::copy(now, now + 49, gauge_);
    has_gauge_ = true;
  }

  /// Relative error of the distances from the camera to the points that have a place, those on planes too; the median.
  double scale_error() const {
    if (o_.rendered && !o_.moving)
      return squares_ > 0 ? std::fabs(along_ / squares_ - 1) : -1;  // of the way, since it knows no points
    std::vector<pf_feature_t> features(1000);
    std::size_t count = 0;
    pf_get_features(context_.slam, features.data(), features.size(), &count);
    pf_pose_t pose;
    if (pf_get_pose(context_.slam, &pose) != PF_OK) return -1;
    const Vec3 p{pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]};
    std::vector<double> errors;
    features.resize(std::min(count, features.size()));
    if (o_.rendered) {
      const auto R_CW = pf::sim::rotation_of(pose.q_WC).transposed();
      std::vector<Vec3> p_C;
      for (const pf_feature_t& f : features)
        if (f.kind != PF_FEATURE_INVERSE_DEPTH) p_C.push_back(R_CW * (Vec3{f.p_W[0], f.p_W[1], f.p_W[2]} - p));
      const Pose here{first_.R_WC * last_.R_WC, first_.R_WC * last_.p_WC + first_.p_WC};
      const std::vector<double> truth = world_.distances(here, p_C);
      for (std::size_t i = 0; i < p_C.size(); ++i)
        if (p_C[i].z > 0 && truth[i] > 0) errors.push_back(p_C[i].norm() / truth[i] - 1);
      return errors.size() < 5 ? -1 : std::fabs(median(errors));
    }
    for (const pf_feature_t& f : features) {
      if (f.kind == PF_FEATURE_INVERSE_DEPTH) continue;
      const Vec3 point = first_.R_WC.transposed() * (world_.points()[f.external_id] - first_.p_WC);
      errors.push_back((Vec3{f.p_W[0], f.p_W[1], f.p_W[2]} - p).norm() / (point - last_.p_WC).norm() - 1);
    }
    return errors.size() < 5 ? -1 : std::fabs(median(errors));
  }

  const VioOptions& o_;
  const std::uint64_t seed_;
  FrameRow* const rows_;
  VioSummary& out_;
  const VioWorld world_;
  Random noise_;
  const pf::sim::ImuOptions unit_;
  pf::sim::ImuSensor sensor_;
  const Context context_;
  Pose first_;  ///< W of the library's map
  VioPlaneWatch planes_;
  double tilt_squares_ = 0;
  Pose last_;
  std::vector<double> scratch_;
  std::vector<std::uint8_t> grey_;
  std::int64_t counted_ = 0;        ///< samples, towards the next one that comes too late
  double along_ = 0, squares_ = 0;  ///< of positions, the estimated ones along the true ones
  Pose rested_;                     ///< the first one in metres
  bool has_rested_ = false;
  double gauge_[49] = {};
  bool has_gauge_ = false;
  std::uint32_t map_id_ = 0;
};

}  // namespace

const char* name_of(VioFault fault) {
  constexpr const char* kNames[] = {"none",   "gap",   "stop",       "late",        "repeated", "disorder", "saturated",
                                    "jitter", "scale", "clock-jump", "frames-stop", "reversed", "mount"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(VioFault::kCount));
  return kNames[static_cast<int>(fault)];
}

bool is_poor(const VioOptions& options, std::uint64_t seed) {
  return options.moving && !options.rendered && seed % kPoorEvery == 0;
}

int vio_frames(const VioOptions& options) { return static_cast<int>(options.seconds * options.rate_hz); }

VioSummary run_vio(const VioOptions& options, std::uint64_t seed, FrameRow* rows) {
  VioSummary summary;
  Run(options, seed, rows, &summary).go();
  return summary;
}

}  // namespace pfsim
