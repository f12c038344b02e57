#include "search.h"

#include <planefold_platform/cameras.h>
#include <planefold_platform/sequence.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>

#include "cameras.h"
#include "markers.h"

namespace pf::calibrate {

namespace {

struct CloseSequence {
  void operator()(pf_sequence_t* sequence) const { pf_close_sequence(sequence); }
};

constexpr int64_t kLookForOthersEvery = 8;

/// What else may have been printed.
void look_for_others(const cv::Mat& grey, const Board& board, Search& search) {
  Board other = board;
  View view;
  Sighting sighting;
  if (board.target == Target::kChessboard && have_markers() && board.markers() <= kMostMarkers) {
    other.target = Target::kCharuco;
    search.found_other = search.found_other || find_board(grey, other, view, sighting);
  }
  if (board.target == Target::kCharuco && !search.found_mirrored) {  // markers are not read from a mirror image
    cv::Mat mirrored;
    cv::flip(grey, mirrored, 1);
    search.found_mirrored = find_board(mirrored, board, view, sighting);
  }
  const cv::Size squares = size_of_chessboard(grey);
  if (squares.area() > search.other_squares.area()) {
    search.other_squares = squares;
  }
}

/// Takes the corners out that lie on what is masked, or as near to it as what a corner is found by. false: too few are left of a view.
bool leave_out_masked(const cv::Mat& mask, View& view) {
  constexpr int kAround = 5;  // [px]
  const cv::Rect image(0, 0, mask.cols, mask.rows);
  size_t left = 0;
  for (size_t i = 0; i < view.corners.size(); ++i) {
    const cv::Point at(cvRound(view.corners[i].x), cvRound(view.corners[i].y));
    const cv::Rect around(at.x - kAround, at.y - kAround, 2 * kAround + 1, 2 * kAround + 1);
    if (cv::countNonZero(mask(around & image)) < (around & image).area()) {
      continue;
    }
    view.corners[left] = view.corners[i];
    view.numbers[left++] = view.numbers[i];
  }
  view.corners.resize(left);
  view.numbers.resize(left);
  return left >= kFewestCorners;
}

bool search_sequence(const Options& options, Search& search, std::string& error) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  pf_sequence_t* opened = nullptr;
  if (pf_open_sequence(options.source.c_str(), PF_SEQUENCE_UNCALIBRATED, &opened, message) != 0) {
    error = message;
    return false;
  }
  const std::unique_ptr<pf_sequence_t, CloseSequence> sequence(opened);
  pf_sequence_info_t info;
  pf_get_sequence_info(sequence.get(), &info);
  search.image = {info.camera.width, info.camera.height};
  if (!read_mask(options, info.mask_path, search, error)) {
    return false;
  }
  search.frames = info.count;
  search.looked_at = std::min(info.count, options.look_at);
  for (int64_t k = 0; k < search.looked_at; ++k) {
    const int64_t number = search.looked_at > 1 ? k * (info.count - 1) / (search.looked_at - 1) : 0;
    pf_image_t image;
    const int result = pf_read_sequence_frame(sequence.get(), number, &image, message);
    if (result == PF_SEQUENCE_UNUSABLE_IMAGE) {
      std::fprintf(stderr, "pf-calibrate: note: left out: %s\n", message);
      continue;
    }
    if (result == PF_SEQUENCE_END) {
      std::fprintf(stderr, "pf-calibrate: note: %s\n", message);
      break;
    }
    if (result != 0) {
      error = message;
      return false;
    }
    look_at(image, options, number, search);
    show_progress(options, search, k + 1, search.looked_at, "frames");
  }
  return true;
}

}  // namespace

bool read_mask(const Options& options, const std::string& beside, Search& search, std::string& error) {
  const std::string path = options.mask == "auto" ? beside : options.mask == "none" ? "" : options.mask;
  if (path.empty()) {
    return true;
  }
  char message[PF_SEQUENCE_MESSAGE] = "";
  search.mask.create(search.image, CV_8U);
  if (pf_read_mask(path.c_str(), search.image.width, search.image.height, search.mask.data, message) != 0) {
    error = message;
    return false;
  }
  return true;
}

void look_at(const pf_image_t& image, const Options& options, int64_t number, Search& search) {
  const cv::Mat grey(image.height, image.width, CV_8U, const_cast<uint8_t*>(image.pixels),
                     static_cast<size_t>(image.stride));
  View view;
  Sighting sighting;
  view.frame = number;
  const bool found = find_board(grey, options.board, view, sighting);
  if (found && !search.mask.empty() && !leave_out_masked(search.mask, view)) {
    return;
  }
  if (found) {
    search.found.push_back(view);
  } else if (search.found.empty()) {
    if (sighting.markers > search.best.markers) {
      search.best = sighting;
    }
    if (search.in_vain++ % kLookForOthersEvery == 0) {
      look_for_others(grey, options.board, search);
    }
  }
}

void show_progress(const Options& options, const Search& search, int64_t done, int64_t of, const char* unit) {
  if (!options.quiet && isatty(STDERR_FILENO) != 0) {
    std::fprintf(stderr, "\r%lld of %lld %s, board found %zu times, %.0f %% of the picture covered ",
                 static_cast<long long>(done), static_cast<long long>(of), unit, search.found.size(),
                 100.0 * covered_share(search.found, search.image));
    std::fputs(done == of ? "\n" : "", stderr);
  }
}

bool search_source(const Options& options, Search& search, std::string& error) {
  return platform::is_camera(options.source) ? search_camera(options, search, error)
                                             : search_sequence(options, search, error);
}

std::string why_nothing_was_found(const Options& options, const Search& search) {
  const auto size = [](int columns, int rows) { return std::to_string(columns) + " x " + std::to_string(rows); };
  const Board& board = options.board;
  const cv::Size& other = search.other_squares;
  const std::string nothing =
      options.source + ": the " + (board.target == Target::kCharuco ? "ChArUco board" : "chessboard") + " of " +
      size(board.columns, board.rows) + " squares is in none of " + std::to_string(search.looked_at) + " frames";
  if (search.found_mirrored) {
    return nothing +
           ", but its mirror image is: the camera mirrors its pictures; switch that off, or mirror them back "
           "(ffmpeg -vf hflip)";
  }
  const Sighting& best = search.best;
  if (search.found_other) {
    return nothing + ", but a ChArUco board is; use --target charuco";
  }
  if (best.highest_marker >= board.markers()) {
    return nothing + ", but a board with markers up to number " + std::to_string(best.highest_marker) +
           " is, and this one ends with " + std::to_string(board.markers() - 1) +
           "; does --board say what was printed?";
  }
  if (best.pairs >= 4 && best.agreeing_pairs < best.pairs / 2) {
    return nothing + ", but markers in another order are; does --board say what was printed?";
  }
  if (best.markers > 0) {
    return nothing + "; at most " + std::to_string(best.markers) +
           " markers were seen at once: show more of the board, nearer, sharper, or in better light";
  }
  if (other.area() > 0 && (board.target == Target::kCharuco || other.area() != board.columns * board.rows)) {
    return nothing + ", but a chessboard of " + size(other.width, other.height) +
           " squares is; use --target chessboard --board " + std::to_string(other.width) + "x" +
           std::to_string(other.height) + ":SQUARE_METRES";
  }
  if (board.target == Target::kCharuco) {
    return nothing + "; is it sharp and near enough? A plain chessboard needs --target chessboard";
  }
  return nothing + "; all of it must be seen, with its white margin. Does --board say what was printed?";
}

}  // namespace pf::calibrate
