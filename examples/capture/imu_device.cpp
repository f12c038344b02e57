#include <cstdio>

#include "imu.h"

#ifdef PLANEFOLD_HAVE_IIO
#include <planefold_platform/iio.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "notices.h"
#include "steady.h"
#endif

namespace pf::capture {

#ifdef PLANEFOLD_HAVE_IIO

namespace {

constexpr int kReadMs = 50;                ///< how long a stop may take to be noticed
constexpr int kWaitMs = 40;                ///< for samples that were measured before a frame and are still on their way
constexpr int kVain = 3;                   ///< waits for nothing, after which none is tried
constexpr int64_t kSilentNs = 2000000000;  ///< without a sample: worth a note
constexpr size_t kMostWaiting = 100000;    ///< samples, while nothing takes them

/// A unit that measures now. A thread of its own takes the samples, so that neither camera nor tracker holds them up.
class ImuDevice : public Imu {
 public:
  ImuDevice(pf_iio_t* imu, int64_t offset_ns) : imu_(imu, pf_iio_close), offset_ns_(offset_ns) {
    pf_iio_get_info(imu, &info_);
    const std::string gyro = info_.gyro.name;
    const std::string accel = info_.accel.name;
    name_ = "iio:" + (gyro == accel ? gyro : accel + "+" + gyro);
    gyro_range_ = info_.gyro_range;
    accel_range_ = info_.accel_range;
  }

