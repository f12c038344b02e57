// Fields of calibrations that no form has: those that may change what others mean, hints, notes, and files of several cameras.
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <vector>

#include "calibration_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

const std::string kEuroc =
    "sensor_type: camera\nrate_hz: 20\nresolution: [320, 240]\ncamera_model: pinhole\nintrinsics: [200, 201, 160, "
    "120]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [-0.1, 0.01, 0, 0]\n";

std::string kalibr_camera(const std::string& name, double fx) {
  return name + ":\n  camera_model: pinhole\n  distortion_coeffs: [-0.1, 0.01, 0, 0]\n  distortion_model: radtan\n" +
         "  intrinsics:\n  - " + std::to_string(fx) + "\n  - 201\n  - 160\n  - 120\n  resolution: [320, 240]\n";
}

const std::string kChain = kalibr_camera("cam0", 200) + kalibr_camera("cam1", 210) +
                           "  T_cn_cnm1:\n  - [1, 0, 0, -0.1]\n  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(text.empty() ? 0 : 1);
  for (const char c : text) {
    if (c == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }
  return lines;
}

}  // namespace

static void test_field_should_be_refused_when_it_may_change_what_others_mean() {
  for (const char* field : {"fisheye_model: 1", "fisheye: true", "lens_model: omni", "xi: 0.9", "skew: 2.5", "k4: 0.1",
                            "tangential_p3: 0.2", "thin_prism: [0, 0, 1e-3]", "binning_x: 2", "image_scale: 0.5",
                            "roi: {x_offset: 4, y_offset: 0}", "rectified: 1", "units: mm", "half_resolution: yes",
                            "rotated: 90", "projection: equisolid", "distortion_extra: [1, 2]"}) {
    const std::string key = std::string(field).substr(0, std::string(field).find(':'));
    require_refused(kEuroc + field + "\n", "'" + key + "'");
    require_refused(replaced(kChain, "  camera_model", "  " + std::string(field) + "\n  camera_model"),
                    "'cam0." + key + "'");
  }
}

static void test_field_should_be_ignored_with_a_note_when_its_value_changes_nothing() {
  for (const char* field : {"fisheye_model: 0", "fisheye: false", "lens_model: pinhole", "xi: 0.0", "skew: 0", "k4: 0",
                            "thin_prism: [0, 0, 0]", "binning_x: 1", "image_scale: 1.0", "roi: {x_offset: 0, width: 0}",
                            "rectified: no", "units: px", "zoom: 2", "lens: 8 mm", "depth_scale: 1000"}) {
    const std::string key = std::string(field).substr(0, std::string(field).find(':'));
    TEST_ASSERT_EQUAL_DOUBLE(200.0, camera_of(kEuroc + field + "\n", nullptr, ("'" + key + "'").c_str()).fx);
  }
}

static void test_hint_should_be_given_only_when_it_would_be_accepted() {
  const auto hint = [](const std::string& text, const std::string& part) { return require_refused(text, part); };
  const std::string misspelled = hint(replaced(kEuroc, "resolution:", "resolutoin:"), "'resolutoin'");
  require_message(misspelled.c_str(), "is 'resolution' meant?");
  // Both are wrong, and right when both are mended.
  require_message(
      hint(replaced(replaced(kEuroc, "resolution:", "resolutoin:"), "intrinsics:", "intrinsic:"), "meant?").c_str(),
      "is '");
  for (const std::string& text :
       {kEuroc + "resolutoin: [320, 240]\n",                                              // the right one is there
        replaced(kEuroc, "rate_hz: 20", "rate: fast"),                                    // its value would be refused
        replaced(kEuroc, "rate_hz: 20", "readout_ms: 30"),                                // in other units
        replaced(replaced(kEuroc, "resolution:", "resolutoin:"), "200, 201", "0, 0")}) {  // something else is wrong
    const ReadCalibration read = parse(text);
    TEST_ASSERT_TRUE_MESSAGE(read.result != 0 || std::strstr(read.message, "ignored") != nullptr, read.message);
    TEST_ASSERT_NULL_MESSAGE(std::strstr(read.message, "meant?"), read.message);
  }
  require_message(hint(kEuroc + "skew: 2\n", "'skew'").c_str(), "remove it");
  const std::string broken = hint(replaced(kEuroc, "200, 201", "0, 0") + "skew: 2\n", "'skew'");
  TEST_ASSERT_NULL_MESSAGE(std::strstr(broken.c_str(), "remove"), broken.c_str());
}

