#ifndef PLANEFOLD_CAPTURE_FILM_H
#define PLANEFOLD_CAPTURE_FILM_H

#include <sys/types.h>

#include <cstdio>
#include <string>

#include "canvas.h"

namespace pf::capture {

/// Pictures to an MP4 file, through the program ffmpeg, which gets raw frames by a pipe.
///
/// The file is in fragments of about a second, each of which plays without those after it. ffmpeg is in a session of its own, so that
/// what ends this program by its terminal or process group leaves it the time to finish the file.
class Film {
 public:
  Film() = default;
  ~Film() { close(); }
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// false: warning is one line (ffmpeg is not installed, say); the run goes on without a film.
  bool open(const std::string& path, int width, int height, double rate_hz, std::string& warning);
  void add(const Canvas& canvas);
  /// false when ffmpeg failed somewhere on the way.
  bool close();
  bool is_open() const { return pipe_ != nullptr; }
  /// ffmpeg ended early: nothing more is added.
  bool has_failed() const { return failed_; }

 private:
  std::FILE* pipe_ = nullptr;
  pid_t child_ = -1;
  bool failed_ = false;
};

}  // namespace pf::capture

#endif
