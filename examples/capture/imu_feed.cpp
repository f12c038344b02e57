#include "imu_feed.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace pf::capture {

namespace {

constexpr int32_t kKept = 256;  ///< samples that the library keeps: a quarter of a second of a fast unit

constexpr int64_t kPatience = 30;  ///< frames without any sample before them: worth a note

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

bool ImuFeed::open(const Options& options, const std::string& beside, std::string& error) {
  error.clear();
  imu_ = open_imu(options, beside, error);
  offset_s_ = options.imu_offset_s;
  return error.empty();
}

void ImuFeed::configure(pf_config_t& config) const {
  if (imu_ != nullptr) {
    config.capacity.max_imu_samples = kKept;
    config.imu.gyro_range = imu_->gyro_range();
    config.imu.accel_range = imu_->accel_range();
  }
}

bool ImuFeed::record_to(const std::string& folder, std::string& error) {
  return imu_ == nullptr || recorder_.open(folder, error);
}

void ImuFeed::push_until(int64_t t_ns, pf_slam_t* slam) {
  if (imu_ == nullptr) {
    return;
  }
  samples_.clear();
  imu_->take(t_ns, samples_);
  pushed_ += static_cast<int64_t>(samples_.size());
  if (++frames_ == kPatience && pushed_ == 0) {
    notices_.add(imu_->name() + ": no sample before any of " + std::to_string(kPatience) +
                 " frames; are its times on the camera's clock? (--imu-offset)");
  }
  // One at a time: what is wrong with one of them is no reason to do without the others.
  for (const pf_imu_sample_t& sample : samples_) {
    const pf_status_t status = pf_push_imu(slam, &sample, 1);
    if (status >= 0) {
      recorder_.add(sample);
      offset_.add(sample);
    } else if (refused_++ == 0) {
      notices_.add(imu_->name() + ": the library refused a sample: " + pf_status_text(status));
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
  const TimeOffset offset = offset_.estimate();
  json["time_offset"] = time_offset_json(offset, offset_s_);
  advice = time_offset_advice(offset, offset_s_);
  const std::string device = imu_->report();
  if (!device.empty()) {
    json["device"] = nlohmann::ordered_json::parse(device);
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace pf::capture
