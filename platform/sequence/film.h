#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FILM_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FILM_H

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "calibration.h"
#include "file.h"
#include "program.h"

namespace pf::sequence {

/// The frames of a film, grey, in their order and at the film's own times, by the program ffmpeg. As ffmpeg shows them: rotated and
/// cropped where the film says so.
class Film {
 public:
  /// Throws ReadError where ffmpeg shows no frame of it.
  explicit Film(fs::path path);

  /// Size of the first frame.
  ImageSize size() const { return size_; }

  /// Frame number index; going back means decoding from the beginning. The pixels are valid until the next call. false: the film has
  /// ended before. Throws ImageError where this frame alone cannot be used, ReadError where no other can be either.
  bool read(int64_t index, const unsigned char*& pixels, int64_t& t_ns);

  /// Where it ended and what ffmpeg said about that, once read() has returned false.
  std::string how_it_ended() const;

 private:
  struct Stamp {
    int64_t t_ns;
    size_t bytes;
  };

  void begin();
  /// Has the next frame in front of the program's data and its stamp in front of stamps_. false: there is none.
  bool fetch();
  void drop();
  void parse_times();
  void parse_line(const std::string& line);
  std::string where(int64_t index) const;

  fs::path path_;
  std::unique_ptr<Program> program_;
  bool old_option_ = false;  ///< this ffmpeg knows -vsync and not -fps_mode
  std::deque<Stamp> stamps_;
  ImageSize size_;
  int64_t units_per_second_ = 0;
  int64_t next_ = 0;  ///< number of the frame that fetch() has or gets
  bool has_dropped_ = false;
  int64_t last_t_ns_ = 0;  ///< of the frame before, where has_dropped_
};

}  // namespace pf::sequence

#endif
