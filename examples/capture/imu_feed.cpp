#include "imu_feed.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace pf::capture {

namespace {

constexpr int32_t kKept = 256;  ///< samples that the library keeps: a quarter of a second of a fast unit

constexpr int64_t kPatience = 30;  ///< frames without any sample before them: worth a note

double rounded(double value) { return std::round(value * 1e6) / 1e6; }

}  // namespace

bool ImuFeed::open(const Options& options, const std::string& beside, std::string& error) {
  error.clear();
  imu_ = open_imu(options, beside, error);
  offset_s_ = options.imu_offset_s;
  return error.empty();
}

void ImuFeed::configure(pf_config_t& config) const {
  if (imu_ != nullptr) {
    config.imu_buffer = kKept;
    config.imu_gyro_range = imu_->gyro_range();
    config.imu_accel_range = imu_->accel_range();
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
    notices_.push_back(imu_->name() + ": no sample before any of " + std::to_string(kPatience) +
                       " frames; are its times on the camera's clock? (--imu-offset)");
  }
  // One at a time: what is wrong with one of them is no reason to do without the others.
  for (const pf_imu_sample_t& sample : samples_) {
    const pf_status_t status = pf_push_imu(slam, &sample, 1);
    if (status >= 0) {
      recorder_.add(sample);
    } else if (refused_++ == 0) {
      notices_.push_back(imu_->name() + ": the library refused a sample: " + pf_status_text(status));
    }
  }
}

bool ImuFeed::take_notice(std::string& notice) {
  if (!notices_.empty()) {
    notice = notices_.front();
    notices_.erase(notices_.begin());
    return true;
  }
  return imu_ != nullptr && imu_->take_notice(notice);
}

std::string ImuFeed::report(const pf_slam_t* slam) const {
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
       {{"usual", rounded(1e3 * r.usual_s)}, {"max", rounded(1e-6 * static_cast<double>(r.longest_ns))}}},
      {"gaps", r.gaps},
      {"missing", r.missing},
      {"saturated", r.saturated},
      {"late", r.late},
      {"refused", refused_},
      {"offset_s", offset_s_}};
  if (!(imu_->gyro_range() > 0.0) && !(imu_->accel_range() > 0.0)) {
    json["saturated"] = nullptr;  // the ranges are not known
  }
  const std::string device = imu_->report();
  if (!device.empty()) {
    json["device"] = nlohmann::ordered_json::parse(device);
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace pf::capture
