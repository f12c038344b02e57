// pf-calibrate on rendered views of its board: the camera comes back, and the error that it reports is the one that is there.
#include <planefold/planefold.h>

#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <planefold_platform/sequence.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "board_views.h"
#include "image_files.h"
#include "unity.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

constexpr int kSharpViews = 36, kBlurredViews = 6;

std::string program() {
  const char* bin = std::getenv("PLANEFOLD_BIN");
  return std::string(bin != nullptr ? bin : ".") + "/pf-calibrate";
}

/// Without OpenCV's aruco module the program has chessboards only, and says so.
bool knows_markers() {
  const bool known = std::system((program() + " --help | grep -q 'was made without'").c_str()) != 0;
  std::printf("%s", known ? "" : "pf-calibrate knows no markers: ChArUco is not tested\n");
  return known;
}

/// One number of calibration.json, whose keys are written once each.
double number_of(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const size_t at = text.find("\"" + key + "\": ");
  TEST_ASSERT_TRUE_MESSAGE(at != std::string::npos, key.c_str());
  return std::atof(text.c_str() + at + key.size() + 4);
}

struct Corners {
  double rms_px = 0.0;
  int frames = 0, last_frame = -1;
};

/// Root mean square distance of the corners that the program measured from where they truly are.
Corners against_truth(const std::string& path, const BoardCamera& camera, const std::vector<BoardPose>& poses,
                      bool named) {
  std::FILE* file = std::fopen(path.c_str(), "r");
  TEST_ASSERT_NOT_NULL(file);
  char line[256];
  TEST_ASSERT_NOT_NULL(std::fgets(line, sizeof(line), file));
  double squares = 0.0;
  int count = 0;
  Corners result;
  while (std::fgets(line, sizeof(line), file) != nullptr) {
    int frame = 0, corner = 0;
    double x = 0.0, y = 0.0;
    TEST_ASSERT_EQUAL_INT(4, std::sscanf(line, "%d,%d,%lf,%lf", &frame, &corner, &x, &y));
    TEST_ASSERT_LESS_THAN_INT(static_cast<int>(poses.size()), frame);
    result.frames += frame != result.last_frame ? 1 : 0;
    result.last_frame = frame;
    const BoardPose& pose = poses[static_cast<size_t>(frame)];
    squares += named ? camera.squared_distance_to_named_corner(pose, corner, x, y)
                     : camera.squared_distance_to_corner(pose, corner, x, y);
    ++count;
  }
  std::fclose(file);
  result.rms_px = std::sqrt(squares / count);
  return result;
}

/// What pf-calibrate prints, as a picture: the page with the board in its middle, cut to the board.
BoardPicture printed_target(const std::string& target, const TemporaryFolder& folder) {
  std::filesystem::create_directory(folder / "print");
  const std::string command = program() + " --target " + target + " --board 10x7:0.025 --page 297x210 --print-target " +
                              (folder / "print/0.png");
  TEST_ASSERT_EQUAL_INT(0, std::system(command.c_str()));
  char message[PF_SEQUENCE_MESSAGE] = "";
  pf_sequence_t* sequence = nullptr;
  TEST_ASSERT_EQUAL_INT_MESSAGE(
      0, pf_open_sequence(("images:" + (folder / "print")).c_str(), PF_SEQUENCE_UNCALIBRATED, &sequence, message),
      message);
  pf_image_t page;
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_read_sequence_frame(sequence, 0, &page, message), message);
  BoardPicture picture;
  picture.pixels_per_square = 1000 * kBoardSquare * page.width / 297.0;
  picture.width = static_cast<int>(kBoardColumns * picture.pixels_per_square);
  const int height = static_cast<int>(kBoardRows * picture.pixels_per_square);
  for (int y = 0; y < height; ++y) {
    const uint8_t* row = page.pixels + static_cast<ptrdiff_t>(y + (page.height - height) / 2) * page.stride;
    picture.pixels.insert(picture.pixels.end(), row + (page.width - picture.width) / 2,
                          row + (page.width - picture.width) / 2 + picture.width);
  }
  pf_close_sequence(sequence);
  return picture;
}