static void test_numbers_that_no_lens_is_likely_to_have_should_get_a_note() {
  const struct {
    const char* numbers;
    const char* part;
  } doubted[] = {{"200, 201, 120, 160", "are cx and cy exchanged?"},
                 {"200, 201, 310, 120", "is it the calibration of these images?"},
                 {"200, 201, 0, 0", "the principal point 0, 0 is far from the middle of 320 x 240 px"},
                 {"200, 266, 160, 120", "fx 200 and fy 266 differ by 24.8 %"},
                 {"200, 150, 160, 120", "pixels are not square"}};
  for (const auto& one : doubted) {
    camera_of(replaced(kEuroc, "200, 201, 160, 120", one.numbers), nullptr, one.part);
  }
  const ReadCalibration exchanged = parse(replaced(kEuroc, "200, 201, 160, 120", "160, 120, 200, 201"));
  TEST_ASSERT_EQUAL_INT(0, exchanged.result);
  TEST_ASSERT_EQUAL_size_t(2, lines_of(exchanged.message).size());
  for (const char* likely : {"200, 201, 160, 120", "517.3, 516.5, 170.6, 127.3", "200, 201.9, 140, 140"}) {
    TEST_ASSERT_EQUAL_STRING("", parse(replaced(kEuroc, "200, 201, 160, 120", likely)).message);
  }
}

static void test_notes_should_each_have_a_line() {
  const std::string text = "lens: 8 mm\n" + replaced(kChain, "  camera_model", "  serial: 12\n  camera_model");
  const ReadCalibration read = parse(text);
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, read.result, read.message);
  const std::vector<std::string> lines = lines_of(read.message);
  TEST_ASSERT_EQUAL_size_t(3, lines.size());
  require_message(lines[0].c_str(), "'lens'");
  require_message(lines[1].c_str(), "cam0 and cam1");
  require_message(lines[2].c_str(), "'cam0.serial'");
}

static void test_notes_should_be_whole_lines_and_a_count_when_they_do_not_fit() {
  const std::string name(PF_SEQUENCE_MESSAGE / 2, 'n');
  const std::string text = "lens: 8 mm\n" + replaced(kChain, "  camera_model", "  serial: 12\n  camera_model");
  pf_camera_t camera;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT(0, pf_parse_calibration(text.data(), text.size(), name.c_str(), &camera, nullptr, message));
  const std::vector<std::string> lines = lines_of(message);
  TEST_ASSERT_EQUAL_size_t(2, lines.size());
  require_message(lines[0].c_str(), "'lens'");
  TEST_ASSERT_EQUAL_STRING("2 more notes do not fit here", lines[1].c_str());
}

static void test_sequence_should_tell_its_own_notes_and_those_of_its_calibration() {
  TemporaryFolder folder;
  folder.write("sensor.yaml",
               "resolution: [32, 32]\ncamera_model: pinhole\nintrinsics: [30, 30, 16, 16]\nserial: 9\n"
               "distortion_model: radial-tangential\ndistortion_coefficients: [-0.1, 0.01, 0, 0]\n");
  folder.write("a.png", grey_png(1));
  const Opened opened("images:" + folder.path());
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  const std::vector<std::string> lines = lines_of(opened.info.warning);
  TEST_ASSERT_EQUAL_size_t_MESSAGE(2, lines.size(), opened.info.warning);
  require_message(lines[0].c_str(), "no times.txt");
  require_message(lines[1].c_str(), "'serial'");
}

