// pf-calibrate --print-target FILE.pdf, then pf-calibrate --source images:DIR: a camera's calibration from views of a
// board of squares.
#include <algorithm>
#include <cstdio>

#include "advice.h"
#include "options.h"
#include "outputs.h"
#include "print_target.h"
#include "search.h"

namespace {

using namespace pf::calibrate;

int complain(const std::string& line) {
  std::fprintf(stderr, "pf-calibrate: %s\n", line.c_str());
  return 1;
}

void warn_about(const Fit& fit, const Board& board) {
  const Verdict verdict = judge_fit(fit, board);
  for (const std::string& lack : verdict.lacks) {
    std::printf("warning: %s\n", lack.c_str());
  }
  std::printf("%s%s\n", verdict_line(verdict).c_str(), verdict.good ? "" : " (see also coverage.png)");
}

/// Boards that another version of OpenCV printed.
void tell_kind(const Fit& fit, const Board& board) {
  const auto light = std::count_if(fit.views.begin(), fit.views.end(),
                                   [](const FittedView& fitted) { return fitted.view.light_first; });
  if (board.target == Target::kCharuco && 2 * static_cast<size_t>(light) > fit.views.size()) {
    std::printf("the board begins with a white square, as OpenCV before 4.6 printed it\n");
  }
}

int calibrate(const Options& options) {
  Search search;
  std::string error;
  if (!check_outputs(options.out, options.source, error)) {
    return complain(error);
  }
  if (!search_source(options, search, error)) {
    return complain(error);
  }
  if (search.found.empty()) {
    return complain(why_nothing_was_found(options, search));
  }
  Fit fit;
  const std::vector<View> views = choose_views(search.found, options.board, search.image, options.views);
  if (!fit_camera(views, options.board, search.image, options.model, fit, error) ||
      !write_outputs(options.out, options.board, search, fit, error)) {
    return complain(error);
  }
  std::vector<View> used;
  for (const FittedView& fitted : fit.views) {
    used.push_back(fitted.view);
  }
  const double covered = covered_share(used, search.image);
  std::printf("%zu views of %zu with the board, %.0f %% of the picture covered\n", used.size(), search.found.size(),
              100.0 * covered);
  std::printf("fx %.3f  fy %.3f  cx %.3f  cy %.3f px\n", fit.camera.fx, fit.camera.fy, fit.camera.cx, fit.camera.cy);
  std::printf("reprojection error %.4f px; %s/calib.yaml\n", fit.rms_px, options.out.c_str());
  tell_kind(fit, options.board);
  warn_about(fit, options.board);
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
