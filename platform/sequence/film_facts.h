#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FILM_FACTS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FILM_FACTS_H

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calibration.h"
#include "file.h"

namespace pf::sequence {

/// What a film says of itself, without a frame being decoded.
struct FilmFacts {
  std::vector<int64_t>
      t_ns;  ///< of its frames, in their order; they may turn out to be fewer, and times are rounded to microseconds
  double rate_hz = 0.0;            ///< median; 0 where it cannot be told
  ImageSize size;                  ///< as stored; a rotation may exchange them
  double pixel_aspect = 1.0;       ///< width of a pixel as stored by its height
  std::vector<std::string> notes;  ///< what its user may not know, one line each
};

/// Asks ffprobe. Throws ReadError that names the file and says why it cannot be used as a film.
FilmFacts probe_film(const fs::path& path);

/// Whether a file is a film, by what it begins with or by its name.
bool looks_like_film(const fs::path& path);

}  // namespace pf::sequence

#endif
