// Tables of times as other programs write them: columns, units, quotes, byte order marks; and times in the names of images.
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <memory>
#include <vector>

#include "sequence_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

constexpr int64_t kMs = 1000000;

/// A folder with images of given names, each with its number as grey level, and a calibration of 20 Hz.
void write_images(const TemporaryFolder& folder, const std::vector<std::string>& names) {
  folder.write("calib.yaml", kPlainCalibration);
  for (size_t i = 0; i < names.size(); ++i) folder.write(names[i], grey_png(static_cast<uint8_t>(i)));
}

/// The table is read as frames with these grey levels and times [ms].
void require_frames(const Opened& opened, const std::vector<int>& levels, const std::vector<int64_t>& times_ms) {
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  TEST_ASSERT_EQUAL_INT64(static_cast<int64_t>(levels.size()), opened.info.count);
  for (size_t i = 0; i < levels.size(); ++i) {
    pf_image_t image{};
    char message[PF_SEQUENCE_MESSAGE];
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_read_sequence_frame(opened.sequence, static_cast<int64_t>(i), &image, message),
                                  message);
    TEST_ASSERT_EQUAL_INT(levels[i], image.pixels[0]);
    TEST_ASSERT_EQUAL_INT64(times_ms[i], (image.t_ns - opened.info.first_t_ns) / kMs);
  }
}

/// times.txt with this text, beside images/00000.png .. 00003.png.
struct Timed {
  explicit Timed(const std::string& text) {
    write_images(folder, {"images/00000.png", "images/00001.png", "images/00002.png", "images/00003.png"});
    folder.write("times.txt", text);
    opened = std::make_unique<Opened>("images:" + folder.path());
  }
  TemporaryFolder folder;
  std::unique_ptr<Opened> opened;
};

void require_read(const std::string& text, const char* note = "") {
  const Timed timed(text);
  require_frames(*timed.opened, {0, 1, 2, 3}, {0, 50, 100, 150});
  if (note[0] == '\0') {
    TEST_ASSERT_EQUAL_STRING("", timed.opened->info.warning);
  } else {
    require_message(timed.opened->info.warning, note);
    require_message(timed.opened->info.warning, "times.txt");
  }
}

void require_refused(const std::string& text, const char* part) {
  const Timed timed(text);
  TEST_ASSERT_NULL_MESSAGE(timed.opened->sequence, text.c_str());
  require_message(timed.opened->message, part);
  require_message(timed.opened->message, "times.txt");
}

}  // namespace

static void test_times_should_be_read_in_the_forms_that_people_have() {
  require_read("1.00 00000.png\n1.05 00001.png\n1.10 00002.png\n1.15 00003.png\n");
  require_read("00000.png 1.00\n00001.png 1.05\n00002.png 1.10\n00003.png 1.15\n");
  require_read(
      "00000 1.00 7.5\n00001 1.05 7.5\n00002 1.10 8\n00003 1.15 8.25\n");  // with exposures, as of photometric sets
  require_read("00000.png 1.00 7.5\n00001.png 1.05 7.5\n00002.png 1.10 8\n00003.png 1.15 8.25\n");
  require_read("0 1.00\n1 1.05\n2 1.10\n3 1.15\n");
  require_read("images/00000.png,1\nimages/00001.png,1.05\nimages/00002.png,1.1\nimages/00003.png,1.15\n");
  require_read(
      "1.0;images\\00000.png\r\n1.05;images\\00001.png\r\n1.1;images\\00002.png\r\n1.15;images\\00003.png\r\n");
  require_read("1,0;00000.png\n1,05;00001.png\n1,1;00002.png\n1,15;00003.png\n");  // decimal commas
  require_read("1,00 00000.png\n1,05 00001.png\n1,10 00002.png\n1,15 00003.png\n");
  require_read("00000\t1,00\t7,5\n00001\t1,05\t7,5\n00002\t1,10\t8\n00003\t1,15\t8,25\n");
  require_read("1.0e0 00000.png\n1.05e+00 00001.png\n11e-1 00002.png\n0.115e1 00003.png\n");
  require_read("1.00\r1.05\r1.10\r1.15");  // of old Macs, without names
}