static void test_camera_should_be_chosen_by_name_or_number_and_else_be_the_first_with_a_note() {
  const char* note = "has the cameras cam0 and cam1; that of cam0 is taken";
  TEST_ASSERT_EQUAL_DOUBLE(200.0, camera_of(kChain, nullptr, note).fx);
  TEST_ASSERT_EQUAL_DOUBLE(210.0, camera_of(kChain, "cam1").fx);
  TEST_ASSERT_EQUAL_DOUBLE(210.0, camera_of(kChain, "1").fx);
  TEST_ASSERT_EQUAL_DOUBLE(200.0, camera_of(kalibr_camera("cam1", 200)).fx);
  require_refused(kChain, "cam0 and cam1", "2");
  require_refused(kChain, "cam0 and cam1", "am1");
  require_refused(kEuroc, "--camera", "1");
  // What is wrong in another camera is no matter.
  const std::string other = replaced(kChain, "radtan", "fov");
  TEST_ASSERT_EQUAL_DOUBLE(210.0, camera_of(other, "cam1").fx);
  require_refused(other, "'cam0.distortion_model'", "cam0");
}

static void test_camera_should_be_chosen_in_the_forms_that_have_several() {
  std::string orb = "Camera.type: PinHole\nCamera.width: 320\nCamera.height: 240\n";
  for (const char* prefix : {"Camera1.", "Camera2."}) {
    for (const char* field : {"fx: 200", "fy: 200", "cx: 160", "cy: 120", "k1: 0.1", "k2: 0", "p1: 0", "p2: 0"}) {
      orb += prefix + std::string(field) + "\n";
    }
  }
  orb = replaced(orb, "Camera2.fx: 200", "Camera2.fx: 210");
  TEST_ASSERT_EQUAL_DOUBLE(200.0, camera_of(orb, nullptr, "Camera1 and Camera2").fx);
  TEST_ASSERT_EQUAL_DOUBLE(210.0, camera_of(orb, "2").fx);
  require_refused(replaced(orb, "Camera2.k1: 0.1", "Camera2.k5: 0.1"), "'Camera2.k5'", "Camera2");
  const std::string colmap = "7 PINHOLE 320 240 200 200 160 120\n9 PINHOLE 320 240 210 210 160 120\n";
  TEST_ASSERT_EQUAL_DOUBLE(200.0, camera_of(colmap, nullptr, "camera 7 and camera 9").fx);
  TEST_ASSERT_EQUAL_DOUBLE(210.0, camera_of(colmap, "9").fx);
  require_refused(colmap + "9 PINHOLE 320 240 220 220 160 120\n", "twice", "9");
}

static void test_camera_should_be_the_one_that_the_folder_of_the_images_is_named_after() {
  const std::string small =
      replaced(replaced(replaced(kChain, "200.000000\n  - 201\n  - 160\n  - 120", "30\n  - 30\n  - 16\n  - 16"),
                        "210.000000\n  - 201\n  - 160\n  - 120", "31\n  - 31\n  - 16\n  - 16"),
               "[320, 240]", "[32, 32]");
  const std::string chain = replaced(small, "[320, 240]", "[32, 32]");
  TemporaryFolder folder;
  folder.write("chain.yaml", chain);
  for (const char* name : {"cam0", "cam1", "other"}) {
    folder.write(name + std::string("/data.csv"), "1403636579763555584,a.png\n");
    folder.write(name + std::string("/data/a.png"), grey_png(3));
    const Opened opened("euroc:" + (folder / name), (folder / "chain.yaml").c_str());
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    const bool second = std::string(name) == "cam1";
    TEST_ASSERT_EQUAL_DOUBLE(second ? 31.0 : 30.0, opened.info.camera.fx);
    TEST_ASSERT_EQUAL_STRING(second ? "cam1" : "cam0", opened.info.camera_name);
    require_message(opened.info.warning, "cam0 and cam1");
  }
}

static void test_kitti_should_take_the_camera_of_the_folder() {
  TemporaryFolder folder;
  folder.write("calib.txt", "P0: 30.5 0 15.25 0 0 31 16 0 0 0 1 0\nP2: 33.5 0 15.25 4 0 33 16 0.1 0 0 1 0.002\n");
  folder.write("a.png", grey_png(1));
  folder.write("image_2/a.png", grey_png(1));
  const Opened first("images:" + folder.path());
  TEST_ASSERT_EQUAL_DOUBLE(30.5, first.info.camera.fx);
  TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(first.info.warning, "P0 and P2"), first.info.warning);
  const Opened third("images:" + (folder / "image_2"), (folder / "calib.txt").c_str());
  TEST_ASSERT_NOT_NULL_MESSAGE(third.sequence, third.message);
  TEST_ASSERT_EQUAL_DOUBLE(33.5, third.info.camera.fx);
}

