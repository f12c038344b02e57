#ifndef PLANEFOLD_CALIBRATE_SEARCH_H
#define PLANEFOLD_CALIBRATE_SEARCH_H

#include <string>
#include <vector>

#include "options.h"
#include "views.h"

namespace pf::calibrate {

struct Search {
  cv::Size image;
  int64_t frames = 0, looked_at = 0;
  std::vector<View> found;
  cv::Mat mask;  ///< 0: not the scene; empty: all is

  // As long as nothing was found:
  int64_t in_vain = 0;          ///< frames
  Sighting best;                ///< of the frame with most markers
  bool found_other = false;     ///< the other kind of target
  bool found_mirrored = false;  ///< the board as a mirror shows it
  cv::Size other_squares;       ///< a chessboard of so many squares, none: 0 x 0
};

/// Looks for the board: in frames that lie evenly over a recording, or in what a camera shows until the time is over
/// or the program is interrupted. false: error is one line.
bool search_source(const Options& options, Search& search, std::string& error);

/// The mask of pictures of search.image: of --mask, or the one beside the frames ("": there is none). false: error is one line.
bool read_mask(const Options& options, const std::string& beside, Search& search, std::string& error);

/// One frame of it, and how far it is.
void look_at(const pf_image_t& image, const Options& options, int64_t number, Search& search);
void show_progress(const Options& options, const Search& search, int64_t done, int64_t of, const char* unit);

/// One line for a search that found nothing.
std::string why_nothing_was_found(const Options& options, const Search& search);

}  // namespace pf::calibrate

#endif
