// Images of a sequence: formats, and what is damaged, cut off, missing or of the wrong size.
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <cstdio>
#include <cstdlib>

#include "sequence_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

/// A sequence of one image.
void write_sequence(const TemporaryFolder& folder, const Bytes& bytes, const std::string& name = "a.png") {
  folder.write("calib.yaml", kPlainCalibration);
  folder.write("times.txt", "0 0.0 " + name + "\n");
  folder.write("images/" + name, bytes);
}

/// One image under a name; the reader's answer to reading it must be a refusal that names the file and says part.
void image_refused(const Bytes& bytes, const std::string& part) {
  TemporaryFolder folder;
  write_sequence(folder, bytes);
  Opened opened("images:" + folder.path());
  TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
  pf_image_t image{};
  TEST_ASSERT_LESS_THAN_INT(0, pf_read_sequence_frame(opened.sequence, 0, &image, opened.message));
  require_message(opened.message, "a.png");
  require_message(opened.message, part);
}

/// Decodes a JPEG of 32 x 32. -1: refused.
int decode_jpeg(const TemporaryFolder& folder, const Bytes& bytes, Bytes& pixels) {
  folder.write("images/a.png", bytes);
  Opened opened("images:" + folder.path());
  pf_image_t image{};
  if (pf_read_sequence_frame(opened.sequence, 0, &image, opened.message) != 0) {
    return -1;
  }
  pixels.assign(image.pixels, image.pixels + 1024);
  return 0;
}

}  // namespace

static void test_pixels_should_become_eight_bit_grey() {
  TemporaryFolder folder;
  folder.write("calib.yaml", kPlainCalibration);
  Bytes red(3072, 0);
  Bytes deep(2048, 0);
  for (size_t i = 0; i < 1024; ++i) {
    red[3 * i] = 255;
    deep[2 * i] = 128;
  }
  folder.write("a.png", make_png(32, 32, 8, 2, red));
  folder.write("b.png", make_png(32, 32, 16, 0, deep));
  folder.write("c.pgm", make_pgm(32, 32, deep, 65535));
  folder.write("d.jpg", make_jpeg());
  const auto pixel = [&](int64_t index, size_t at) {  // a sequence of its own for each: types do not mix
    Opened opened("images:" + folder.path());
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    return opened.read(index).pixels[at];
  };
  TEST_ASSERT_EQUAL_UINT8(76, pixel(0, 100));
  TEST_ASSERT_UINT8_WITHIN(1, 128, pixel(1, 100));
  TEST_ASSERT_UINT8_WITHIN(1, 128, pixel(2, 100));
  TEST_ASSERT_UINT8_WITHIN(6, 8 * 20, pixel(3, 32 * 10 + 20));
}

static void test_image_should_be_named_when_it_is_truncated_or_damaged() {
  const Bytes png = grey_png(50);
  const Bytes jpeg = make_jpeg();
  const Bytes pgm = make_pgm(32, 32, flat(1024, 1));
  const auto cut = [](const Bytes& bytes, size_t size) {
    return Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  };
  for (size_t size : {size_t{9}, size_t{30}, png.size() / 2, png.size() - 20}) image_refused(cut(png, size), "cut off");
  for (size_t size : {size_t{4}, size_t{100}, jpeg.size() / 2, jpeg.size() - 30})
    image_refused(cut(jpeg, size), "cut off");
  image_refused(cut(pgm, pgm.size() - 1), "ends after");
  image_refused(cut(pgm, 5), "header");
  image_refused({}, "empty");
  image_refused(flat(500, 0), "neither PNG");
  Bytes flipped = png;
  flipped[60] = static_cast<uint8_t>(flipped[60] ^ 0xff);
  image_refused(flipped, "damaged");
}