static void test_dates_should_be_read_as_times() {
  require_read("2011-09-26 13:02:25.90\n2011-09-26 13:02:25.95\n2011-09-26 13:02:26\n2011-09-26 13:02:26.05\n");
  require_read(
      "2023-12-31T23:59:59.95Z,00000.png\n2024-01-01T00:00:00Z,00001.png\n2024-01-01T01:00:00.05+01:00,00002.png\n"
      "2023-12-31T19:00:00.1-05:00,00003.png\n");
  require_read(
      "00000.png 2024-02-28 23:59:59.95\n00001.png 2024-02-29 00:00:00\n00002.png 2024-02-29 00:00:00.05\n"
      "00003.png 2024-02-29 00:00:00.1\n");
  const Timed dated("1970-01-02 00:00:01 00000.png\n");
  TEST_ASSERT_EQUAL_INT64(86401 * 1000 * kMs, dated.opened->info.first_t_ns);
  require_refused("2024-13-01 00:00:00 00000.png\n", "columns");
  require_refused("2024-01-01 25:00:00 00000.png\n", "columns");
  require_refused("2024-01-01 00000.png\n", "not a time");
}

static void test_columns_should_be_taken_by_their_header() {
  require_read(
      "name,exposure [ms],timestamp [us]\n00000.png,3,0\n00001.png,3,50000\n00002.png,3,100000\n00003.png,3,150000\n");
  require_read("# filename timestamp_ns\n00000.png 0\n00001.png 50000000\n00002.png 100000000\n00003.png 150000000\n");
  require_read("\"time [ms]\",\"index\"\n0,0\n50,1\n100,2\n150,3\n");
  require_read("# frame time [frames]\n0 10\n1 11\n2 12\n3 13\n");
  require_read("# made by hand\n1.00 00000.png\n1.05 00001.png\n# half\n1.10 00002.png\n1.15 00003.png\n");
  require_refused("time,name,gain\n0,a.png,2\n", "'gain'");
  require_refused("time [h],name\n0,a.png\n", "time [h]");
  require_refused("when,what\n0,a.png\n", "'when', 'what'");
  require_refused("time,name,name\n0,a.png\n", "names 3 columns");
}

static void test_tables_should_be_read_with_marks_quotes_and_blanks() {
  const std::string rows = "1.00,\"00000.png\"\n 1.05 , 00001.png ,\n1.10,00002.png\n\n1.15\t,\t\"00003.png\"\n";
  require_read("\xef\xbb\xbf" + rows);
  std::string wide = "\xff\xfe";
  for (const char c : rows) wide += {c, '\0'};
  require_read(wide);
  TemporaryFolder folder;
  write_images(folder, {"images/left cam 1.png", "images/the \"second\".png"});
  for (const char* text :
       {"0,left cam 1.png\n0.05,\"the \"\"second\"\".png\"\n", "0 left cam 1.png\n0.05 \"the \"\"second\"\".png\"\n"}) {
    folder.write("times.txt", text);
    require_frames(Opened("images:" + folder.path()), {0, 1}, {0, 50});
  }
}

static void test_columns_should_be_refused_by_name_when_they_are_not_known() {
  require_refused("1.00 00000.png 4\n1.05 00001.png 4\n", "has 3 columns; known are time | time name");
  require_refused("0 1.00 00000.png 9\n", "4 columns");
  require_refused("0.5 1.00 00000.png\n", "3 columns");
  require_refused("0 1.00 00000.png\n1 1.05\n", "line 2: has 2 columns (1 1.05), the rows before have 3");
  require_refused("0 1.00 00000.png\n0 1.05 00001.png\n", "line 2: column 1 should count");
  require_refused("7 1.00\n8 1.05\n", "2 columns");  // neither numbers of images nor a time alone
  require_refused("1.00 00000.tiff\n", "images are PNG, JPEG or PGM");
  require_refused("1.00 77\n1.05 78\n", "2 columns");
  require_refused("0,90\n0,95\n1,00\n1,05\n", "'0,90' looks like a time with a decimal comma");
}

