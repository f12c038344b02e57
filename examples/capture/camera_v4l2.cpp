#include <cstdio>
#include <nlohmann/json.hpp>

#include "camera.h"

#ifdef PLANEFOLD_HAVE_V4L2
#include <planefold_platform/v4l2.h>
#endif

namespace pf::capture {

#ifdef PLANEFOLD_HAVE_V4L2

namespace {

class V4l2Camera : public Camera {
 public:
  explicit V4l2Camera(pf_v4l2_t* camera) : camera_(camera, pf_v4l2_close) {}

  bool start(std::string& error) override {
    char message[PF_V4L2_MESSAGE] = "";
    const bool done = pf_v4l2_start(camera_.get(), message) == 0;
    error = message;
    return done;
  }

  CameraRead next(int timeout_ms, CameraFrame& frame, std::string& message) override {
    char text[PF_V4L2_MESSAGE] = "";
    pf_v4l2_frame_t taken{};
    switch (pf_v4l2_read(camera_.get(), timeout_ms, &taken, text)) {
      case PF_V4L2_FRAME:
        frame = CameraFrame{};
        frame.image = taken.image;
        frame.arrived_ns = taken.arrived_ns;
        frame.number = number_++;
        frame.handle = taken.buffer;
        return CameraRead::kFrame;
      case PF_V4L2_NOTHING:
        return CameraRead::kNothing;
      case PF_V4L2_GONE:
        message = text;
        return CameraRead::kGone;
      default:
        message = text;
        return CameraRead::kFailed;
    }
  }

  void release(const CameraFrame& frame) override {
    pf_v4l2_frame_t taken{};
    taken.buffer = frame.handle;
    pf_v4l2_release(camera_.get(), &taken);
  }

  bool come_back() override { return pf_v4l2_return(camera_.get(), nullptr) == 0; }

  std::string name() const override { return info().device.path; }

  std::string report() const override {
    constexpr const char* kStamps[] = {"arrival", "end of exposure", "start of exposure"};
    const pf_v4l2_info_t i = info();
    const nlohmann::ordered_json json = {{"device", i.device.path},
                                         {"name", i.device.name},
                                         {"format", pf_v4l2_format_name(i.format)},
                                         {"rate_hz", i.rate_hz},
                                         {"exposure_s", i.exposure_s},
                                         {"buffers", i.buffers},
                                         {"timestamps", kStamps[i.stamp <= PF_V4L2_STAMP_START ? i.stamp : 0]},
                                         {"direct", i.direct != 0},
                                         {"read_slowness", i.read_slowness},
                                         {"frames", i.frames},
                                         {"lost", i.lost},
                                         {"damaged", i.damaged},
                                         {"departures", i.departures}};
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }

  pf_v4l2_info_t info() const {
    pf_v4l2_info_t info{};
    pf_v4l2_get_info(camera_.get(), &info);
    return info;
  }

 private:
  std::unique_ptr<pf_v4l2_t, void (*)(pf_v4l2_t*)> camera_;
  int64_t number_ = 0;
};

}  // namespace

std::unique_ptr<Camera> open_v4l2_camera(const Options& options, const pf_camera_t& camera, double& rate_hz,
                                         std::string& error) {
  char message[PF_V4L2_MESSAGE] = "";
  pf_v4l2_options_t wanted{};
  pf_v4l2_options_default(&wanted);
  wanted.width = camera.width;
  wanted.height = camera.height;
  wanted.rate_hz = options.rate_hz > 0.0 ? options.rate_hz : rate_hz;
  wanted.exposure_s = 1e-6 * options.exposure_us;
  wanted.lock_focus = options.focus >= -1 ? 1 : 0;
  wanted.focus = options.focus;
  wanted.dma_buf = options.dma_buf ? 1 : 0;
  for (uint32_t f = 0; f < PF_V4L2_FORMATS; ++f) {
    wanted.format = options.format == pf_v4l2_format_name(f) ? f : wanted.format;
  }
  pf_v4l2_t* opened = nullptr;
  const std::string where = options.source.substr(options.source.find(':') + 1);
  if (pf_v4l2_open(where.c_str(), &wanted, &opened, message) != 0) {
    error = message;
    return nullptr;
  }
  auto device = std::make_unique<V4l2Camera>(opened);
  const pf_v4l2_info_t info = device->info();
  rate_hz = info.rate_hz > 0.0 ? info.rate_hz : wanted.rate_hz;
  return device;
}

int list_v4l2_cameras() {
  pf_v4l2_device_t devices[32];
  const int count = pf_v4l2_list(devices, 32);
  bool refused = false;
  for (int i = 0; i < count && i < 32; ++i) {
    const pf_v4l2_device_t& device = devices[i];
    std::string formats;
    for (uint32_t f = 1; f < PF_V4L2_FORMATS; ++f) {
      if ((device.formats & (1u << f)) != 0) {
        formats += std::string(formats.empty() ? "" : " ") + pf_v4l2_format_name(f);
      }
    }
    if (device.refused != 0) {
      refused = true;
      std::printf("camera  v4l2:%-14s this user may not open it\n", device.path);
    } else {
      std::printf("camera  v4l2:%-14s %s (%s)  %s\n", device.path, device.name, device.bus,
                  formats.empty() ? "no format that is known here" : formats.c_str());
    }
  }
  if (refused) {
    std::fprintf(stderr,
                 "pf-capture: note: cameras belong to the group video; as root: usermod -a -G video USER, then log in "
                 "again\n");
  }
  return count;
}

#else

std::unique_ptr<Camera> open_v4l2_camera(const Options& options, const pf_camera_t&, double&, std::string& error) {
  error = "source '" + options.source + "': this build has no V4L2";
  return nullptr;
}

int list_v4l2_cameras() { return 0; }

#endif

}  // namespace pf::capture
