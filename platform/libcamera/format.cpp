#include "format.h"

#include <cmath>

namespace pf::libcamera {

using ::libcamera::CameraConfiguration;
using ::libcamera::StreamConfiguration;
using ::libcamera::StreamRole;

namespace {

const struct {
  ::libcamera::PixelFormat pixels;
  const char* name;
} kFormats[PF_LIBCAMERA_FORMATS] = {
    {::libcamera::PixelFormat(), "any"},      {::libcamera::formats::R8, "GREY"},
    {::libcamera::formats::YUV420, "YUV420"}, {::libcamera::formats::NV12, "NV12"},
    {::libcamera::formats::YUYV, "YUYV"},     {::libcamera::formats::RGB888, "RGB888"},
    {::libcamera::formats::BGR888, "BGR888"},
};

std::string size_text(const ::libcamera::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

}  // namespace

::libcamera::PixelFormat pixel_format(uint32_t format) { return kFormats[format].pixels; }

std::unique_ptr<CameraConfiguration> default_configuration(::libcamera::Camera& camera) {
  for (const StreamRole role : {StreamRole::VideoRecording, StreamRole::Viewfinder}) {
    auto configuration = camera.generateConfiguration({role});
    if (configuration != nullptr && configuration->size() == 1) {
      return configuration;
    }
  }
  return nullptr;
}

std::unique_ptr<CameraConfiguration> negotiate(::libcamera::Camera& camera, const pf_libcamera_options_t& options,
                                               uint32_t& format, std::string& error) {
  const ::libcamera::Size size(static_cast<unsigned>(options.width), static_cast<unsigned>(options.height));
  std::string others;
  for (uint32_t f = 1; f < PF_LIBCAMERA_FORMATS; ++f) {
    if (options.format != PF_LIBCAMERA_ANY && options.format != f) {
      continue;
    }
    auto configuration = default_configuration(camera);
    if (configuration == nullptr) {
      error = "gives no stream for video or a viewfinder";
      return nullptr;
    }
    StreamConfiguration& stream = configuration->at(0);
    stream.pixelFormat = pixel_format(f);
    stream.size = size;
    stream.bufferCount = static_cast<unsigned>(options.buffers);
    if (configuration->validate() == CameraConfiguration::Invalid || stream.pixelFormat != pixel_format(f)) {
      continue;
    }
    if (stream.size == size) {
      format = f;
      return configuration;
    }
    others += (others.empty() ? "" : ", ") + std::string(kFormats[f].name) + " " + size_text(stream.size);
  }
  if (!others.empty()) {
    error = "has no picture of " + size_text(size) + "; the nearest that it offers: " + others +
            ". Calibrate it in a size that it has";
  } else if (options.format != PF_LIBCAMERA_ANY) {
    error = std::string("does not give ") + kFormats[options.format].name;
  } else {
    error = "gives none of GREY (R8), YUV420, NV12, YUYV, RGB888 and BGR888; v4l2: knows MJPEG";
  }
  return nullptr;
}

bool wanted_controls(const ::libcamera::Camera& camera, const pf_libcamera_options_t& options,
                     ::libcamera::ControlList& controls, std::string& error) {
  namespace known = ::libcamera::controls;
  const auto has = [&](const ::libcamera::ControlId& id) { return camera.controls().count(id.id()) != 0; };
  if (options.rate_hz > 0.0 && has(known::FrameDurationLimits)) {
    const auto duration_us = static_cast<int64_t>(std::llround(1e6 / options.rate_hz));
    controls.set(known::FrameDurationLimits, {duration_us, duration_us});
  }
  if (options.exposure_s > 0.0) {
    if (!has(known::ExposureTime)) {
      error = "has no control for the exposure; leave --exposure away";
      return false;
    }
    if (has(known::AeEnable)) {
      controls.set(known::AeEnable, false);
    }
    controls.set(known::ExposureTime, static_cast<int32_t>(std::lround(1e6 * options.exposure_s)));
  }
  if (options.lock_focus != 0 && has(known::AfMode)) {
    controls.set(known::AfMode, static_cast<int32_t>(known::AfModeManual));
  }
  return true;
}

}  // namespace pf::libcamera

const char* pf_libcamera_format_name(uint32_t format) {
  return format < PF_LIBCAMERA_FORMATS ? pf::libcamera::kFormats[format].name : nullptr;
}
