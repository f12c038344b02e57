// Folders of images: their layouts and times, and everything that can be wrong with them.
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <unistd.h>

#include <cstdio>

#include "sequence_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

void open_refused(const std::string& source, const std::string& part) {
  Opened opened(source);
  TEST_ASSERT_NULL_MESSAGE(opened.sequence, source.c_str());
  require_message(opened.message, part);
}

}  // namespace

static void test_images_folder_should_give_frames_with_exact_times() {
  TemporaryFolder folder;
  folder.write("calib.yaml", kPlainCalibration);
  folder.write("times.txt", "# index seconds name\n0 1403636579.763556001 a.png\n1 1403636579.8135550009999 b.pgm\r\n");
  folder.write("images/a.png", grey_png(7));
  folder.write("images/b.pgm", make_pgm(32, 32, flat(1024, 9)));
  folder.write("groundtruth.tum", "# none\n");
  Opened opened("images:" + folder.path());
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  TEST_ASSERT_EQUAL_INT64(2, opened.info.count);
  TEST_ASSERT_EQUAL_STRING("", opened.info.warning);
  TEST_ASSERT_EQUAL_STRING((folder / "groundtruth.tum").c_str(), opened.info.truth_path);
  TEST_ASSERT_EQUAL_STRING("plain", opened.info.calibration_form);
  const pf_image_t a = opened.read(0);
  TEST_ASSERT_EQUAL_INT64(1403636579763556001, a.t_ns);
  TEST_ASSERT_EQUAL_UINT8(7, a.pixels[1023]);
  const pf_image_t b = opened.read(1);
  TEST_ASSERT_EQUAL_INT64(1403636579813555001, b.t_ns);
  TEST_ASSERT_EQUAL_UINT8(9, b.pixels[0]);
}

static void test_images_folder_should_warn_and_use_the_rate_when_it_has_no_times() {
  TemporaryFolder folder;
  folder.write("calib.yaml", kPlainCalibration);
  for (const char* name : {"f10.png", "f9.png", "f2.PNG", "notes.txt"}) {
    folder.write(name, grey_png(1));
  }
  Opened opened("images:" + folder.path());
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  TEST_ASSERT_EQUAL_INT64(3, opened.info.count);
  require_message(opened.info.warning, "times.txt");
  TEST_ASSERT_EQUAL_STRING((folder / "f2.PNG").c_str(), pf_get_sequence_frame_path(opened.sequence, 0));
  TEST_ASSERT_EQUAL_STRING((folder / "f10.png").c_str(), pf_get_sequence_frame_path(opened.sequence, 2));
  TEST_ASSERT_EQUAL_INT64(100000000, opened.read(2).t_ns);
}

static void test_images_folder_should_be_refused_when_it_holds_several_cameras() {
  const auto opens = [](const char* name, const char* other, int numbers, std::string& said) {
    TemporaryFolder folder;
    folder.write("calib.yaml", kPlainCalibration);
    for (int frame = 0; frame < 6; ++frame) {
      for (int i = 0; i < numbers; ++i) {
        char text[64];
        std::snprintf(text, sizeof(text), i % 2 == 0 ? name : other, frame, i);
        folder.write(text, grey_png(1));
      }
    }
    Opened opened("images:" + folder.path());
    said = opened.message;
    return opened.sequence != nullptr;
  };
  std::string said;
  for (const char* name : {"%06d_%d.png", "f%06d-1%d.png", "%03d_cam%d.png"}) {
    TEST_ASSERT_FALSE_MESSAGE(opens(name, name, 2, said), name);
    require_message(said.c_str(), "of several cameras");
  }
  TEST_ASSERT_FALSE(opens("cam0_%06d.png", "cam1_%06d.png", 2, said));
  require_message(said.c_str(), "cam0_000000.png, cam1_000005.png");
  // Times in seconds, and counts that begin anew.
  for (const char* name : {"%d.%d.png", "%06d.png", "%d.5%d.png"})
    TEST_ASSERT_TRUE_MESSAGE(opens(name, name, 2, said), said.c_str());
  TEST_ASSERT_TRUE_MESSAGE(opens("%d_%02d.png", "%d_%02d.png", 12, said), said.c_str());
}