static void test_units_should_be_recognised_against_the_rate_of_the_calibration() {
  require_read("0 00000.png\n50 00001.png\n100 00002.png\n150 00003.png\n", "taken as milliseconds (20 Hz)");
  require_read(
      "1700000000000000 00000.png\n1700000000050000 00001.png\n1700000000100000 00002.png\n1700000000150000 "
      "00003.png\n",
      "taken as microseconds");
  require_read(
      "1700000000.0e9 00000.png\n1700000000.05e9 00001.png\n1700000000.1e9 00002.png\n1700000000.15e9 00003.png\n",
      "taken as nanoseconds");
  require_read("4 00000.png\n5 00001.png\n6 00002.png\n7 00003.png\n", "frame numbers at 20 Hz");
  require_read("4\n5\n6\n7\n", "first line can say the unit: # time [frames]");
  const Timed slow(
      "0.5 00000.png\n10.5 00001.png\n20.5 00002.png\n30.5 00003.png\n");  // seconds, of a camera that waits
  require_frames(*slow.opened, {0, 1, 2, 3}, {0, 10000, 20000, 30000});
  require_message(slow.opened->info.warning, "0.1 Hz, but the calibration says rate_hz: 20");
  const Timed said(
      "# time [s] name\n0 00000.png\n1 00001.png\n2 00002.png\n3 00003.png\n");  // it is believed, and told
  require_frames(*said.opened, {0, 1, 2, 3}, {0, 1000, 2000, 3000});
  require_message(said.opened->info.warning, "as its header says");
}

static void test_names_should_give_times_when_they_are_times() {
  TemporaryFolder folder;
  write_images(folder, {"12.0.png", "12.05.png", "12.1.png", "12.15.png", "12.2.png"});
  require_frames(Opened("images:" + folder.path()), {0, 1, 2, 3, 4}, {0, 50, 100, 150, 200});
  TemporaryFolder stamped;
  write_images(stamped, {"cam_1403636579763555584.png", "cam_1403636579813555456.png", "cam_1403636579863555584.png"});
  const Opened opened("images:" + stamped.path());
  require_frames(opened, {0, 1, 2}, {0, 49, 100});
  require_message(opened.info.warning, "taken as times in nanoseconds");
  TemporaryFolder counted;  // 1.10 follows 1.9: these are no fractions
  write_images(counted, {"1.8.png", "1.9.png", "1.10.png", "1.11.png"});
  require_frames(Opened("images:" + counted.path()), {0, 1, 2, 3}, {0, 50, 100, 150});
  TemporaryFolder dated;
  write_images(dated, {"20240131235959900.png", "20240131235959950.png", "20240201000000000.png"});
  require_frames(Opened("images:" + dated.path()), {0, 1, 2}, {0, 50, 100});
  TemporaryFolder before;  // a camera's name behind the time, a number before it
  write_images(before,
               {"7_1403636579763555584_left.png", "8_1403636579813555456_left.png", "9_1403636579863555584_left.png"});
  require_frames(Opened("images:" + before.path()), {0, 1, 2}, {0, 49, 100});
  TemporaryFolder minute;  // dates, over the end of a minute
  write_images(minute, {"2024-01-31_23-59-59.950.png", "2024-02-01_00-00-00.030.png", "2024-02-01_00-00-00.090.png"});
  const Opened dates("images:" + minute.path());
  require_frames(dates, {0, 1, 2}, {0, 80, 140});
  require_message(dates.info.warning, "dates in the names");
  TemporaryFolder phone;
  write_images(phone, {"IMG_20240131_235959970.png", "IMG_20240201_000000050.png", "IMG_20240201_000000120.png"});
  require_frames(Opened("images:" + phone.path()), {0, 1, 2}, {0, 80, 150});
  TemporaryFolder burst;  // numbers of frames behind a date
  write_images(burst, {"20240131_120000_001.png", "20240131_120000_002.png", "20240131_120000_003.png"});
  require_frames(Opened("images:" + burst.path()), {0, 1, 2}, {0, 50, 100});
  TemporaryFolder odd;  // in order of their numbers, but no camera's times
  write_images(odd, {"1.png", "1.5.png", "400.25.png", "977.125.png"});
  const Opened sorted("images:" + odd.path());
  require_frames(sorted, {0, 1, 2, 3}, {0, 50, 100, 150});
  require_message(sorted.info.warning, "sorted by the numbers in their names");
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_times_should_be_read_in_the_forms_that_people_have);
  RUN_TEST(test_dates_should_be_read_as_times);
  RUN_TEST(test_columns_should_be_taken_by_their_header);
  RUN_TEST(test_tables_should_be_read_with_marks_quotes_and_blanks);
  RUN_TEST(test_columns_should_be_refused_by_name_when_they_are_not_known);
  RUN_TEST(test_units_should_be_recognised_against_the_rate_of_the_calibration);
  RUN_TEST(test_names_should_give_times_when_they_are_times);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
