#include "options.h"

#include <planefold_platform/cameras.h>
#include <planefold_platform/version.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <vector>

#include "../../examples/capture/checked_options.h"
#include "markers.h"
#include "print_target.h"

namespace pf::calibrate {

namespace {

const std::map<std::string, Target> kTargets = {{"charuco", Target::kCharuco}, {"chessboard", Target::kChessboard}};
const std::map<std::string, pf_camera_model_t> kModels = {
    {"pinhole", PF_CAMERA_PINHOLE}, {"radtan", PF_CAMERA_RADTAN}, {"equidistant", PF_CAMERA_EQUIDISTANT}};

}  // namespace

bool parse_options(int argc, char** argv, Options& options, int& code) {
  CLI::App app(
      "Calibrate a camera from views of a printed board of squares.\n"
      "First:  pf-calibrate --print-target target.pdf, print at 100 %, glue it onto something flat.\n"
      "Then film it: near and far, into every corner of the picture, slanted by up to 45 degrees, held still now and "
      "then.\n"
      "        Of a ChArUco board any part will do; of a chessboard all of it must be in the picture.\n"
      "Then:   pf-calibrate --source images:DIR --out out/calibrate, and give out/calibrate/calib.yaml to pf-capture "
      "--calib.\n",
      "pf-calibrate");
  std::string board = "10x7:0.025";
  std::string target = target_name(have_markers() ? Target::kCharuco : Target::kChessboard), model = "radtan";
  app.set_version_flag("--version", "pf-calibrate " PF_VERSION_TEXT);
  app.add_option("--source", options.source,
                 "video:FILE, images:DIR, euroc:DIR, tum:DIR (a calibration inside is not read), or a camera: "
                 "v4l2:/dev/videoN, libcamera:0");
  app.add_option("--target", target,
                 have_markers() ? "charuco (with a marker in every white square) or chessboard"
                                : "chessboard; this build has no charuco: it was made without OpenCV's aruco module")
      ->check(CLI::IsMember({"charuco", "chessboard"}))
      ->capture_default_str();
  app.add_option("--board", board, "COLUMNSxROWS:SQUARE_METRES, counted in squares")->capture_default_str();
  app.add_option("--model", model, "of the lens: pinhole, radtan, or equidistant for wide ones")
      ->check(CLI::IsMember({"pinhole", "radtan", "equidistant"}))
      ->capture_default_str();
  app.add_option("--out", options.out,
                 "folder for calib.yaml (Kalibr's form), calibration.json, corners.csv and coverage.png")
      ->capture_default_str();
  app.add_option(
         "--mask", options.mask,
         "PNG of the pictures' size, 0 where they do not show the scene (the carrier's body), else 255: corners "
         "there do not count;\nauto: mask.png beside the frames, where there is one; or none")
      ->capture_default_str();
  app.add_option("--views", options.views, "fit at most N views, the ones that differ most")
      ->check(pf::capture::whole_number_in(6, 200))
      ->capture_default_str();
  app.add_option("--look-at", options.look_at, "search at most N frames for the board, evenly over the source")
      ->check(pf::capture::whole_number_in(6, 100000))
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "watch the camera for so long, or until Ctrl-C")
      ->check(pf::capture::whole_number_in(5, 3600))
      ->capture_default_str();
  std::vector<int> size = {options.width, options.height};
  app.add_option("--size", size, "of the camera's pictures: width and height, those that will be tracked")
      ->expected(2)
      ->check(pf::capture::whole_number_in(32, 4096))
      ->capture_default_str();
  app.add_option("--print-target", options.print_target,
                 "write the board to this PDF, at true size, and end; FILE.png: a picture of 10 pixels per millimetre");
  app.add_option("--page", options.page, "of the PDF: a4, a3, letter, or WIDTHxHEIGHT in millimetres")
      ->capture_default_str();
  app.add_flag("--quiet", options.quiet, "no progress");
  app.set_version_flag("--version", "pf-calibrate " + std::to_string(PF_VERSION_MAJOR) + "." +
                                        std::to_string(PF_VERSION_MINOR) + "." + std::to_string(PF_VERSION_PATCH));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    code = app.exit(done);
    return false;
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "pf-calibrate: %s; see pf-calibrate --help\n", capture::what_is_wrong(app, error).c_str());
    code = 2;
    return false;
  }
  options.width = size[0];
  options.height = size[1];
  options.model = kModels.at(model);
  options.board.target = kTargets.at(target);
  if (options.board.target == Target::kCharuco && !have_markers()) {
    std::fprintf(stderr,
                 "pf-calibrate: --target charuco: this build has no markers; install OpenCV's aruco module (Debian: "
                 "libopencv-contrib-dev) and build again, or use --target chessboard\n");
    code = 2;
    return false;
  }
  std::string error;
  if (!parse_board(board, options.board, error)) {
    std::fprintf(stderr, "pf-calibrate: %s\n", error.c_str());
    code = 2;
    return false;
  }
  if (options.source.empty() == options.print_target.empty()) {
    std::fprintf(stderr, "pf-calibrate: give either --source or --print-target; see --help\n");
    code = 2;
    return false;
  }
  const std::string kind = options.source.substr(0, options.source.find(':') + 1);
  if (!options.source.empty() && kind != "images:" && kind != "euroc:" && kind != "tum:" && kind != "video:" &&
      !platform::is_camera(options.source)) {
    std::fprintf(stderr,
                 "pf-calibrate: source '%s': write video:FILE, images:DIR, euroc:DIR, tum:DIR, v4l2:/dev/videoN or "
                 "libcamera:0\n",
                 options.source.c_str());
    code = 2;
    return false;
  }
  double width_mm = 0.0, height_mm = 0.0;
  if (!page_size(options.page, width_mm, height_mm)) {
    std::fprintf(stderr, "pf-calibrate: --page %s: write a4, a3, letter, or WIDTHxHEIGHT in millimetres, 50 to 5000\n",
                 options.page.c_str());
    code = 2;
    return false;
  }
  const std::string& path = options.print_target;
  const std::string end = path.size() > 4 ? path.substr(path.size() - 4) : "";
  if (!path.empty() && end != ".pdf" && end != ".png") {
    std::fprintf(stderr, "pf-calibrate: --print-target %s: write a path that ends in .pdf or .png\n", path.c_str());
    code = 2;
    return false;
  }
  return true;
}

}  // namespace pf::calibrate