static void test_euroc_should_open_from_any_of_its_folders() {
  TemporaryFolder folder;
  folder.write("mav0/cam0/sensor.yaml",
               "resolution: [32, 32]\ncamera_model: pinhole\nintrinsics: [30, 30, 16, 16]\nrate_hz: 20\n"
               "distortion_model: radial-tangential\ndistortion_coefficients: [-0.1, 0.01, 0, 0]\n");
  folder.write("mav0/cam0/data.csv",
               "#timestamp [ns],filename\r\n1403636579763555584,a.png\r\n1403636579813555456,b.png\r\n");
  folder.write("mav0/cam0/data/a.png", grey_png(3));
  folder.write("mav0/cam0/data/b.png", grey_png(4));
  folder.write("mav0/state_groundtruth_estimate0/data.csv", "0,0,0,0,1,0,0,0\n");
  for (const char* below : {"", "/mav0", "/mav0/cam0"}) {
    Opened opened("euroc:" + folder.path() + below);
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    TEST_ASSERT_EQUAL_STRING((folder / "mav0/state_groundtruth_estimate0/data.csv").c_str(), opened.info.truth_path);
    TEST_ASSERT_EQUAL_INT64(1403636579813555456, opened.read(1).t_ns);
    TEST_ASSERT_EQUAL_STRING("euroc", opened.info.calibration_form);
  }
}

static void test_eth3d_should_open_with_its_calibration_and_truth() {
  TemporaryFolder folder;
  folder.write("calibration.txt", "30.5 31 15.25 16\n");
  folder.write("rgb.txt",
               "# color images\n4917.101 rgb/4917.101.png\n4917.138 rgb/4917.138.png\n4917.175 rgb/4917.175.png\n");
  folder.write("groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n4917.101 0 0 0 0 0 0 1\n");
  for (const char* name : {"4917.101", "4917.138", "4917.175"}) {
    folder.write("rgb/" + std::string(name) + ".png", grey_png(7));
  }
  {
    Opened opened("tum:" + folder.path());
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    TEST_ASSERT_EQUAL_STRING("", opened.info.warning);
    TEST_ASSERT_EQUAL_STRING("eth3d", opened.info.calibration_form);
    TEST_ASSERT_EQUAL_INT64(3, opened.info.count);
    TEST_ASSERT_EQUAL_INT(32, opened.info.camera.width);
    TEST_ASSERT_EQUAL_DOUBLE(31.0, opened.info.camera.fy);
    TEST_ASSERT_EQUAL_DOUBLE(15.25, opened.info.camera.cx);
    require_message(opened.info.truth_path, "groundtruth.txt");
  }
  folder.write("calibration.txt", "# fx fy cx cy\n30.5, 31, 15.25, 99\n");
  open_refused("tum:" + folder.path(), "'fx fy cx cy'");
  folder.write("calibration.txt", "30.5 31 15.25\n");
  open_refused("tum:" + folder.path(), "fx fy cx cy");
  folder.write("calibration.txt", "30.5 31 15.25 nan\n");
  open_refused("tum:" + folder.path(), "'fx fy cx cy'");
}

