#pragma once

// What the tests of calibration files share.

#include <cmath>
#include <string>

#include "sequence_test.h"

namespace pf::test {

struct ReadCalibration {
  int result;
  pf_camera_t camera;
  double rate_hz;
  char message[PF_SEQUENCE_MESSAGE];
};

inline ReadCalibration parse(const std::string& text, const char* camera = nullptr) {
  ReadCalibration read{};
  read.result =
      pf_parse_calibration_of(text.data(), text.size(), "c.yaml", camera, &read.camera, &read.rate_hz, read.message);
  return read;
}

/// The camera of a text that is read; notes are what the message must have, "" for none.
inline pf_camera_t camera_of(const std::string& text, const char* camera = nullptr, const char* notes = "") {
  const ReadCalibration read = parse(text, camera);
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, read.result, read.message);
  if (notes[0] == '\0') {
    TEST_ASSERT_EQUAL_STRING("", read.message);
  }
  TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(read.message, notes), read.message);
  return read.camera;
}

inline void require_lens(const pf_camera_t& c, int model, double fx, double fy, double cx, double cy,
                         const std::vector<double>& distortion = {}) {
  TEST_ASSERT_EQUAL_INT(model, c.model);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, fx, c.fx);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, fy, c.fy);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, cx, c.cx);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, cy, c.cy);
  for (size_t i = 0; i < 8; ++i) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, i < distortion.size() ? distortion[i] : 0.0, c.distortion[i]);
  }
}

/// Replaces the first occurrence; the text must have it.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  TEST_ASSERT_TRUE_MESSAGE(at != std::string::npos, from.c_str());
  return text.replace(at, from.size(), to);
}

/// The text is refused in one line that has the part and the file; the line is returned.
inline std::string require_refused(const std::string& text, const std::string& part, const char* camera = nullptr) {
  const ReadCalibration read = parse(text, camera);
  TEST_ASSERT_EQUAL_INT_MESSAGE(-1, read.result, text.c_str());
  require_message(read.message, part);
  require_message(read.message, "c.yaml");
  return read.message;
}

}  // namespace pf::test
