// pf-calibrate --print-target FILE.pdf, then pf-calibrate --source images:DIR: a camera's calibration from views of a chessboard.
#include <planefold_platform/sequence.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "options.h"
#include "outputs.h"
#include "print_target.h"

namespace {

using namespace pf::calibrate;

struct CloseSequence {
  void operator()(pf_sequence_t* sequence) const { pf_close_sequence(sequence); }
};

int complain(const std::string& line) {
  std::fprintf(stderr, "pf-calibrate: %s\n", line.c_str());
  return 1;
}

/// Looks for the board in frames that lie evenly over the source.
bool search_source(const Options& options, Search& search, cv::Size& image_size, std::string& error) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  pf_sequence_t* opened = nullptr;
  if (pf_open_sequence(options.source.c_str(), PF_SEQUENCE_UNCALIBRATED, &opened, message) != 0) {
    error = message;
    return false;
  }
  const std::unique_ptr<pf_sequence_t, CloseSequence> sequence(opened);
  pf_sequence_info_t info;
  pf_get_sequence_info(sequence.get(), &info);
  image_size = {info.camera.width, info.camera.height};
  search.frames = info.count;
  search.looked_at = std::min(info.count, options.look_at);
  const bool show = !options.quiet && isatty(STDERR_FILENO) != 0;
  for (int64_t k = 0; k < search.looked_at; ++k) {
    View view;
    view.frame = search.looked_at > 1 ? k * (info.count - 1) / (search.looked_at - 1) : 0;
    pf_image_t image;
    if (pf_read_sequence_frame(sequence.get(), view.frame, &image, message) != 0) {
      error = message;
      return false;
    }
    const cv::Mat grey(image.height, image.width, CV_8U, const_cast<uint8_t*>(image.pixels),
                       static_cast<size_t>(image.stride));
    if (find_board(grey, options.board, view)) {
      search.found.push_back(view);
    }
    if (show) {
      std::fprintf(stderr, "\r%lld of %lld frames, board found in %zu ", static_cast<long long>(k + 1),
                   static_cast<long long>(search.looked_at), search.found.size());
    }
  }
  if (show) {
    std::fputc('\n', stderr);
  }
  return true;
}

void warn_about(const Fit& fit, double covered) {
  if (covered < 0.6) {
    std::printf(
        "warning: corners cover only %.0f %% of the picture; what lies outside is extrapolated. See coverage.png\n",
        100.0 * covered);
  }
  if (fit.sigma_px[0] > 0.002 * fit.camera.fx) {
    std::printf("warning: the focal length is known to %.1f %% only; add slanted views\n",
                100.0 * fit.sigma_px[0] / fit.camera.fx);
  }
}

int calibrate(const Options& options) {
  Search search;
  cv::Size image;
  std::string error;
  if (!search_source(options, search, image, error)) {
    return complain(error);
  }
  if (search.found.empty()) {
    return complain(options.source + ": the board of " + std::to_string(options.board.columns) + " x " +
                    std::to_string(options.board.rows) + " squares is in none of " + std::to_string(search.looked_at) +
                    " frames; all of it must be seen, with its white margin. Does --board say what was printed?");
  }
  Fit fit;
  const std::vector<View> views = choose_views(search.found, options.board, image, options.views);
  if (!fit_camera(views, options.board, image, options.model, fit, error) ||
      !write_outputs(options.out, options.board, search, fit, error)) {
    return complain(error);
  }
  std::vector<View> used;
  for (const FittedView& fitted : fit.views) {
    used.push_back(fitted.view);
  }
  const double covered = covered_share(used, image);
  std::printf("%zu views of %zu with the board, %.0f %% of the picture covered\n", used.size(), search.found.size(),
              100.0 * covered);
  std::printf("fx %.3f  fy %.3f  cx %.3f  cy %.3f px\n", fit.camera.fx, fit.camera.fy, fit.camera.cx, fit.camera.cy);
  std::printf("reprojection error %.4f px; %s/calib.yaml\n", fit.rms_px, options.out.c_str());
  warn_about(fit, covered);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  int code = 0;
  if (!parse_options(argc, argv, options, code)) {
    return code;
  }
  if (!options.print_target.empty()) {
    std::string error;
    return print_target(options.board, options.page, options.print_target, error) ? 0 : complain(error);
  }
  return calibrate(options);
}
