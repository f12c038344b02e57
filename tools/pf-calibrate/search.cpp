#include "search.h"

#include <planefold_platform/sequence.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "markers.h"

#ifdef PLANEFOLD_HAVE_V4L2
#include <planefold_platform/v4l2.h>

#include <chrono>
#include <csignal>
#endif

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
  const cv::Size squares = size_of_chessboard(grey);
  if (squares.area() > search.other_squares.area()) {
    search.other_squares = squares;
  }
}

void look_at(const pf_image_t& image, const Options& options, int64_t number, Search& search) {
  const cv::Mat grey(image.height, image.width, CV_8U, const_cast<uint8_t*>(image.pixels),
                     static_cast<size_t>(image.stride));
  View view;
  Sighting sighting;
  view.frame = number;
  if (find_board(grey, options.board, view, sighting)) {
    search.found.push_back(view);
  } else if (search.found.empty()) {
    if (sighting.markers > search.best.markers) {
      search.best = sighting;
    }
    if (search.looked_at_one_by_one++ % kLookForOthersEvery == 0) {
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
  search.frames = info.count;
  search.looked_at = std::min(info.count, options.look_at);
  for (int64_t k = 0; k < search.looked_at; ++k) {
    const int64_t number = search.looked_at > 1 ? k * (info.count - 1) / (search.looked_at - 1) : 0;
    pf_image_t image;
    if (pf_read_sequence_frame(sequence.get(), number, &image, message) != 0) {
      error = message;
      return false;
    }
    look_at(image, options, number, search);
    show_progress(options, search, k + 1, search.looked_at, "frames");
  }
  return true;
}

#ifdef PLANEFOLD_HAVE_V4L2
volatile std::sig_atomic_t interrupted = 0;

struct CloseCamera {
  void operator()(pf_v4l2_t* camera) const { pf_v4l2_close(camera); }
};

bool search_camera(const std::string& path, const Options& options, Search& search, std::string& error) {
  char message[PF_V4L2_MESSAGE] = "";
  pf_v4l2_options_t wanted;
  pf_v4l2_options_default(&wanted);
  wanted.width = options.width;
  wanted.height = options.height;
  wanted.lock_focus = 1;  // another focus is another camera
  wanted.hand_over = PF_V4L2_COPIED;
  pf_v4l2_t* opened = nullptr;
  if (pf_v4l2_open(path.empty() ? nullptr : path.c_str(), &wanted, &opened, message) != 0) {
    error = message;
    return false;
  }
  const std::unique_ptr<pf_v4l2_t, CloseCamera> camera(opened);
  if (pf_v4l2_start(camera.get(), message) != 0) {
    error = message;
    return false;
  }
  std::signal(SIGINT, [](int) { interrupted = 1; });
  const auto begin = std::chrono::steady_clock::now();
  for (int64_t seconds = 0; seconds < options.seconds && interrupted == 0;) {
    pf_v4l2_frame_t frame;
    const int read = pf_v4l2_read(camera.get(), 200, &frame, message);
    if (read == PF_V4L2_FRAME) {
      search.image = {frame.image.width, frame.image.height};
      ++search.frames;
      ++search.looked_at;
      look_at(frame.image, options, frame.sequence, search);
      pf_v4l2_release(camera.get(), &frame);
    } else if (read != PF_V4L2_NOTHING) {
      error = read == PF_V4L2_GONE ? "the camera was unplugged" : message;
      return false;
    }
    const auto passed = std::chrono::steady_clock::now() - begin;
    seconds = std::chrono::duration_cast<std::chrono::seconds>(passed).count();
    show_progress(options, search, std::min(seconds, options.seconds), options.seconds, "seconds");
  }
  return true;
}
#endif

}  // namespace

bool search_source(const Options& options, Search& search, std::string& error) {
  if (options.source.rfind("v4l2:", 0) != 0) {
    return search_sequence(options, search, error);
  }
#ifdef PLANEFOLD_HAVE_V4L2
  return search_camera(options.source.substr(5), options, search, error);
#else
  error = "this build has no cameras: it was made without V4L2";
  return false;
#endif
}

std::string why_nothing_was_found(const Options& options, const Search& search) {
  const auto size = [](int columns, int rows) { return std::to_string(columns) + " x " + std::to_string(rows); };
  const Board& board = options.board;
  const cv::Size& other = search.other_squares;
  const std::string nothing = options.source + ": the " + target_name(board.target) + " of " +
                              size(board.columns, board.rows) + " squares is in none of " +
                              std::to_string(search.looked_at) + " frames";
  const Sighting& best = search.best;
  if (search.found_other) {
    return nothing + ", but a charuco board is; use --target charuco";
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
  if (other.area() > 0 && (board.target == Target::kCharuco || other != cv::Size(board.columns, board.rows))) {
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
