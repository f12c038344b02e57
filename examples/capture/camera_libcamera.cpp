#include "camera.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#ifdef PLANEFOLD_HAVE_LIBCAMERA
#include <planefold_platform/libcamera.h>
#endif

namespace pf::capture {

#ifdef PLANEFOLD_HAVE_LIBCAMERA

namespace {

class LibcameraCamera : public Camera {
 public:
  explicit LibcameraCamera(pf_libcamera_t* camera) : camera_(camera, pf_libcamera_close) {}

  bool start(std::string& error) override {
    char message[PF_LIBCAMERA_MESSAGE] = "";
    const bool done = pf_libcamera_start(camera_.get(), message) == 0;
    error = message;
    return done;
  }

  CameraRead next(int timeout_ms, CameraFrame& frame, std::string& message) override {
    char text[PF_LIBCAMERA_MESSAGE] = "";
    pf_libcamera_frame_t taken{};
    switch (pf_libcamera_read(camera_.get(), timeout_ms, &taken, text)) {
      case PF_LIBCAMERA_FRAME:
        frame = CameraFrame{};
        frame.image = taken.image;
        frame.arrived_ns = taken.arrived_ns;
        frame.number = number_++;
        frame.handle = taken.buffer;
        return CameraRead::kFrame;
      case PF_LIBCAMERA_NOTHING:
        return CameraRead::kNothing;
      case PF_LIBCAMERA_GONE:
        message = text;
        return CameraRead::kGone;
      default:
        message = text;
        return CameraRead::kFailed;
    }
  }

  void release(const CameraFrame& frame) override {
    pf_libcamera_frame_t taken{};
    taken.buffer = frame.handle;
    pf_libcamera_release(camera_.get(), &taken);
  }

  bool come_back() override { return pf_libcamera_return(camera_.get(), nullptr) == 0; }

  std::string name() const override { return info().device.id; }

  std::string report() const override {
    constexpr const char* kStamps[] = {"arrival", "buffer", "sensor"};
    const pf_libcamera_info_t i = info();
    const nlohmann::ordered_json json = {{"device", i.device.id},
                                         {"name", i.device.model},
                                         {"libcamera", pf_libcamera_version()},
                                         {"format", pf_libcamera_format_name(i.format)},
                                         {"stride", i.stride},
                                         {"rate_hz", i.rate_hz},
                                         {"exposure_s", i.exposure_s},
                                         {"buffers", i.buffers},
                                         {"timestamps", kStamps[i.stamp <= PF_LIBCAMERA_STAMP_SENSOR ? i.stamp : 0]},
                                         {"direct", i.direct != 0},
                                         {"frames", i.frames},
                                         {"lost", i.lost},
                                         {"damaged", i.damaged},
                                         {"departures", i.departures}};
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }

 private:
  pf_libcamera_info_t info() const {
    pf_libcamera_info_t info{};
    pf_libcamera_get_info(camera_.get(), &info);
    return info;
  }

  std::unique_ptr<pf_libcamera_t, void (*)(pf_libcamera_t*)> camera_;
  int64_t number_ = 0;
};

}  // namespace

std::unique_ptr<Camera> open_libcamera_camera(const Options& options, const pf_camera_t& camera, double& rate_hz,
                                              std::string& error) {
  char message[PF_LIBCAMERA_MESSAGE] = "";
  pf_libcamera_options_t wanted{};
  pf_libcamera_options_default(&wanted);
  wanted.width = camera.width;
  wanted.height = camera.height;
  wanted.rate_hz = options.rate_hz > 0.0 ? options.rate_hz : rate_hz;
  wanted.exposure_s = 1e-6 * options.exposure_us;
  wanted.lock_focus = options.focus >= -1 ? 1 : 0;
  if (options.focus >= 0) {
    error =
        "--focus " + std::to_string(options.focus) + ": libcamera has no steps; --focus -1 holds the lens where it is";
    return nullptr;
  }
  for (uint32_t f = 0; f < PF_LIBCAMERA_FORMATS; ++f) {
    wanted.format = options.format == pf_libcamera_format_name(f) ? f : wanted.format;
  }
  pf_libcamera_t* opened = nullptr;
  const std::string where = options.source.substr(options.source.find(':') + 1);
  if (pf_libcamera_open(where.c_str(), &wanted, &opened, message) != 0) {
    error = message;
    return nullptr;
  }
  rate_hz = wanted.rate_hz;
  return std::make_unique<LibcameraCamera>(opened);
}

int list_libcamera_cameras() {
  pf_libcamera_device_t devices[32];
  const int count = pf_libcamera_list(devices, 32);
  for (int i = 0; i < count && i < 32; ++i) {
    std::string formats;
    for (uint32_t f = 1; f < PF_LIBCAMERA_FORMATS; ++f) {
      if ((devices[i].formats & (1u << f)) != 0) {
        formats += std::string(formats.empty() ? "" : " ") + pf_libcamera_format_name(f);
      }
    }
    std::printf("camera  libcamera:%-9d %s (%s)  %s\n", i, devices[i].id, devices[i].model,
                formats.empty() ? "no format that is known here" : formats.c_str());
  }
  return count;
}

#else

std::unique_ptr<Camera> open_libcamera_camera(const Options& options, const pf_camera_t&, double&, std::string& error) {
  error = "source '" + options.source + "': this build has no libcamera (Debian: libcamera-dev); use v4l2:";
  return nullptr;
}

int list_libcamera_cameras() { return 0; }

#endif

}  // namespace pf::capture
