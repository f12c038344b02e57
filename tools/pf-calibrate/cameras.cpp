#include "cameras.h"

#include <planefold_platform/cameras.h>

#include <algorithm>
#include <chrono>
#include <csignal>

namespace pf::calibrate {

namespace {

volatile std::sig_atomic_t g_interrupted = 0;

}  // namespace

bool search_camera(const Options& options, Search& search, std::string& error) {
  pf_camera_source_options_t wanted{};
  pf_camera_source_options_default(&wanted);
  wanted.width = options.width;
  wanted.height = options.height;
  wanted.lock_focus = 1;  // another focus is another camera
  platform::CameraSource camera;
  if (!camera.open(options.source, wanted, error) || !camera.start(error)) {
    return false;
  }
  std::signal(SIGINT, [](int) { g_interrupted = 1; });
  const auto begin = std::chrono::steady_clock::now();
  for (int64_t seconds = 0; seconds < options.seconds && g_interrupted == 0;) {
    pf_camera_source_frame_t frame{};
    const int read = camera.read(200, frame, error);
    if (read == PF_CAMERA_SOURCE_FRAME) {
      search.image = {frame.image.width, frame.image.height};
      if (search.mask.empty() && !read_mask(options, "", search, error)) {
        return false;
      }
      look_at(frame.image, options, search.frames, search);
      ++search.frames;
      ++search.looked_at;
      camera.release(frame);
    } else if (read != PF_CAMERA_SOURCE_NOTHING) {
      return false;
    }
    const auto passed = std::chrono::steady_clock::now() - begin;
    seconds = std::chrono::duration_cast<std::chrono::seconds>(passed).count();
    show_progress(options, search, std::min(seconds, options.seconds), options.seconds, "seconds");
  }
  return true;
}

}  // namespace pf::calibrate
