/* Which sources of a program's command line are cameras, and opening one of them.
 *
 * V4L2 and libcamera are there where PLANEFOLD_HAVE_V4L2 and PLANEFOLD_HAVE_LIBCAMERA are defined.
 */
#ifndef PLANEFOLD_PLATFORM_CAMERAS_H
#define PLANEFOLD_PLATFORM_CAMERAS_H

#include <planefold_platform/camera_source.h>

#include <string>

namespace pf::platform {

/// What a source names by its beginning, whether this build has it or not.
inline bool is_v4l2(const std::string& source) { return source.rfind("v4l2:", 0) == 0; }
inline bool is_libcamera(const std::string& source) { return source.rfind("libcamera:", 0) == 0; }
inline bool is_camera(const std::string& source) { return is_v4l2(source) || is_libcamera(source); }

/// A camera that closes itself.
class CameraSource {
 public:
  CameraSource() = default;
  CameraSource(CameraSource&& other) noexcept : source_(other.source_) { other.source_ = {}; }
  CameraSource(const CameraSource&) = delete;
  CameraSource& operator=(const CameraSource&) = delete;
  CameraSource& operator=(CameraSource&&) = delete;
  ~CameraSource() {
    if (source_.close != nullptr) {
      source_.close(source_.context);
    }
  }

  /// The camera behind the colon of a source. false: error is one line.
  bool open(const std::string& source, const pf_camera_source_options_t& options, std::string& error) {
    int (*open_source)(const char*, const pf_camera_source_options_t*, pf_camera_source_t*, char*) = nullptr;
#ifdef PLANEFOLD_HAVE_V4L2
    open_source = is_v4l2(source) ? pf_v4l2_open_source : open_source;
#endif
#ifdef PLANEFOLD_HAVE_LIBCAMERA
    open_source = is_libcamera(source) ? pf_libcamera_open_source : open_source;
#endif
    if (open_source == nullptr) {
      error = "source '" + source + "': this build has no " +
              (is_libcamera(source) ? "libcamera (Debian: libcamera-dev); use v4l2:" : "V4L2");
      return false;
    }
    char message[PF_CAMERA_SOURCE_MESSAGE] = "";
    const bool opened = open_source(source.c_str() + source.find(':') + 1, &options, &source_, message) == 0;
    error = message;
    return opened;
  }

  bool start(std::string& error) const {
    char message[PF_CAMERA_SOURCE_MESSAGE] = "";
    const bool started = source_.start(source_.context, message) == 0;
    error = message;
    return started;
  }

  /// As pf_camera_source_t.read; message is written where the result is neither a frame nor nothing.
  int read(int timeout_ms, pf_camera_source_frame_t& frame, std::string& message) const {
    char text[PF_CAMERA_SOURCE_MESSAGE] = "";
    const int result = source_.read(source_.context, timeout_ms, &frame, text);
    if (result != PF_CAMERA_SOURCE_FRAME && result != PF_CAMERA_SOURCE_NOTHING) {
      message = text;
    }
    return result;
  }

  void release(const pf_camera_source_frame_t& frame) const { source_.release(source_.context, &frame); }

  bool come_back() const {
    char message[PF_CAMERA_SOURCE_MESSAGE] = "";
    return source_.come_back(source_.context, message) == 0;
  }

  pf_camera_source_info_t info() const {
    pf_camera_source_info_t info{};
    source_.get_info(source_.context, &info);
    return info;
  }

 private:
  pf_camera_source_t source_{};
};

}  // namespace pf::platform

#endif