/// Each bit of the compressed data is flipped in turn. libjpeg gives up on 183 of 360, and warns of 24 more; of the others it knows
/// nothing.
static void test_jpeg_should_be_refused_when_libjpeg_warns_of_it() {
  TemporaryFolder folder;
  folder.write("calib.yaml", kPlainCalibration);
  folder.write("times.txt", "0 0.0 a.png\n");
  const Bytes good = make_jpeg();
  Bytes right, pixels;
  TEST_ASSERT_EQUAL_INT(0, decode_jpeg(folder, good, right));
  size_t scan = 0;  // after the header of the scan
  while (!(good[scan] == 0xff && good[scan + 1] == 0xda)) ++scan;
  scan += 10;
  int refused = 0, wrong = 0, taken = 0;
  for (size_t at = scan; at + 2 < good.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes bad = good;
      bad[at] = static_cast<uint8_t>(bad[at] ^ (1 << bit));
      if (decode_jpeg(folder, bad, pixels) != 0) {
        ++refused;
        continue;
      }
      size_t off = 0;
      for (size_t i = 0; i < 1024; ++i) off += std::abs(pixels[i] - right[i]) > 20 ? 1 : 0;
      ++taken;
      wrong += off > 102 ? 1 : 0;
    }
  }
  std::printf("bits flipped: %d refused, %d taken, %d of these with a tenth of the pixels wrong\n", refused, taken,
              wrong);
  TEST_ASSERT_GREATER_THAN_INT(200, refused);
  // Some cameras pad: bytes of one value before the end are no damage, others are.
  Bytes padded(good.begin(), good.end() - 2), dirty = padded;
  padded.insert(padded.end(), {0, 0, 0, 0, 0, 0, 0xff, 0xd9});
  dirty.insert(dirty.end(), {7, 120, 3, 4, 91, 6, 0xff, 0xd9});
  TEST_ASSERT_EQUAL_INT(0, decode_jpeg(folder, padded, pixels));
  TEST_ASSERT_EQUAL_MEMORY(right.data(), pixels.data(), 1024);
  TEST_ASSERT_EQUAL_INT(-1, decode_jpeg(folder, dirty, pixels));
}

static void test_image_should_be_refused_when_its_size_is_wrong_or_huge() {
  image_refused(make_png(16, 64, 8, 0, flat(1024, 0)), "16 x 64");
  image_refused(make_pgm(64, 64, flat(4096, 0)), "calib.yaml");
  image_refused(make_pgm(100000, 100000, {}), "pixels");
  image_refused(make_pgm(0, 32, {}), "pixels");
  image_refused(make_png(0x7fffffff, 0x7fffffff, 8, 0, {}), "damaged");
  Bytes jpeg = make_jpeg();
  for (size_t i = 0; i + 8 < jpeg.size(); ++i) {
    if (jpeg[i] == 0xff && jpeg[i + 1] == 0xc0) {
      jpeg[i + 5] = jpeg[i + 6] = jpeg[i + 7] = jpeg[i + 8] = 0xff;
    }
  }
  image_refused(jpeg, "pixels");
}

/// Cameras of 12 bits often store their numbers as they are: 4095 of 65535 is grey level 16.
static void test_opening_should_warn_when_images_of_16_bits_have_data_of_12() {
  Bytes dark(2048, 0), bright(2048, 0);
  for (size_t i = 0; i < 1024; ++i) {
    dark[2 * i] = static_cast<uint8_t>(i % 16);
    dark[2 * i + 1] = bright[2 * i] = 255;
  }
  const auto warning = [](const Bytes& bytes) {
    TemporaryFolder folder;
    write_sequence(folder, bytes);
    Opened opened("images:" + folder.path());
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    opened.read(0);
    return std::string(opened.info.warning);
  };
  for (const Bytes& bytes : {make_png(32, 32, 16, 0, dark), make_pgm(32, 32, dark, 65535)}) {
    require_message(warning(bytes).c_str(), "no number above 4095");
    require_message(warning(bytes).c_str(), "a.png");
  }
  TEST_ASSERT_EQUAL_STRING("", warning(make_png(32, 32, 16, 0, bright)).c_str());
  TEST_ASSERT_EQUAL_STRING("", warning(make_pgm(32, 32, dark, 4095)).c_str());  // the file says what is white
  TEST_ASSERT_EQUAL_STRING("", warning(grey_png(3)).c_str());
}

