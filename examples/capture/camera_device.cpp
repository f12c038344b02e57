#include <planefold_platform/cameras.h>

#include <nlohmann/json.hpp>

#include "camera.h"

namespace pf::capture {

namespace {

/// A camera of this machine.
class DeviceCamera : public Camera {
 public:
  explicit DeviceCamera(platform::CameraSource camera) : camera_(std::move(camera)) {}

  bool start(std::string& error) override { return camera_.start(error); }

  CameraRead next(int timeout_ms, CameraFrame& frame, std::string& message) override {
    pf_camera_source_frame_t taken{};
    const int read = camera_.read(timeout_ms, taken, message);
    if (read != PF_CAMERA_SOURCE_FRAME) {
      return read == PF_CAMERA_SOURCE_NOTHING ? CameraRead::kNothing
             : read == PF_CAMERA_SOURCE_GONE  ? CameraRead::kGone
                                              : CameraRead::kFailed;
    }
    frame = CameraFrame{};
    frame.image = taken.image;
    frame.arrived_ns = taken.arrived_ns;
    frame.number = number_++;
    frame.handle = taken.buffer;
    return CameraRead::kFrame;
  }

  void release(const CameraFrame& frame) override {
    pf_camera_source_frame_t taken{};
    taken.buffer = frame.handle;
    camera_.release(taken);
  }

  bool come_back() override { return camera_.come_back(); }

  std::string name() const override { return camera_.info().id; }

  std::string report() const override {
    const pf_camera_source_info_t info = camera_.info();
    nlohmann::ordered_json json = {{"device", info.id}, {"name", info.name}, {"format", info.format}};
    if (info.version[0] != '\0') {
      json[info.interface] = info.version;
    }
    if (info.read_slowness > 0.0) {
      json["read_slowness"] = info.read_slowness;
    }
    json.update({{"rate_hz", info.rate_hz},
                 {"exposure_s", info.exposure_s},
                 {"buffers", info.buffers},
                 {"timestamps", info.timestamps},
                 {"direct", info.direct != 0},
                 {"frames", info.frames},
                 {"lost", info.lost},
                 {"damaged", info.damaged},
                 {"restarts", info.restarts},
                 {"departures", info.departures}});
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }

 private:
  platform::CameraSource camera_;
  int64_t number_ = 0;
};

}  // namespace

std::unique_ptr<Camera> open_device_camera(const Options& options, const pf_camera_t& camera, double& rate_hz,
                                           std::string& error) {
  pf_camera_source_options_t wanted{};
  pf_camera_source_options_default(&wanted);
  wanted.width = camera.width;
  wanted.height = camera.height;
  wanted.format = options.format.c_str();
  wanted.rate_hz = options.rate_hz > 0.0 ? options.rate_hz : rate_hz;
  wanted.exposure_s = 1e-6 * options.exposure_us;
  wanted.lock_focus = options.focus >= -1 ? 1 : 0;
  wanted.focus = options.focus;
  wanted.dma_buf = options.dma_buf ? 1 : 0;
  platform::CameraSource device;
  if (!device.open(options.source, wanted, error)) {
    return nullptr;
  }
  const double granted_hz = device.info().rate_hz;
  rate_hz = granted_hz > 0.0 ? granted_hz : wanted.rate_hz;
  return std::make_unique<DeviceCamera>(std::move(device));
}

}  // namespace pf::capture