static void test_kitti_should_open_with_the_size_of_its_images() {
  TemporaryFolder folder;
  folder.write("calib.txt", "P0: 30.5 0 15.25 0 0 31 16 0 0 0 1 0\nP1: 30.5 0 15.25 -16 0 31 16 0 0 0 1 0\n");
  folder.write("times.txt", "0.000000e+00\n1.036224e-01\n2.072484e-01\n");
  for (int i = 0; i < 3; ++i) {
    folder.write("image_0/00000" + std::to_string(i) + ".png", grey_png(static_cast<uint8_t>(i)));
    folder.write("image_1/00000" + std::to_string(i) + ".png", grey_png(9));
  }
  Opened opened("images:" + folder.path());
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  TEST_ASSERT_EQUAL_STRING("", opened.info.warning);
  TEST_ASSERT_EQUAL_STRING("kitti", opened.info.calibration_form);
  TEST_ASSERT_EQUAL_INT64(3, opened.info.count);
  TEST_ASSERT_EQUAL_INT(32, opened.info.camera.width);
  TEST_ASSERT_EQUAL_INT(32, opened.info.camera.height);
  TEST_ASSERT_EQUAL_DOUBLE(31.0, opened.info.camera.fy);
  TEST_ASSERT_EQUAL_INT64(207248400, opened.read(2).t_ns);
  TEST_ASSERT_EQUAL_UINT8(2, opened.read(2).pixels[0]);
  folder.write("times.txt", "0.000000e+00\n1.036224e-01\n");
  open_refused("images:" + folder.path(), "2 times for 3 images");
  folder.write("times.txt", "0.000000e+00\n1.036224e-01\n1.036224e-01\n");
  open_refused("images:" + folder.path(), "line 3: the time 1.036224e-01 repeats");
  folder.write("times.txt", "0.000000e+00\n1.036224e-01\ninf\n");
  open_refused("images:" + folder.path(), "line 3");
  folder.write("times.txt", "0.000000e+00\n1.036224e-01\n2.072484e-01\n");
  folder.write("calib.txt", "P0: 30.5 0 15.25 0 0 31 99 0 0 0 1 0\n");
  open_refused("images:" + folder.path(), "'P0'");
}

static void test_tum_should_open_with_a_calibration_that_is_given() {
  TemporaryFolder folder;
  folder.write("rgb.txt", "# color images\n1305031102.175304 rgb/1305031102.175304.png\n");
  folder.write("rgb/1305031102.175304.png", make_png(32, 32, 8, 2, flat(3072, 200)));
  folder.write("given.yaml", kPlainCalibration);
  Opened without("tum:" + folder.path());
  TEST_ASSERT_NULL(without.sequence);
  require_message(without.message, "--calib");
  Opened opened("tum:" + folder.path(), (folder / "given.yaml").c_str());
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  const pf_image_t image = opened.read(0);
  TEST_ASSERT_EQUAL_INT64(1305031102175304000, image.t_ns);
  TEST_ASSERT_EQUAL_UINT8(200, image.pixels[5]);
}

static void test_times_should_be_refused_when_they_repeat_run_back_or_are_no_times() {
  const struct {
    const char *text, *part;
  } cases[] = {{"0 1.0 a.png\n1 1.0 b.png\n", "line 2: the time 1.0 repeats"},
               {"0 1.0 a.png\n1 0.9 b.png\n", "line 2: the time 0.9 runs back"},
               {"0 nan a.png\n", "line 1"},
               {"0 1e300 a.png\n", "line 1"},
               {"0 99999999999999999999 a.png\n", "line 1"},
               {"0 - a.png\n", "line 1"},
               {"a.png\n", "line 1"},
               {"0 1.0 ../../etc/passwd\n", "leaves"},
               {"0 1.0 /etc/passwd\n", "leaves"},
               {"# nothing\n", "no frame"},
               {"", "empty"}};
  for (const auto& c : cases) {
    TemporaryFolder folder;
    folder.write("calib.yaml", kPlainCalibration);
    folder.write("times.txt", c.text);
    folder.write("images/a.png", grey_png(1));
    open_refused("images:" + folder.path(), c.part);
    open_refused("images:" + folder.path(), "times.txt");
  }
}

