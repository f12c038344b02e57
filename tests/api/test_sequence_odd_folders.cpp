// Folders as people have them: files of other systems, two streams, previews, images of other bits or of an odd size.
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <cstdio>
#include <string>

#include "sequence_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

std::string numbered(const char* form, int number) {
  char text[128];
  std::snprintf(text, sizeof(text), form, number);
  return text;
}

void write_frames(const TemporaryFolder& folder, const char* form, int count) {
  folder.write("calib.yaml", kPlainCalibration);
  for (int i = 0; i < count; ++i) folder.write(numbered(form, i), grey_png(static_cast<uint8_t>(i)));
}

/// The folder is a sequence of so many frames, in the order of their levels, and a note says part.
void require_frames(const std::string& source, int count, const char* part) {
  Opened opened(source);
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  TEST_ASSERT_EQUAL_INT64(count, opened.info.count);
  for (int i = 0; i < count; ++i) TEST_ASSERT_EQUAL_INT(i, opened.read(i).pixels[0]);
  TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(opened.info.warning, part), opened.info.warning);
}

void require_refused(const std::string& source, const char* part, const std::string& remedy) {
  const Opened opened(source);
  TEST_ASSERT_NULL_MESSAGE(opened.sequence, source.c_str());
  require_message(opened.message, part);
  require_message(opened.message, remedy);
}

/// 32 x 32 numbers of 16 bits, from low to high.
Bytes ramp_of_16_bits(int low, int high) {
  Bytes rows;
  for (int i = 0; i < 1024; ++i) {
    const int value = low + (high - low) * i / 1023;
    rows.push_back(static_cast<uint8_t>(value >> 8));
    rows.push_back(static_cast<uint8_t>(value & 255));
  }
  return rows;
}

}  // namespace

static void test_files_of_other_systems_should_be_left_out_in_silence() {
  TemporaryFolder folder;
  write_frames(folder, "%04d.png", 5);
  for (const char* name : {"._0000.png", ".trashed-1700000000-IMG.png", ".0003.png.jpg", "Thumbs.db", ".DS_Store",
                           "desktop.ini", "0001.png.tmp", "@eaDir/0001.png", "__MACOSX/._0000.png"}) {
    folder.write(name, "no image");
  }
  require_frames("images:" + folder.path(), 5, "in the order of their names");
  TemporaryFolder below;
  write_frames(below, "rgb/%d.png", 12);
  for (const char* name : {"@eaDir/1.png", "__MACOSX/1.png", ".git/1.png", "rgb/._1.png"})
    below.write(name, "no image");
  require_frames("images:" + below.path(), 12, "(rgb/) those of rgb/ are taken");
}

static void test_two_streams_should_be_refused_with_what_to_type() {
  TemporaryFolder folder;
  write_frames(folder, "left_%06d.png", 6);
  write_frames(folder, "right_%06d.png", 6);
  require_refused("images:" + folder.path(), "side by side", "--source 'images:" + (folder / "left_*.png"));
  require_frames("images:" + (folder / "left_*.png"), 6, "");
  require_frames("images:" + (folder / "RIGHT_*.PNG"), 6, "");
  TemporaryFolder cameras;
  write_frames(cameras, "cam0_%06d.png", 6);
  write_frames(cameras, "cam1_%06d.png", 6);
  require_refused("images:" + cameras.path(), "several cameras", "--source 'images:" + (cameras / "cam0_*.png"));
  require_frames("images:" + (cameras / "cam1_*.png"), 6, "");
  require_refused("images:" + (cameras / "cam7_*.png"), "cam7_*.png", "check the path");
  TemporaryFolder formats;
  write_frames(formats, "%d.png", 6);
  write_frames(formats, "%d.jpg", 6);
  require_refused("images:" + formats.path(), "side by side", "--source 'images:");
  TemporaryFolder copied;  // what is proposed is the sequence, and not the copy of one of its images
  write_frames(copied, "%d.png", 6);
  copied.write("3 (copy).png", grey_png(3));
  require_refused("images:" + copied.path(), "side by side", "--source 'images:" + (copied / "*.png"));
  TemporaryFolder below;
  write_frames(below, "left/%d.png", 6);
  write_frames(below, "right/%d.png", 6);
  require_refused("images:" + below.path(), "several folders (left/, right/)", "--source images:" + (below / "left"));
  require_frames("images:" + (below / "left"), 6, (below / "calib.yaml: is taken").c_str());
}

