#ifndef PLANEFOLD_CAPTURE_CAMERA_DEVICE_H
#define PLANEFOLD_CAPTURE_CAMERA_DEVICE_H

#include <planefold_platform/cameras.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "camera.h"

namespace pf::capture {

/// A camera behind one of the two C interfaces. Api is a type of cameras.h, and
///   id(info)        what the user calls the camera by
///   describe(info)  JSON of what only this interface says
///   kStamps         names of its kinds of timestamps
template <class Api>
class DeviceCamera : public Camera {
 public:
  explicit DeviceCamera(platform::OpenCamera<Api> camera) : camera_(std::move(camera)) {}

  bool start(std::string& error) override {
    char message[Api::kMessage] = "";
    const bool done = Api::start(camera_.get(), message) == 0;
    error = message;
    return done;
  }

  CameraRead next(int timeout_ms, CameraFrame& frame, std::string& message) override {
    char text[Api::kMessage] = "";
    typename Api::Frame taken{};
    const int read = Api::read(camera_.get(), timeout_ms, &taken, text);
    if (read == Api::kNothing) {
      return CameraRead::kNothing;
    }
    if (read != Api::kFrame) {
      message = text;
      return read == Api::kGone ? CameraRead::kGone : CameraRead::kFailed;
    }
    frame = CameraFrame{};
    frame.image = taken.image;
    frame.arrived_ns = taken.arrived_ns;
    frame.number = number_++;
    frame.handle = taken.buffer;
    return CameraRead::kFrame;
  }

  void release(const CameraFrame& frame) override {
    typename Api::Frame taken{};
    taken.buffer = frame.handle;
    Api::release(camera_.get(), &taken);
  }

  bool come_back() override { return Api::come_back(camera_.get(), nullptr) == 0; }

  std::string name() const override { return Api::id(info()); }

  std::string report() const override {
    const typename Api::Info i = info();
    const size_t stamp = i.stamp < std::size(Api::kStamps) ? i.stamp : 0;
    nlohmann::ordered_json json = {{"device", Api::id(i)}};
    json.update(Api::describe(i));
    json.update({{"rate_hz", i.rate_hz},
                 {"exposure_s", i.exposure_s},
                 {"buffers", i.buffers},
                 {"timestamps", Api::kStamps[stamp]},
                 {"direct", i.direct != 0},
                 {"frames", i.frames},
                 {"lost", i.lost},
                 {"damaged", i.damaged},
                 {"departures", i.departures}});
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }

  typename Api::Info info() const {
    typename Api::Info info{};
    Api::get_info(camera_.get(), &info);
    return info;
  }

 private:
  platform::OpenCamera<Api> camera_;
  int64_t number_ = 0;
};

/// What every interface can be asked for.
template <class Api>
typename Api::Options device_options(const Options& options, const pf_camera_t& camera, double rate_hz) {
  typename Api::Options wanted{};
  Api::options_default(&wanted);
  wanted.width = camera.width;
  wanted.height = camera.height;
  wanted.rate_hz = options.rate_hz > 0.0 ? options.rate_hz : rate_hz;
  wanted.exposure_s = 1e-6 * options.exposure_us;
  wanted.lock_focus = options.focus >= -1 ? 1 : 0;
  for (uint32_t f = 0; f < Api::kFormats; ++f) {
    wanted.format = options.format == Api::format_name(f) ? f : wanted.format;
  }
  return wanted;
}

/// null: error is one line.
template <class Api>
std::unique_ptr<DeviceCamera<Api>> open_device(const Options& options, const typename Api::Options& wanted,
                                               std::string& error) {
  auto camera = platform::open_camera<Api>(options.source, wanted, error);
  return camera == nullptr ? nullptr : std::make_unique<DeviceCamera<Api>>(std::move(camera));
}

/// formats: bit 1 << f for each that a camera has.
template <class Api>
std::string format_names(uint32_t formats) {
  std::string names;
  for (uint32_t f = 1; f < Api::kFormats; ++f) {
    if ((formats & (1u << f)) != 0) {
      names += std::string(names.empty() ? "" : " ") + Api::format_name(f);
    }
  }
  return names.empty() ? "no format that is known here" : names;
}

}  // namespace pf::capture

#endif
