#include "cameras.h"

#include <planefold_platform/cameras.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>

namespace pf::calibrate {

namespace {

volatile std::sig_atomic_t g_interrupted = 0;

/// Until the time is over or the user ends it.
template <class Api>
bool watch(const Options& options, Search& search, std::string& error) {
  char message[Api::kMessage] = "";
  typename Api::Options wanted{};
  Api::options_default(&wanted);
  wanted.width = options.width;
  wanted.height = options.height;
  wanted.lock_focus = 1;  // another focus is another camera
  const auto camera = platform::open_camera<Api>(options.source, wanted, error);
  if (camera == nullptr) {
    return false;
  }
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

}  // namespace

bool search_camera(const Options& options, Search& search, std::string& error) {
#ifdef PLANEFOLD_HAVE_V4L2
  if (platform::is_v4l2(options.source)) {
    return watch<platform::V4l2>(options, search, error);
  }
#endif
#ifdef PLANEFOLD_HAVE_LIBCAMERA
  if (platform::is_libcamera(options.source)) {
    return watch<platform::Libcamera>(options, search, error);
  }
#endif
  (void)search;
  error = "source '" + options.source + "': this build has no such cameras (libcamera: needs Debian's libcamera-dev)";
  return false;
}

}  // namespace pf::calibrate
