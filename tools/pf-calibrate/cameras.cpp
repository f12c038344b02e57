#include "cameras.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>

#ifdef PLANEFOLD_HAVE_V4L2
#include <planefold_platform/v4l2.h>
#endif
#ifdef PLANEFOLD_HAVE_LIBCAMERA
#include <planefold_platform/libcamera.h>
#endif

namespace pf::calibrate {

namespace {

volatile std::sig_atomic_t g_interrupted = 0;

#ifdef PLANEFOLD_HAVE_V4L2
struct V4l2 {
  using Device = pf_v4l2_t;
  using Options = pf_v4l2_options_t;
  using Frame = pf_v4l2_frame_t;
  static constexpr size_t kMessage = PF_V4L2_MESSAGE;
  static constexpr int kNothing = PF_V4L2_NOTHING, kFrame = PF_V4L2_FRAME, kGone = PF_V4L2_GONE;
  static constexpr auto open = pf_v4l2_open;
  static constexpr auto close = pf_v4l2_close;
  static constexpr auto start = pf_v4l2_start;
  static constexpr auto read = pf_v4l2_read;
  static constexpr auto release = pf_v4l2_release;
  static void set_defaults(Options& options) {
    pf_v4l2_options_default(&options);
    options.hand_over = PF_V4L2_COPIED;
  }
};
#endif

#ifdef PLANEFOLD_HAVE_LIBCAMERA
struct Libcamera {
  using Device = pf_libcamera_t;
  using Options = pf_libcamera_options_t;
  using Frame = pf_libcamera_frame_t;
  static constexpr size_t kMessage = PF_LIBCAMERA_MESSAGE;
  static constexpr int kNothing = PF_LIBCAMERA_NOTHING, kFrame = PF_LIBCAMERA_FRAME, kGone = PF_LIBCAMERA_GONE;
  static constexpr auto open = pf_libcamera_open;
  static constexpr auto close = pf_libcamera_close;
  static constexpr auto start = pf_libcamera_start;
  static constexpr auto read = pf_libcamera_read;
  static constexpr auto release = pf_libcamera_release;
  static void set_defaults(Options& options) { pf_libcamera_options_default(&options); }
};
#endif

/// Until the time is over or the user ends it.
template <class Api>
bool watch(const std::string& name, const Options& options, Search& search, std::string& error) {
  char message[Api::kMessage] = "";
  typename Api::Options wanted{};
  Api::set_defaults(wanted);
  wanted.width = options.width;
  wanted.height = options.height;
  wanted.lock_focus = 1;  // another focus is another camera
  typename Api::Device* opened = nullptr;
  if (Api::open(name.empty() ? nullptr : name.c_str(), &wanted, &opened, message) != 0) {
    error = message;
    return false;
  }
  const std::unique_ptr<typename Api::Device, void (*)(typename Api::Device*)> camera(opened, Api::close);
  if (Api::start(camera.get(), message) != 0) {
    error = message;
    return false;
  }
  std::signal(SIGINT, [](int) { g_interrupted = 1; });
  const auto begin = std::chrono::steady_clock::now();
  for (int64_t seconds = 0; seconds < options.seconds && g_interrupted == 0;) {
    typename Api::Frame frame{};
    const int read = Api::read(camera.get(), 200, &frame, message);
    if (read == Api::kFrame) {
      search.image = {frame.image.width, frame.image.height};
      look_at(frame.image, options, search.frames, search);
      ++search.frames;
      ++search.looked_at;
      Api::release(camera.get(), &frame);
    } else if (read != Api::kNothing) {
      error = read == Api::kGone ? "the camera was unplugged" : message;
      return false;
    }
    const auto passed = std::chrono::steady_clock::now() - begin;
    seconds = std::chrono::duration_cast<std::chrono::seconds>(passed).count();
    show_progress(options, search, std::min(seconds, options.seconds), options.seconds, "seconds");
  }
  return true;
}

bool begins_with(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

}  // namespace

bool is_camera(const std::string& source) { return begins_with(source, "v4l2:") || begins_with(source, "libcamera:"); }

bool search_camera(const Options& options, Search& search, std::string& error) {
#if defined(PLANEFOLD_HAVE_V4L2) || defined(PLANEFOLD_HAVE_LIBCAMERA)
  const std::string name = options.source.substr(options.source.find(':') + 1);
#endif
#ifdef PLANEFOLD_HAVE_V4L2
  if (begins_with(options.source, "v4l2:")) {
    return watch<V4l2>(name, options, search, error);
  }
#endif
#ifdef PLANEFOLD_HAVE_LIBCAMERA
  if (begins_with(options.source, "libcamera:")) {
    return watch<Libcamera>(name, options, search, error);
  }
#endif
  (void)search;
  error = "source '" + options.source + "': this build was made without it";
  return false;
}

}  // namespace pf::calibrate