static void test_calibration_should_be_found_beside_the_images_when_it_is_the_only_one() {
  const std::string colmap = "1 PINHOLE 32 32 30 30 16 16\n";
  TemporaryFolder folder;
  folder.write("images/a.png", grey_png(1));
  folder.write("images/b.png", grey_png(1));
  folder.write("times.txt", "0 1.0 a.png\n1 2.0 b.png\n");
  folder.write("target.yaml", "width: 0.2\nheight: 0.1\n");
  folder.write("cameras.txt", colmap);
  const std::string source = "images:" + folder.path();
  {
    const Opened opened(source);
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    TEST_ASSERT_EQUAL_STRING("colmap", opened.info.calibration_form);
    TEST_ASSERT_EQUAL_STRING("", opened.info.warning);
  }
  const std::string opencv =
      "%YAML:1.0\nimage_width: 32\nimage_height: 32\ncamera_matrix: [30, 0, 15.5, 0, 30, 15.5, 0, 0, 1]\n"
      "distortion_coefficients: [0, 0, 0, 0, 0]\n";
  folder.write("left.yml", opencv);
  TEST_ASSERT_NOT_NULL(Opened(source).sequence);  // the same numbers
  folder.write("left.yml", replaced(opencv, "[30, 0", "[33, 0"));
  const Opened several(source);
  TEST_ASSERT_NULL(several.sequence);
  require_message(several.message, "cameras.txt, left.yml");
  folder.write("calib.yaml", kPlainCalibration);
  const Opened named(source);
  TEST_ASSERT_NOT_NULL_MESSAGE(named.sequence, named.message);
  TEST_ASSERT_EQUAL_DOUBLE(30.5, named.info.camera.fx);
  require_message(named.info.warning, "cameras.txt, left.yml");
}

static void test_size_should_be_that_of_the_images_when_the_file_does_not_say_it() {
  TemporaryFolder folder;
  folder.write("a.png", grey_png(1));
  folder.write("K.yml", "%YAML:1.0\nK: [30, 0, 16, 0, 30, 16, 0, 0, 1]\nD: [0.01, 0, 0, 0]\nfisheye_model: 1\n");
  const Opened opened("images:" + folder.path());
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  TEST_ASSERT_EQUAL_STRING("opencv", opened.info.calibration_form);
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_EQUIDISTANT, opened.info.camera.model);
  TEST_ASSERT_EQUAL_INT(32, opened.info.camera.width);
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_field_should_be_refused_when_it_may_change_what_others_mean);
  RUN_TEST(test_field_should_be_ignored_with_a_note_when_its_value_changes_nothing);
  RUN_TEST(test_hint_should_be_given_only_when_it_would_be_accepted);
  RUN_TEST(test_numbers_that_no_lens_is_likely_to_have_should_get_a_note);
  RUN_TEST(test_notes_should_each_have_a_line);
  RUN_TEST(test_notes_should_be_whole_lines_and_a_count_when_they_do_not_fit);
  RUN_TEST(test_sequence_should_tell_its_own_notes_and_those_of_its_calibration);
  RUN_TEST(test_camera_should_be_chosen_by_name_or_number_and_else_be_the_first_with_a_note);
  RUN_TEST(test_camera_should_be_chosen_in_the_forms_that_have_several);
  RUN_TEST(test_camera_should_be_the_one_that_the_folder_of_the_images_is_named_after);
  RUN_TEST(test_kitti_should_take_the_camera_of_the_folder);
  RUN_TEST(test_calibration_should_be_found_beside_the_images_when_it_is_the_only_one);
  RUN_TEST(test_size_should_be_that_of_the_images_when_the_file_does_not_say_it);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
