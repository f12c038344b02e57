#include "imu_feed.h"

#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "imu_reason.h"
#include "source.h"

namespace pf::capture {

namespace {

constexpr int32_t kKept = 256;         ///< samples that the library keeps: a quarter of a second of a fast unit
constexpr int32_t kKeptToMove = 2000;  ///< likewise where poses depend on them: two seconds

constexpr double kSigmaMountRad = 0.035;  ///< of --estimate mount: 2 degrees
constexpr double kSigmaMountM = 0.02;
constexpr double kSigmaDelayS = 0.01;    ///< of --estimate delay
constexpr double kSigmaReadoutS = 0.01;  ///< of --estimate readout
// Of what is not told.
constexpr double kUsualMountRad = 0.052, kUsualMountM = 0.03;  ///< 3 degrees
constexpr double kAnyMountRad = 3.0, kAnyMountM = 0.1;
constexpr double kUsualDelayS = 0.06;
constexpr double kUsualReadoutS = 0.015;
constexpr double kUsualScale = 0.01;  ///< sensitivity and cross-axis errors, as data sheets of phones' units state them
constexpr double kAheadSigmas = 3.0, kLiveAheadS = 0.03;

constexpr double kRadians = 3.14159265358979 / 180.0;
constexpr size_t kPlanes = 64;  ///< the largest capacity.max_planes

constexpr int64_t kPatience = 30;  ///< frames without any sample between them: worth a note

double rounded(double value) { return std::round(value * 1e6) / 1e6; }

/// given_s: what was added to the unit's times already.
nlohmann::ordered_json time_offset_json(const TimeOffset& offset, double given_s) {
  nlohmann::ordered_json json;
  json["offset_s"] = offset.known ? nlohmann::ordered_json(rounded(given_s + offset.offset_s)) : nullptr;
  json["sigma_s"] = offset.known ? nlohmann::ordered_json(rounded(offset.sigma_s)) : nullptr;
  json["correlation"] = rounded(offset.correlation);
  json["intervals"] = offset.intervals;
  json["turning_rad_s"] = rounded(offset.turning);
  if (!offset.known) {
    json["why_not"] = offset.why_not;
  }
  return json;
}

/// Gravity and biases as they are known at the last frame, each with its standard deviations.
void add_inertial(const pf_slam_t* slam, int64_t metric_frame, bool moving, const pf_imu_model_t& model,
                  nlohmann::ordered_json& json) {
  pf_inertial_t known{};
  const bool known_at_all = pf_get_inertial(slam, &known) == PF_OK, any = known_at_all && known.metric != 0;
  json["start"] = metric_frame < 0 ? "none" : moving ? "moving" : "rest";
  json["start_frame"] = metric_frame >= 0 ? nlohmann::ordered_json(metric_frame) : nullptr;
  json["metric"] = any;
  const auto with_sigma = [&](const double* values, int count, int first, int sigmas) {
    nlohmann::ordered_json part = {{"value", nlohmann::ordered_json::array()},
                                   {"sigma", nlohmann::ordered_json::array()}};
    for (int i = 0; i < count; ++i) {
      part["value"].push_back(rounded(values[i]));
    }
    for (int i = first; i < first + sigmas; ++i) {
      part["sigma"].push_back(rounded(std::sqrt(known.covariance[9 * i])));
    }
    return any ? part : nlohmann::ordered_json();
  };
  json["gravity_W"] = with_sigma(known.gravity_W, 3, 0, 2);  // of its direction, about two axes [rad]
  json["gyro_bias"] = with_sigma(known.gyro_bias, 3, 2, 3);
  json["accel_bias"] = with_sigma(known.accel_bias, 3, 5, 3);
  const auto estimated = [&](double sigma) { return known_at_all && sigma >= 0.0; };
  const auto three_sigmas = [&](const double(&of)[3]) {
    nlohmann::ordered_json sigmas;
    for (int i = 0; i < 3 && estimated(of[0]); ++i) {
      sigmas.push_back(rounded(of[i]));
    }
    return sigmas;
  };
  const auto all_rounded = [](const auto& values) {
    nlohmann::ordered_json numbers;
    for (const double value : values) {
      numbers.push_back(rounded(value));
    }
    return numbers;
  };
  const auto& sigma = known.sigma;
  if (estimated(sigma.mount_rad[0])) {
    json["mount"] = {{"q_BC", all_rounded(known.q_BC)},
                     {"p_BC", all_rounded(known.p_BC)},
                     {"sigma_rad", three_sigmas(sigma.mount_rad)},
                     {"sigma_m", three_sigmas(sigma.mount_m)}};
  } else {
    json["mount"] = {{"q_BC", model.q_BC}, {"p_BC", model.p_BC}};
  }
  json["scale_sigma"] = any && sigma.log_scale >= 0.0 ? nlohmann::ordered_json(rounded(sigma.log_scale)) : nullptr;
  if (estimated(sigma.scale)) {
    json["gyro_matrix"] = all_rounded(known.gyro_matrix);
    json["accel_matrix"] = all_rounded(known.accel_matrix);
    json["matrix_sigma"] = rounded(sigma.scale);
  }
  json["delay_s"] = rounded(estimated(sigma.delay_s) ? known.delay_s : model.delay_s);
  if (estimated(sigma.delay_s)) {
    json["delay_sigma_s"] = rounded(sigma.delay_s);
  }
  if (estimated(sigma.readout_s)) {
    json["readout_s"] = rounded(known.readout_s);
    json["readout_sigma_s"] = rounded(sigma.readout_s);
  }
}

std::string time_offset_advice(const TimeOffset& offset, double given_s) {
  if (!offset.known) {
    return "time offset of the inertial unit: not known; " + offset.why_not;
  }
  char text[200];
  std::snprintf(text, sizeof(text),
                "time offset of the inertial unit: %.1f ms, sigma %.1f ms, correlation %.3f (--imu-offset %.4f)",
                1e3 * (given_s + offset.offset_s), 1e3 * offset.sigma_s, offset.correlation, given_s + offset.offset_s);
  return text;
}

}  // namespace

bool ImuFeed::open(const Options& options, const Source& source, const std::string& beside, std::string& error,
                   int& code) {
  error.clear();
  imu_ = open_imu(options, source, beside, error);
  offset_s_ = options.imu_offset_s;
  vertical_rad_ = options.vertical_deg * kRadians;
  if (error.empty() && imu_ == nullptr && offset_s_ != 0.0) {
    error = "--imu-offset: there are no inertial samples beside these frames; add --imu, or leave it away";
  }
  if (!error.empty() && options.imu.rfind("iio:", 0) != 0) {
    code = kExitUsage;
  }
  if (!error.empty() || !options.inertial) {
    return error.empty();
  }
  if (imu_ != nullptr && imu_->model() != nullptr) {
    model_ = *imu_->model();
    inertial_ = true;
  } else if (!options.imu_noise.empty()) {
    char message[PF_SEQUENCE_MESSAGE] = "";
    if (imu_ == nullptr) {
      error = "--imu-noise: there are no inertial samples beside these frames; add --imu";
    } else if (pf_read_imu_noise(options.imu_noise.c_str(), &model_, message) != 0) {
      error = std::string("--imu-noise ") + message;
    } else {
      if (message[0] != '\0') {
        notices_.add(message);
      }
      const std::string& camera = options.camera.empty() ? source.info().camera_name : options.camera;
      if (options.imu_mount.empty()) {
        open_axes_ = true;
        model_.q_BC[0] = 1.0;
        notices_.add("no --imu-mount: the unit's axes are found from the first seconds of handling");
      } else if (pf_read_imu_mount_of(options.imu_mount.c_str(), camera.c_str(), &model_, message) != 0) {
        error = std::string("--imu-mount ") + message;
      } else if (message[0] != '\0') {
        notices_.add(message);
      }
    }
    inertial_ = error.empty();
    code = inertial_ ? code : kExitUsage;
    live_ = options.imu.rfind("iio:", 0) == 0;
  } else if (imu_ != nullptr) {
    notices_.add(
        imu_->name() +
        ": its noise is not known, so poses do not depend on it; add --imu-noise FILE and --imu-mount FILE, or "
        "--no-inertial");
  }
  choose_sigmas(options);
  return error.empty();
}

/// Exact where --imu-exact says so, near what is given where --estimate does, and else as people know it. Of a scene's own unit all is
/// known.
void ImuFeed::choose_sigmas(const Options& options) {
  const auto has = [](const std::vector<std::string>& list, const char* what) {
    return std::find(list.begin(), list.end(), what) != list.end();
  };
  const bool near_only = !options.estimate.empty() || (imu_ != nullptr && imu_->model() != nullptr);
  const auto sigma = [&](const char* what, double near, double usual) {
    return has(options.estimate, what) ? near : near_only || has(options.imu_exact, what) ? 0.0 : usual;
  };
  model_.sigma_mount_rad = sigma("mount", kSigmaMountRad, open_axes_ ? kAnyMountRad : kUsualMountRad);
  model_.sigma_mount_m = sigma("mount", kSigmaMountM, open_axes_ ? kAnyMountM : kUsualMountM);
  model_.sigma_delay_s = sigma("delay", kSigmaDelayS, kUsualDelayS);
  model_.sigma_scale = sigma("scale", kUsualScale, kUsualScale);
  model_.sigma_readout_s = has(options.estimate, "readout") ? kSigmaReadoutS : 0.0;
  sigma_delay_s_ = inertial_ ? model_.sigma_delay_s : 0.0;
  tries_readout_ = !near_only && options.imu_exact.empty();
  readout_given_ = options.readout_s >= 0.0;
}

void ImuFeed::configure(pf_config_t& config) const {
  if (imu_ == nullptr) {
    return;
  }
  if (inertial_) {
    config.motion.model = PF_MOTION_INERTIAL;
    const double gravity = config.imu.gravity;
    config.imu = model_;
    config.imu.gravity = model_.gravity > 0.0 ? model_.gravity : gravity;
    config.imu.sigma_readout_s =
        tries_readout_ && !(config.camera.readout_s > 0.0) && !readout_given_ ? kUsualReadoutS : model_.sigma_readout_s;
  }
  config.capacity.max_imu_samples = inertial_ ? kKeptToMove : kKept;
  config.imu.gyro_range = imu_->gyro_range();
  config.imu.accel_range = imu_->accel_range();
}

void ImuFeed::add_frame(int64_t index, const pf_slam_t* slam, const pf_pose_t& pose, bool tracked) {
  offset_.add_frame(pose, tracked);
  pf_inertial_t known{};
  if (inertial_ && metric_frame_ < 0 && pf_get_inertial(slam, &known) == PF_OK && known.metric != 0) {
    metric_frame_ = index;
    metric_at_s_ = 1e-9 * static_cast<double>(pose.t_ns) - first_s_;
    moving_ = known.from_motion != 0;
  }
  if (inertial_ && open_axes_) {
    note_axes(slam);
  }
}

/// Says once which way the unit lies, as soon as that is found.
void ImuFeed::note_axes(const pf_slam_t* slam) {
  pf_inertial_t known{};
  constexpr double kFound = 0.1;  // [rad]
  if (pf_get_inertial(slam, &known) != PF_OK || !(known.sigma.mount_rad[0] > 0.0) ||
      *std::max_element(known.sigma.mount_rad, known.sigma.mount_rad + 3) > kFound) {
    return;
  }
  open_axes_ = false;
  notices_.add("the inertial unit's axes are found: " + axes_in_words(known.q_BC));
}

bool ImuFeed::record_to(const std::string& folder, std::string& error) {
  return imu_ == nullptr || recorder_.open(folder, error);
}

/// Once a plane, as soon as its class is known.
void ImuFeed::tell_vertical(pf_slam_t* slam) {
  pf_plane_t planes[kPlanes];
  size_t count = 0;
  if (pf_get_planes(slam, planes, kPlanes, &count) < PF_OK) {
    return;
  }
  for (size_t i = 0; i < std::min(count, kPlanes); ++i) {
    if (planes[i].orientation == PF_ORIENTATION_VERTICAL && looked_at_.insert(planes[i].id).second) {
      vertical_ += pf_set_plane_vertical(slam, planes[i].id, vertical_rad_) == PF_OK ? 1 : 0;
    }
  }
}

void ImuFeed::push_until(int64_t t_ns, pf_slam_t* slam) {
  if (imu_ == nullptr) {
    return;
  }
  if (inertial_ && vertical_rad_ > 0.0) {
    tell_vertical(slam);
  }
  samples_.clear();
  if (frames_ == 0) {
    first_s_ = 1e-9 * static_cast<double>(t_ns);
    imu_->begin_at(t_ns);
  }
  // Where the delay is not known, a frame hangs on samples that may be as much later.
  const double ahead_s = kAheadSigmas * sigma_delay_s_;
  const auto ahead_ns = static_cast<int64_t>(1e9 * (live_ ? std::min(ahead_s, kLiveAheadS) : ahead_s));
  imu_->take(std::min(t_ns, std::numeric_limits<int64_t>::max() - ahead_ns) + ahead_ns, samples_);
  // All that came before the first frame tells nothing: they may be of another clock altogether.
  between_ += frames_ > 0 ? static_cast<int64_t>(samples_.size()) : 0;
  if (++frames_ == kPatience && between_ == 0) {
    notices_.add(imu_->name() + ": no sample between the first " + std::to_string(kPatience) +
                 " frames; are its times in the right unit, and on the camera's clock? (--imu-offset)");
  }
  // One at a time: what is wrong with one of them is no reason to do without the others.
  for (const pf_imu_sample_t& sample : samples_) {
    const pf_status_t status = pf_push_imu(slam, &sample, 1);
    if (status >= 0) {
      recorder_.add(sample);
      offset_.add(sample);
    } else if (refused_++ == 0) {
      notices_.add(imu_->name() + ": the library rejected a sample: " + pf_status_text(status));
    }
  }
  recorder_.write(failure_);
}

bool ImuFeed::take_notice(std::string& notice) {
  return notices_.take(notice) || (imu_ != nullptr && imu_->take_notice(notice));
}

std::string ImuFeed::report(const pf_slam_t* slam, std::string& advice) const {
  pf_imu_report_t r{};
  if (imu_ == nullptr || pf_get_imu_report(slam, &r) != PF_OK) {
    return "";
  }
  nlohmann::ordered_json json = {
      {"source", imu_->name()},
      {"used", r.used != 0},
      {"samples", r.samples},
      {"rate_hz", rounded(r.rate_hz)},
      {"interval_ms",
       {{"usual", rounded(1e3 * r.median_s)}, {"max", rounded(1e-6 * static_cast<double>(r.longest_ns))}}},
      {"gaps", r.gaps},
      {"missing", r.missing},
      {"saturated", r.saturated},
      {"late", r.late},
      {"refused", refused_},
      {"offset_s", offset_s_}};
  if (!(imu_->gyro_range() > 0.0) && !(imu_->accel_range() > 0.0)) {
    json["saturated"] = nullptr;  // the ranges are not known
  }
  if (inertial_) {
    json["rejected"] = r.rejected != 0;
    json["rejected_s"] = rounded(r.rejected_s);
    json["doubted"] = json["rejected"];  // the names until 0.2
    json["doubted_s"] = json["rejected_s"];
    json["reason"] = reason_name(r.reason);
    json["reason_text"] = reason_in_words(r);
    json["gyro_density"] = r.gyro_density;
    json["accel_density"] = r.accel_density;
    json["metric_at_s"] = metric_frame_ >= 0 ? nlohmann::ordered_json(rounded(metric_at_s_)) : nullptr;
    json["vertical_planes"] = vertical_;
    add_inertial(slam, metric_frame_, moving_, model_, json);
  }
  const TimeOffset offset = offset_.estimate();
  json["time_offset"] = time_offset_json(offset, offset_s_);
  advice = time_offset_advice(offset, offset_s_);
  const std::string device = imu_->report();
  if (!device.empty()) {
    json["device"] = nlohmann::ordered_json::parse(device);
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void ImuFeed::add_rejections(const pf_slam_t* slam, std::vector<Rejection>& rejections) const {
  const TimeOffset offset = offset_.estimate();
  pf_inertial_t known{};
  const bool estimated = pf_get_inertial(slam, &known) == PF_OK && known.sigma.delay_s >= 0.0;
  add_rejected_unit(slam,
                    {inertial_, offset.offset_s, offset.known ? offset.sigma_s : 0.0,
                     estimated ? known.delay_s : model_.delay_s, offset_s_},
                    rejections);
}

}  // namespace pf::capture
