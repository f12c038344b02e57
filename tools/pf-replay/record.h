#pragma once

#include <cstdint>
#include <string>

#include "quality.h"

namespace replay {

/// Run the session and keep, of every frame, what the library accepted and what it estimated.
bool record(const std::string& file, int frames, std::uint64_t seed, bool planes);

/// How far a run on the accepted observations of another one came away from it.
struct Distance {
  int frames = 0, tracked = 0;
  int not_tracked = 0;     ///< frames that the recorded run tracked and this one did not
  int starts_again = 0;    ///< the estimate was given up
  long offered = 0;        ///< observations in the recorded run
  long refused = 0;        ///< of them by the recorded run
  long refused_again = 0;  ///< measurements of the recorded run that this one did not use
  int other_map = 0;       ///< frames whose map has another number of features
  int other_state = 0;     ///< frames whose state has another number of rows
  int longest_other = 0;   ///< of them in a row
  bool other_end = false;  ///< the last frame is one of them
  long open_depths = 0;    ///< features of the recorded run with an inverse depth, summed over its frames
  long places = 0;         ///< those with a place, likewise
  long converted_apart =
      0;  ///< features that have an inverse depth in one run and a place in the other, summed over frames
  long folded_apart = 0;  ///< those that are folded in one run alone, likewise
  double position = 0;    ///< largest difference of a coordinate, in the recorded run's sigma
  double rotation = 0;
  double sigma = 0;         ///< largest relative difference of a sigma of the pose
  double map_position = 0;  ///< of points at the end, likewise
  double map_sigma = 0;
  int map_points = 0;
  int other_kind = 0;  ///< points at the end that are folded in one run and not in the other
  int folded = 0;      ///< points at the end that are folded in both
  double us_per_frame = 0;
  Quality recorded, here;  ///< each run against the truth
};

/// sigma_px: noise that the pixels get beside their own. False when the file cannot be read.
bool follow(const std::string& file, double sigma_px, Distance* distance);

}  // namespace replay
