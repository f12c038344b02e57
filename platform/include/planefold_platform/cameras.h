/* The two C interfaces to cameras as C++ types of one shape, for code that serves either:
 *
 *   template <class Api> void watch(const std::string& source) {
 *     typename Api::Options options{};
 *     Api::options_default(&options);
 *     auto camera = pf::platform::open_camera<Api>(source, options, error);
 *     Api::start(camera.get(), message);
 *   }
 *
 * V4l2 and Libcamera are there where PLANEFOLD_HAVE_V4L2 and PLANEFOLD_HAVE_LIBCAMERA are defined.
 */
#ifndef PLANEFOLD_PLATFORM_CAMERAS_H
#define PLANEFOLD_PLATFORM_CAMERAS_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#ifdef PLANEFOLD_HAVE_V4L2
#include <planefold_platform/v4l2.h>
#endif
#ifdef PLANEFOLD_HAVE_LIBCAMERA
#include <planefold_platform/libcamera.h>
#endif

namespace pf::platform {

#ifdef PLANEFOLD_HAVE_V4L2
struct V4l2 {
  using Device = pf_v4l2_t;
  using Options = pf_v4l2_options_t;
  using Frame = pf_v4l2_frame_t;
  using Info = pf_v4l2_info_t;
  static constexpr size_t kMessage = PF_V4L2_MESSAGE;
  static constexpr uint32_t kFormats = PF_V4L2_FORMATS;
  static constexpr int kNothing = PF_V4L2_NOTHING, kFrame = PF_V4L2_FRAME, kGone = PF_V4L2_GONE;
  static constexpr auto options_default = pf_v4l2_options_default;
  static constexpr auto format_name = pf_v4l2_format_name;
  static constexpr auto open = pf_v4l2_open;
  static constexpr auto close = pf_v4l2_close;
  static constexpr auto start = pf_v4l2_start;
  static constexpr auto read = pf_v4l2_read;
  static constexpr auto release = pf_v4l2_release;
  static constexpr auto come_back = pf_v4l2_return;
  static constexpr auto get_info = pf_v4l2_get_info;
};
#endif

#ifdef PLANEFOLD_HAVE_LIBCAMERA
struct Libcamera {
  using Device = pf_libcamera_t;
  using Options = pf_libcamera_options_t;
  using Frame = pf_libcamera_frame_t;
  using Info = pf_libcamera_info_t;
  static constexpr size_t kMessage = PF_LIBCAMERA_MESSAGE;
  static constexpr uint32_t kFormats = PF_LIBCAMERA_FORMATS;
  static constexpr int kNothing = PF_LIBCAMERA_NOTHING, kFrame = PF_LIBCAMERA_FRAME, kGone = PF_LIBCAMERA_GONE;
  static constexpr auto options_default = pf_libcamera_options_default;
  static constexpr auto format_name = pf_libcamera_format_name;
  static constexpr auto open = pf_libcamera_open;
  static constexpr auto close = pf_libcamera_close;
  static constexpr auto start = pf_libcamera_start;
  static constexpr auto read = pf_libcamera_read;
  static constexpr auto release = pf_libcamera_release;
  static constexpr auto come_back = pf_libcamera_return;
  static constexpr auto get_info = pf_libcamera_get_info;
};
#endif

/// What a source names by its beginning, whether this build has it or not.
inline bool is_v4l2(const std::string& source) { return source.rfind("v4l2:", 0) == 0; }
inline bool is_libcamera(const std::string& source) { return source.rfind("libcamera:", 0) == 0; }
inline bool is_camera(const std::string& source) { return is_v4l2(source) || is_libcamera(source); }

template <class Api>
using OpenCamera = std::unique_ptr<typename Api::Device, void (*)(typename Api::Device*)>;

/// The camera behind the colon of a source. null: error is one line.
template <class Api>
OpenCamera<Api> open_camera(const std::string& source, const typename Api::Options& options, std::string& error) {
  char message[Api::kMessage] = "";
  typename Api::Device* opened = nullptr;
  if (Api::open(source.c_str() + source.find(':') + 1, &options, &opened, message) != 0) {
    error = message;
  }
  return {opened, Api::close};
}

}  // namespace pf::platform

#endif