static void test_previews_and_single_files_should_be_left_out_by_name() {
  TemporaryFolder folder;
  write_frames(folder, "%04d.png", 30);
  write_frames(folder, "thumb_%04d.png", 30);
  require_frames("images:" + folder.path(), 30, "thumb_#.png");
  TemporaryFolder single;
  write_frames(single, "%04d.png", 30);
  single.write("board.jpg", make_jpeg());
  single.write("overview 1.png", grey_png(200));
  require_frames("images:" + single.path(), 30,
                 "2 images left out, named otherwise than the sequence: board.jpg, overview 1.png");
  TemporaryFolder words;  // names without numbers are no series, and all are taken
  words.write("calib.yaml", kPlainCalibration);
  for (int i = 0; i < 3; ++i)
    words.write(std::string(1, static_cast<char>('a' + i)) + ".png", grey_png(static_cast<uint8_t>(i)));
  require_frames("images:" + words.path(), 3, "");
  TemporaryFolder parts;  // one recording in two series
  write_frames(parts, "part1_%02d.png", 9);
  require_frames("images:" + parts.path(), 9, "");
}

static void test_colour_images_of_kitti_should_be_taken_where_there_are_no_grey_ones() {
  TemporaryFolder folder;
  write_frames(folder, "image_2/%06d.png", 4);
  write_frames(folder, "image_3/%06d.png", 4);
  std::filesystem::remove(folder / "calib.yaml");
  folder.write("times.txt", "0.000000e+00\n1.0e-01\n2.0e-01\n3.0e-01\n");
  const std::string grey = "P0: 30.5 0 15.25 0 0 31 16 0 0 0 1 0\n";
  folder.write("calib.txt", grey + "P2: 30.5 0 15.25 7 0 31 16 0 0 0 1 0\n");
  require_frames("images:" + folder.path(), 4, "has no image_0; the colour images of image_2 are taken");
  folder.write("calib.txt", grey + "P2: 33.5 0 15.25 7 0 31 16 0 0 0 1 0\n");
  require_refused("images:" + folder.path(), "P2 of the colour images differs", "--calib");
}

static void test_kitti_raw_should_be_read_by_camera_with_the_calibration_above() {
  TemporaryFolder folder;
  std::string times;
  for (int i = 0; i < 4; ++i) {
    times += numbered("2011-09-26 13:02:25.%09d\n", 100000000 * i);
    for (const char* form : {"drive/image_00/data/%010d.png", "drive/image_02/data/%010d.png"})
      folder.write(numbered(form, i), grey_png(static_cast<uint8_t>(i)));
  }
  folder.write("drive/image_00/timestamps.txt", times);
  folder.write("drive/image_02/timestamps.txt", times);
  folder.write("calib_cam_to_cam.txt",
               "calib_time: 09-Jan-2012 13:57:47\nS_rect_00: 32 32\nP_rect_00: 30.5 0 15.25 0 0 31 16 0 0 0 1 0\n"
               "S_rect_02: 32 32\nP_rect_02: 33.5 0 15.25 7 0 34 16 0 0 0 1 0\n");
  require_refused("images:" + (folder / "drive"), "in image_00/data to image_02/data",
                  "--source images:" + (folder / "drive/image_00"));
  require_frames("images:" + (folder / "drive/image_00"), 4, "calib_cam_to_cam.txt: is taken");
  Opened colour("images:" + (folder / "drive/image_02"));
  TEST_ASSERT_NOT_NULL_MESSAGE(colour.sequence, colour.message);
  TEST_ASSERT_EQUAL_DOUBLE(33.5, colour.info.camera.fx);
  TEST_ASSERT_EQUAL_INT64(300000000, colour.read(3).t_ns - colour.info.first_t_ns);
}

