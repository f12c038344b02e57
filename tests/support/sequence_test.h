#pragma once

// What the tests of platform/sequence share.

#include <planefold_platform/sequence.h>

#include <cstring>
#include <string>

#include "image_files.h"
#include "unity.h"

namespace pf::test {

inline const char* const kPlainCalibration =
    "camera_model: pinhole\nwidth: 32\nheight: 32\nfx: 30.5\nfy: 31\ncx: 15.25\ncy: 16\ndistortion_model: none\n"
    "distortion: []\nrate_hz: 20\n";

/// The message is one line, names what it should and says something more.
inline void require_message(const char* message, const std::string& part) {
  TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(message, part.c_str()), message);
  TEST_ASSERT_NULL_MESSAGE(std::strchr(message, '\n'), message);
  TEST_ASSERT_GREATER_THAN_size_t(part.size() + 5, std::strlen(message));
}

inline Bytes flat(size_t bytes, uint8_t level) { return Bytes(bytes, level); }
inline Bytes grey_png(uint8_t level) { return make_png(32, 32, 8, 0, flat(1024, level)); }

struct Opened {
  pf_sequence_t* sequence = nullptr;
  pf_sequence_info_t info{};
  char message[PF_SEQUENCE_MESSAGE] = "";

  explicit Opened(const std::string& source, const char* calibration = nullptr) {
    if (pf_open_sequence(source.c_str(), calibration, &sequence, message) == 0) {
      pf_get_sequence_info(sequence, &info);
    }
  }
  ~Opened() { pf_close_sequence(sequence); }

  pf_image_t read(int64_t index) {
    pf_image_t image{};
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_read_sequence_frame(sequence, index, &image, message), message);
    return image;
  }
};

}  // namespace pf::test