/// A segment of EXIF that says nothing but an orientation, behind the first marker of a JPEG.
static Bytes with_orientation(uint8_t value, bool big_endian, uint8_t entries = 1) {
  const Bytes big = {'M', 'M', 0, 42, 0, 0, 0, 8, 0, entries, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, value, 0, 0};
  const Bytes little = {'I', 'I', 42, 0, 8, 0, 0, 0, entries, 0, 0x12, 1, 3, 0, 1, 0, 0, 0, value, 0, 0, 0};
  Bytes segment = {0xff, 0xe1, 0, 30, 'E', 'x', 'i', 'f', 0, 0};
  const Bytes& directory = big_endian ? big : little;
  segment.insert(segment.end(), directory.begin(), directory.end());
  Bytes jpeg = make_jpeg();
  jpeg.insert(jpeg.begin() + 2, segment.begin(), segment.end());
  return jpeg;
}

static void test_pixels_should_be_taken_as_stored_with_a_warning_when_exif_turns_them() {
  TemporaryFolder folder;
  const auto check = [&](const Bytes& bytes, const char* warning) {
    write_sequence(folder, bytes, "a.jpg");
    Opened opened("images:" + folder.path());
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    TEST_ASSERT_UINT8_WITHIN(6, 8 * 20, opened.read(0).pixels[32 * 10 + 20]);
    if (warning[0] != '\0')
      require_message(opened.info.warning, warning);
    else
      TEST_ASSERT_EQUAL_STRING("", opened.info.warning);
  };
  check(with_orientation(6, true), "orientation 6");
  check(with_orientation(3, false), "as stored");
  check(with_orientation(1, true), "");
  check(with_orientation(9, true), "");
  check(with_orientation(1, true, 255), "");  // entries that are not there
}

static void test_jpeg_should_be_refused_by_name_when_it_is_in_cmyk() {
  Bytes jpeg = make_jpeg();
  size_t frame = 0;
  while (!(jpeg[frame] == 0xff && jpeg[frame + 1] == 0xc0)) ++frame;
  jpeg[frame + 3] = 0x14;  // bytes of a header with a fourth component
  jpeg[frame + 9] = 4;
  const Bytes fourth = {4, 0x12, 0};
  jpeg.insert(jpeg.begin() + static_cast<std::ptrdiff_t>(frame) + 19, fourth.begin(), fourth.end());
  image_refused(jpeg, "CMYK");
}

static void test_image_should_be_named_when_it_is_missing() {
  TemporaryFolder folder;
  folder.write("calib.yaml", kPlainCalibration);
  folder.write("times.txt", "0 0.0 a.png\n");
  folder.write("images/b.png", grey_png(1));
  Opened opened("images:" + folder.path());
  pf_image_t image{};
  TEST_ASSERT_EQUAL_INT(PF_SEQUENCE_UNUSABLE_IMAGE, pf_read_sequence_frame(opened.sequence, 0, &image, opened.message));
  require_message(opened.message, "a.png");
  TEST_ASSERT_EQUAL_INT(-1, pf_read_sequence_frame(opened.sequence, 1, &image, opened.message));
  TEST_ASSERT_EQUAL_INT(-1, pf_read_sequence_frame(opened.sequence, -1, &image, opened.message));
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_pixels_should_become_eight_bit_grey);
  RUN_TEST(test_image_should_be_named_when_it_is_truncated_or_damaged);
  RUN_TEST(test_jpeg_should_be_refused_when_libjpeg_warns_of_it);
  RUN_TEST(test_image_should_be_refused_when_its_size_is_wrong_or_huge);
  RUN_TEST(test_opening_should_warn_when_images_of_16_bits_have_data_of_12);
  RUN_TEST(test_pixels_should_be_taken_as_stored_with_a_warning_when_exif_turns_them);
  RUN_TEST(test_jpeg_should_be_refused_by_name_when_it_is_in_cmyk);
  RUN_TEST(test_image_should_be_named_when_it_is_missing);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