static void test_other_formats_should_be_named_whatever_the_case_of_letters() {
  TemporaryFolder folder;
  folder.write("calib.yaml", kPlainCalibration);
  folder.write("IMG_0001.HEIC", "no image");
  require_refused("images:" + folder.path(), "but HEIC (IMG_0001.HEIC)", "mogrify -format png *.HEIC");
}

static void test_single_image_of_another_size_should_be_unusable_and_not_end_the_rest() {
  TemporaryFolder folder;
  write_frames(folder, "%04d.png", 9);
  folder.write("0004.png", make_png(16, 16, 8, 0, flat(256, 4)));
  Opened opened("images:" + folder.path());
  pf_image_t image{};
  TEST_ASSERT_EQUAL_INT(PF_SEQUENCE_UNUSABLE_IMAGE, pf_read_sequence_frame(opened.sequence, 4, &image, opened.message));
  require_message(opened.message, "16 x 16 pixels among images of 32 x 32");
  TEST_ASSERT_EQUAL_INT(5, opened.read(5).pixels[0]);
  for (int i = 2; i < 9; ++i) folder.write(numbered("%04d.png", i), make_png(16, 16, 8, 0, flat(256, 4)));
  Opened most("images:" + folder.path());
  TEST_ASSERT_EQUAL_INT(-1, pf_read_sequence_frame(most.sequence, 2, &image, most.message));
  require_message(most.message, "use the calibration of these images");
}

static void test_numbers_of_fewer_bits_should_be_scaled_with_a_note() {
  for (const int bits : {8, 10, 12, 14}) {
    const int top = (1 << bits) - 1;
    TemporaryFolder folder;
    folder.write("calib.yaml", kPlainCalibration);
    folder.write("0.png", make_png(32, 32, 16, 0, ramp_of_16_bits(0, top / 2 + 2)));
    folder.write("1.pgm", make_pgm(32, 32, ramp_of_16_bits(0, top), 65535));
    Opened opened("images:" + folder.path());
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    TEST_ASSERT_UINT8_WITHIN(2, 128, opened.read(0).pixels[1023]);
    TEST_ASSERT_EQUAL_UINT8(255, opened.read(1).pixels[1023]);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        std::strstr(opened.info.warning, ("so that " + std::to_string(top) + " becomes white").c_str()),
        opened.info.warning);
  }
  // A later image that is brighter than all that were looked at moves white up.
  TemporaryFolder later;
  later.write("calib.yaml", kPlainCalibration);
  for (int i = 0; i < 9; ++i)
    later.write(numbered("%d.png", i), make_png(32, 32, 16, 0, ramp_of_16_bits(0, i == 1 ? 4000 : 1000)));
  Opened opened("images:" + later.path());
  TEST_ASSERT_UINT8_WITHIN(2, 249, opened.read(0).pixels[1023]);
  TEST_ASSERT_UINT8_WITHIN(2, 249, opened.read(1).pixels[1023]);
}

static void test_raw_thermal_images_should_be_stretched_with_a_note() {
  for (const auto& [low, high] : {std::pair(28900, 31200), std::pair(7000, 9100), std::pair(21000, 21400)}) {
    TemporaryFolder folder;
    folder.write("calib.yaml", kPlainCalibration);
    for (int i = 0; i < 3; ++i)
      folder.write(numbered("%d.png", i), make_png(32, 32, 16, 0, ramp_of_16_bits(low, high)));
    Opened opened("images:" + folder.path());
    const pf_image_t image = opened.read(1);
    TEST_ASSERT_UINT8_WITHIN(4, 64, image.pixels[0]);
    TEST_ASSERT_UINT8_WITHIN(4, 191, image.pixels[1023]);
    TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(opened.info.warning, "raw thermal images"), opened.info.warning);
  }
  TemporaryFolder light;  // a picture that uses its numbers is taken as it is
  light.write("calib.yaml", kPlainCalibration);
  light.write("0.png", make_png(32, 32, 16, 0, ramp_of_16_bits(9000, 60000)));
  Opened opened("images:" + light.path());
  TEST_ASSERT_UINT8_WITHIN(1, 35, opened.read(0).pixels[0]);
  TEST_ASSERT_NULL_MESSAGE(std::strstr(opened.info.warning, "16 bits"), opened.info.warning);
}

