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

}  // namespace pf::test
