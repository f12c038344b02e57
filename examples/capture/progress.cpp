#include "progress.h"

#include <unistd.h>

#include <cstdio>
#include <string>

namespace pf::capture {

namespace {

double now_s() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

void Progress::show(const FrameView& view) {
  const double now = now_s();
  const bool last = view.index + 1 == view.count;
  if (quiet_ || (!last && now - last_s_ < (terminal_ ? 0.1 : 2.0))) {
    return;
  }
  last_s_ = now;
  const std::string count = view.count > 0 ? "/" + std::to_string(view.count) : "";
  std::fprintf(stderr, "%sframe %lld%s  %-8s  %3d of %3d features  %6.2f ms%s", terminal_ ? "\r" : "",
               static_cast<long long>(view.index + 1), count.c_str(), state_name(view.report.state),
               view.report.inliers, view.report.attempts, view.ms, terminal_ ? "  " : "\n");
  std::fflush(stderr);
  open_ = terminal_;
}

void Progress::end() {
  if (open_) {
    std::fputc('\n', stderr);
    open_ = false;
  }
}

}  // namespace pf::capture