static void test_missing_numbers_should_be_told_with_what_to_type() {
  TemporaryFolder folder;
  folder.write("calib.yaml", kPlainCalibration);
  int level = 0;
  std::string times = "# time [frames], name\n";
  for (const int number : {0, 2, 4, 6, 12, 14, 16, 18}) {
    folder.write(numbered("cam_%d.png", number), grey_png(static_cast<uint8_t>(level++)));
    times += std::to_string(number) + " " + numbered("cam_%d.png", number) + "\n";
  }
  require_frames("images:" + folder.path(), 8, "2 numbers are missing in them (first behind cam_6.png)");
  folder.write("times.txt", times);
  require_frames("images:" + folder.path(), 8, "");
  Opened opened("images:" + folder.path());
  TEST_ASSERT_NULL_MESSAGE(std::strstr(opened.info.warning, "missing"), opened.info.warning);
  TEST_ASSERT_EQUAL_INT64(18 * (opened.read(1).t_ns / 2), opened.read(7).t_ns);
  for (const char* form : {"%03d.png", "IMG_%d.png", "%d00.png"}) {
    TemporaryFolder whole;
    write_frames(whole, form, 12);
    const Opened counted("images:" + whole.path());
    TEST_ASSERT_NULL_MESSAGE(std::strstr(counted.info.warning, "missing"), counted.info.warning);
  }
}

static void test_pause_of_a_recording_should_be_told_with_its_frame() {
  TemporaryFolder folder;
  write_frames(folder, "images/%04d.png", 12);
  std::string even, paused;
  for (int i = 0; i < 12; ++i) {
    even += std::to_string(i * (i == 5 ? 0.0331 : 0.0333)) + numbered(" %04d.png\n", i);
    paused += std::to_string(i * 0.0333 + (i < 7 ? 0.0 : 86400.0)) + numbered(" %04d.png\n", i);
  }
  folder.write("times.txt", even);
  require_frames("images:" + folder.path(), 12, "");
  const Opened opened("images:" + folder.path());
  TEST_ASSERT_NULL_MESSAGE(std::strstr(opened.info.warning, "after the one before"), opened.info.warning);
  folder.write("times.txt", paused);
  require_frames("images:" + folder.path(), 12,
                 "frame 7 comes 86400 s after the one before, where others come after 0.0333 s");
  require_frames("images:" + folder.path(), 12, "begin with --skip 7 and end with --frames 7");
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_files_of_other_systems_should_be_left_out_in_silence);
  RUN_TEST(test_two_streams_should_be_refused_with_what_to_type);
  RUN_TEST(test_previews_and_single_files_should_be_left_out_by_name);
  RUN_TEST(test_colour_images_of_kitti_should_be_taken_where_there_are_no_grey_ones);
  RUN_TEST(test_kitti_raw_should_be_read_by_camera_with_the_calibration_above);
  RUN_TEST(test_other_formats_should_be_named_whatever_the_case_of_letters);
  RUN_TEST(test_single_image_of_another_size_should_be_unusable_and_not_end_the_rest);
  RUN_TEST(test_numbers_of_fewer_bits_should_be_scaled_with_a_note);
  RUN_TEST(test_raw_thermal_images_should_be_stretched_with_a_note);
  RUN_TEST(test_missing_numbers_should_be_told_with_what_to_type);
  RUN_TEST(test_pause_of_a_recording_should_be_told_with_its_frame);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
