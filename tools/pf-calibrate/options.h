#ifndef PLANEFOLD_CALIBRATE_OPTIONS_H
#define PLANEFOLD_CALIBRATE_OPTIONS_H

#include <planefold/planefold.h>

#include <cstdint>
#include <string>

#include "board.h"

namespace pf::calibrate {

struct Options {
  Board board;
  std::string source;
  std::string out = "out/calibrate";
  std::string mask = "auto";  ///< file; auto: the one beside the frames, if any; none: none
  std::string print_target;   ///< a file: write the target and do nothing else
  std::string page = "a4";
  pf_camera_model_t model = PF_CAMERA_RADTAN;
  int views = 40;                 ///< at most, in the fit
  int64_t look_at = 400;          ///< frames at most, evenly over the source
  int64_t seconds = 60;           ///< of a camera
  int width = 640, height = 480;  ///< of a camera's picture
  bool quiet = false;
};

/// true: options say what to do. false: code is the exit code, and help or one line on what was wrong has been printed.
bool parse_options(int argc, char** argv, Options& options, int& code);

}  // namespace pf::calibrate

#endif