/// partial  a ChArUco board, part of which is out of nearly every picture, and the pictures' corners are covered
void check_recovers(const pf_camera_t& truth, const char* model, double noise_grey, bool partial) {
  constexpr uint64_t kSeed = 20;
  std::printf("%s, seed %d\n", model, static_cast<int>(kSeed));
  TemporaryFolder folder;
  BoardCamera camera(truth);
  BoardPicture picture;
  if (partial) {
    picture = printed_target("charuco", folder);
    camera.print(&picture);
    camera.cover_corners(truth.width / 8, truth.height / 8);
  }
  pf::SeededRandom random(kSeed);
  std::vector<BoardPose> poses;
  for (int i = 0; i < kSharpViews + kBlurredViews; ++i) {
    poses.push_back(partial ? camera.random_partial_pose(random) : camera.random_pose(random));
    char name[40];
    std::snprintf(name, sizeof(name), "images/%03d.pgm", i);
    const std::vector<uint8_t> pixels = camera.render(poses.back(), i < kSharpViews ? 1 : 9, noise_grey, random);
    folder.write(name, make_pgm(truth.width, truth.height, pixels));
  }
  const std::string out = folder / "out";
  const std::string command = program() + " --quiet --target " + (partial ? "charuco" : "chessboard") +
                              " --board 10x7:0.025 --model " + model + " --source images:" + folder.path() + " --out " +
                              out;
  TEST_ASSERT_EQUAL_INT(0, std::system(command.c_str()));

  pf_camera_t found;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_read_calibration((out + "/calib.yaml").c_str(), &found, nullptr, message),
                                message);
  TEST_ASSERT_EQUAL_INT32(truth.model, found.model);
  TEST_ASSERT_EQUAL_INT32(truth.width, found.width);
  std::printf("fx %.3f of %.3f, fy %.3f of %.3f, cx %.3f of %.3f, cy %.3f of %.3f\n", found.fx, truth.fx, found.fy,
              truth.fy, found.cx, truth.cx, found.cy, truth.cy);
  TEST_ASSERT_DOUBLE_WITHIN(0.001 * truth.fx, truth.fx, found.fx);
  TEST_ASSERT_DOUBLE_WITHIN(0.001 * truth.fy, truth.fy, found.fy);
  TEST_ASSERT_DOUBLE_WITHIN(0.5, truth.cx, found.cx);
  TEST_ASSERT_DOUBLE_WITHIN(0.5, truth.cy, found.cy);

  const Corners corners = against_truth(out + "/corners.csv", camera, poses, partial);
  const double reported = number_of(out + "/calibration.json", "reprojection_error_px");
  std::printf("reprojection error %.4f px, corners truly off by %.4f px, %d views\n", reported, corners.rms_px,
              corners.frames);
  TEST_ASSERT_DOUBLE_WITHIN(0.1 * corners.rms_px, corners.rms_px, reported);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(12, corners.frames);
  TEST_ASSERT_LESS_THAN_INT_MESSAGE(kSharpViews, corners.last_frame, "a blurred view was used");
}

pf_camera_t camera_of(pf_camera_model_t model, double fx, double fy, double cx, double cy,
                      const std::vector<double>& distortion) {
  pf_camera_t camera = {};
  camera.model = model;
  camera.width = 640;
  camera.height = 480;
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx;
  camera.cy = cy;
  std::copy(distortion.begin(), distortion.end(), camera.distortion);
  return camera;
}

void test_calibrate_should_recover_focal_lengths_and_noise_with_radial_and_tangential_distortion() {
  check_recovers(camera_of(PF_CAMERA_RADTAN, 503.2, 498.7, 326.1, 235.4, {-0.28, 0.08, 0.0004, -0.0003}), "radtan", 4,
                 false);
}

void test_calibrate_should_recover_focal_lengths_and_noise_of_a_wide_lens() {
  check_recovers(camera_of(PF_CAMERA_EQUIDISTANT, 261.3, 260.6, 317.4, 243.8, {-0.012, 0.006, -0.004, 0.001}),
                 "equidistant", 4, false);
}

void test_calibrate_should_do_with_parts_of_a_charuco_board() {
  check_recovers(camera_of(PF_CAMERA_RADTAN, 503.2, 498.7, 326.1, 235.4, {-0.28, 0.08, 0.0004, -0.0003}), "radtan", 4,
                 true);
}

void test_calibrate_should_do_with_parts_of_a_charuco_board_through_a_wide_lens() {
  check_recovers(camera_of(PF_CAMERA_EQUIDISTANT, 261.3, 260.6, 317.4, 243.8, {-0.012, 0.006, -0.004, 0.001}),
                 "equidistant", 4, true);
}

void test_calibrate_should_say_what_is_missing_when_the_board_is_in_no_frame() {
  TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) {
    folder.write("images/" + std::to_string(i) + ".pgm", make_pgm(320, 240, std::vector<uint8_t>(320 * 240, 90)));
  }
  const std::string log = folder / "log";
  const std::string command =
      program() + " --quiet --source images:" + folder.path() + " --out " + (folder / "out") + " 2> " + log;
  TEST_ASSERT_NOT_EQUAL_INT(0, std::system(command.c_str()));
  std::ifstream file(log);
  std::string line;
  TEST_ASSERT_TRUE(static_cast<bool>(std::getline(file, line)));
  TEST_ASSERT_TRUE_MESSAGE(line.find("none of 3 frames") != std::string::npos, line.c_str());
}

}  // namespace

int main() {
  if (access(program().c_str(), X_OK) != 0) {
    SKIP_PROGRAM("pf-calibrate is not built: it needs OpenCV's calib3d");
  }
  UNITY_BEGIN();
  RUN_TEST(test_calibrate_should_recover_focal_lengths_and_noise_with_radial_and_tangential_distortion);
  RUN_TEST(test_calibrate_should_recover_focal_lengths_and_noise_of_a_wide_lens);
  if (knows_markers()) {
    RUN_TEST(test_calibrate_should_do_with_parts_of_a_charuco_board);
    RUN_TEST(test_calibrate_should_do_with_parts_of_a_charuco_board_through_a_wide_lens);
  }
  RUN_TEST(test_calibrate_should_say_what_is_missing_when_the_board_is_in_no_frame);
  return UNITY_END();
}

#else
int main() { SKIP_PROGRAM("platform/sequence is not part of this tree"); }
#endif