  ~ImuDevice() override {
    stop_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  bool start(std::string& error) override {
    char message[PF_IIO_MESSAGE] = "";
    if (pf_iio_start(imu_.get(), message) != 0) {
      error = message;
      return false;
    }
    pf_iio_get_info(imu_.get(), &info_);
    thread_ = std::thread([this] { collect(); });
    return true;
  }

  void take(int64_t until_ns, std::vector<pf_imu_sample_t>& samples) override {
    std::unique_lock<std::mutex> lock(mutex_);
    // Where the clocks are not the same, a sample behind the frame never comes: no use in waiting for it at every frame.
    waited_in_vain_ = last_t_ns_ > last_until_ns_ ? 0 : waited_in_vain_;
    last_until_ns_ = until_ns;
    if (!ended_ && waited_in_vain_ < kVain) {
      const bool came =
          changed_.wait_for(lock, std::chrono::milliseconds(kWaitMs), [&] { return ended_ || last_t_ns_ > until_ns; });
      waited_in_vain_ += came ? 0 : 1;
    }
    while (!waiting_.empty() && waiting_.front().t_ns <= until_ns) {
      samples.push_back(waiting_.front());
      waiting_.pop_front();
    }
  }

  bool take_notice(std::string& notice) override { return notices_.take(notice); }

  std::string name() const override { return name_; }
  double gyro_range() const override { return gyro_range_; }
  double accel_range() const override { return accel_range_; }

  std::string report() const override {
    constexpr const char* kStamps[] = {"arrival", "monotonic", "converted"};
    const std::lock_guard<std::mutex> lock(mutex_);
    const nlohmann::ordered_json json = {
        {"gyro", info_.gyro.id},
        {"accel", info_.accel.id},
        {"gyro_rate_hz", info_.gyro_rate_hz},
        {"accel_rate_hz", info_.accel_rate_hz},
        {"gyro_range", info_.gyro_range},
        {"accel_range", info_.accel_range},
        {"gyro_mount", info_.gyro_mount},
        {"accel_mount", info_.accel_mount},
        {"timestamps", kStamps[info_.stamp <= PF_IIO_STAMP_CONVERTED ? info_.stamp : 0]},
        {"samples", info_.samples},
        {"dropped", info_.dropped + overflown_},
        {"departures", info_.departures}};
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }

 private:
  /// The thread.
  void collect() {
    int64_t last_ns = steady_ns();
    bool silent = false;
    while (!stop_) {
      pf_imu_sample_t samples[64];
      int count = 0;
      char message[PF_IIO_MESSAGE] = "";
      const int read = pf_iio_read(imu_.get(), kReadMs, samples, 64, &count, message);
      if (read == PF_IIO_SAMPLES) {
        last_ns = steady_ns();
        silent = false;
        deliver(samples, count);
      } else if (read == PF_IIO_NOTHING) {
        if (!silent && steady_ns() - last_ns > kSilentNs) {
          silent = true;
          notices_.add(name() + ": no sample for 2 s; the unit is there, but gives nothing");
        }
      } else if (read == PF_IIO_GONE) {
        wait_for_return(message);
        last_ns = steady_ns();
      } else {
        notices_.add(std::string(message) + "; going on without inertial samples");
        break;
      }
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }

  void deliver(const pf_imu_sample_t* samples, int count) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (int i = 0; i < count; ++i) {
      waiting_.push_back(samples[i]);
      waiting_.back().t_ns += offset_ns_;
    }
    for (; waiting_.size() > kMostWaiting; ++overflown_) {
      waiting_.pop_front();
    }
    last_t_ns_ = waiting_.back().t_ns;
    pf_iio_get_info(imu_.get(), &info_);
    changed_.notify_all();
  }

  void wait_for_return(const std::string& message) {
    const int64_t since_ns = steady_ns();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      pf_iio_get_info(imu_.get(), &info_);
      notices_.add(message + " Going on when it is back");
    }
    while (!stop_) {
      if (pf_iio_return(imu_.get(), nullptr) == 0) {
        char text[160];
        std::snprintf(text, sizeof(text), " is back after %.1f s", 1e-9 * static_cast<double>(steady_ns() - since_ns));
        notices_.add(name() + text);
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
  }

  std::unique_ptr<pf_iio_t, void (*)(pf_iio_t*)> imu_;
  const int64_t offset_ns_;
  std::string name_;
  double gyro_range_ = 0.0, accel_range_ = 0.0;
  std::thread thread_;
  std::atomic<bool> stop_{false};

  Notices notices_;
  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::deque<pf_imu_sample_t> waiting_;
  pf_iio_info_t info_{};
  int64_t last_t_ns_ = INT64_MIN, last_until_ns_ = INT64_MIN, overflown_ = 0;
  int waited_in_vain_ = 0;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<Imu> open_imu_device(const std::string& name, double rate_hz, int64_t offset_ns, std::string& error) {
  char message[PF_IIO_MESSAGE] = "";
  pf_iio_t* opened = nullptr;
  if (pf_iio_open(name.c_str(), rate_hz, &opened, message) != 0) {
    error = message;
    return nullptr;
  }
  return std::make_unique<ImuDevice>(opened, offset_ns);
}

int list_imus(int code) {
  pf_iio_device_t devices[32];
  const int count = pf_iio_list(devices, 32);
  bool refused = false;
  for (int i = 0; i < count && i < 32; ++i) {
    const pf_iio_device_t& device = devices[i];
    refused = refused || device.refused != 0;
    std::printf("imu     iio:%-15s %s%s%s (%s)%s%s\n", device.name, device.accel != 0 ? "accelerometer" : "",
                device.accel != 0 && device.gyro != 0 ? " and " : "", device.gyro != 0 ? "gyroscope" : "", device.id,
                device.buffered != 0 ? "" : "  has no buffer, which is needed",
                device.refused != 0 ? "  this user may not open it" : "");
  }
  if (count == 0) {
    std::printf("no imu\n");
  }
  if (refused) {
    std::fprintf(stderr, "pf-capture: note: %s\n", pf_iio_permission_hint());
  }
  return code;
}

#else

std::unique_ptr<Imu> open_imu_device(const std::string& name, double, int64_t, std::string& error) {
  error = "--imu iio:" + name + ": this build has no libiio (Debian: libiio-dev)";
  return nullptr;
}

int list_imus(int code) {
  std::printf("no imu: this build has no libiio\n");
  return code;
}

#endif

}  // namespace pf::capture