static void test_source_should_be_refused_when_its_folder_is_missing_or_no_folder() {
  TemporaryFolder folder;
  folder.write("file", "x");
  folder.write("empty/calib.yaml", kPlainCalibration);
  open_refused("images:" + (folder / "none"), "no such folder");
  open_refused("images:" + (folder / "file"), "not a folder");
  open_refused("images:" + (folder / "empty"), "no PNG, JPEG or PGM");
  open_refused("images:" + folder.path(), "no calibration");
  open_refused("tum:" + folder.path(), "rgb.txt");
  open_refused("euroc:" + folder.path(), "data.csv");
  open_refused("film:" + folder.path(), "images:");
  open_refused("images:", "names no folder");
  open_refused("", "images:");
}

static void test_folder_should_be_refused_when_it_cannot_be_listed() {
  if (geteuid() == 0) {
    TEST_IGNORE_MESSAGE("root may list every folder");
  }
  TemporaryFolder folder;
  folder.write("closed/calib.yaml", kPlainCalibration);
  namespace fs = std::filesystem;
  fs::permissions(folder / "closed", fs::perms::none);
  open_refused("images:" + (folder / "closed"), "permissions");
  fs::permissions(folder / "closed", fs::perms::owner_all);
}

static void test_images_should_open_without_a_calibration_when_that_is_asked_for() {
  TemporaryFolder folder;
  folder.write("images/a.pgm", make_pgm(48, 36, flat(48 * 36, 5)));
  folder.write("images/b.pgm", make_pgm(32, 32, flat(1024, 5)));
  open_refused("images:" + folder.path(), "no calibration inside");
  Opened opened("images:" + folder.path(), PF_SEQUENCE_UNCALIBRATED);
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  TEST_ASSERT_EQUAL_INT32(48, opened.info.camera.width);
  TEST_ASSERT_EQUAL_INT32(36, opened.info.camera.height);
  TEST_ASSERT_EQUAL_STRING("none", opened.info.calibration_form);
  TEST_ASSERT_EQUAL_UINT8(5, opened.read(0).pixels[0]);
  pf_image_t image;
  TEST_ASSERT_EQUAL_INT(-1, pf_read_sequence_frame(opened.sequence, 1, &image, opened.message));
  require_message(opened.message, "32 x 32");
}

static void test_functions_should_refuse_when_a_pointer_is_null() {
  pf_sequence_t* sequence = nullptr;
  TEST_ASSERT_EQUAL_INT(-1, pf_open_sequence(nullptr, nullptr, &sequence, nullptr));
  TEST_ASSERT_EQUAL_INT(-1, pf_open_sequence("images:x", nullptr, nullptr, nullptr));
  TEST_ASSERT_EQUAL_INT(-1, pf_read_sequence_frame(nullptr, 0, nullptr, nullptr));
  pf_close_sequence(nullptr);
  pf_get_sequence_info(nullptr, nullptr);
  TEST_ASSERT_EQUAL_STRING("", pf_get_sequence_frame_path(nullptr, 0));
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_images_folder_should_give_frames_with_exact_times);
  RUN_TEST(test_images_folder_should_warn_and_use_the_rate_when_it_has_no_times);
  RUN_TEST(test_images_folder_should_be_refused_when_it_holds_several_cameras);
  RUN_TEST(test_euroc_should_open_from_any_of_its_folders);
  RUN_TEST(test_eth3d_should_open_with_its_calibration_and_truth);
  RUN_TEST(test_kitti_should_open_with_the_size_of_its_images);
  RUN_TEST(test_tum_should_open_with_a_calibration_that_is_given);
  RUN_TEST(test_times_should_be_refused_when_they_repeat_run_back_or_are_no_times);
  RUN_TEST(test_source_should_be_refused_when_its_folder_is_missing_or_no_folder);
  RUN_TEST(test_folder_should_be_refused_when_it_cannot_be_listed);
  RUN_TEST(test_images_should_open_without_a_calibration_when_that_is_asked_for);
  RUN_TEST(test_functions_should_refuse_when_a_pointer_is_null);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
