// What pf_memory_query says for three configs, against golden numbers, and the limit of the default at 640x480.
#include <planefold/planefold_research.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "support/skip.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kBand = 0.03;

std::size_t bytes_of(int width, int height, int state_dim, int features, int observations) {
  pf_config_t config;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  config.camera = {
      PF_CAMERA_PINHOLE,  width, height, 0.8 * width, 0.8 * width, 0.5 * width, 0.5 * height, {}, 0, PF_CAMERA_EXACT,
      PF_TIMESTAMPS_REAL, 0,     0,      0,           {}};
  if (state_dim > 0) config.capacity.max_state_dim = state_dim;
  if (features > 0) config.capacity.max_features = features;
  if (observations > 0) config.capacity.max_observations = config.map.features_in_view = observations;
  pf_memory_t memory;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &memory));
  return memory.bytes;
}

std::size_t bytes_of(const std::string& name) {
  if (name == "default_640x480") return bytes_of(640, 480, 0, 0, 0);
  if (name == "small_320x240") return bytes_of(320, 240, 120, 30, 20);
  if (name == "large_1280x720") return bytes_of(1280, 720, 1000, 300, 100);
  return 0;
}

/// Lines of `name bytes`; what begins with # is a comment.
void test_memory_should_be_within_three_percent_of_the_golden_numbers() {
  const char* source = std::getenv("PLANEFOLD_SOURCE");
  std::ifstream golden(std::string(source != nullptr ? source : ".") + "/tests/golden/memory.txt");
  TEST_ASSERT_TRUE_MESSAGE(golden.good(), "tests/golden/memory.txt cannot be read");
  std::string line;
  int compared = 0, within = 0;
  while (std::getline(golden, line)) {
    if (line.empty() || line[0] == '#') continue;
    const std::string name = line.substr(0, line.find(' '));
    const double expected = std::atof(line.substr(name.size()).c_str());
    const double actual = static_cast<double>(bytes_of(name));
    std::printf("%s: %.0f bytes, golden %.0f\n", name.c_str(), actual, expected);
    within += std::fabs(actual - expected) <= kBand * expected ? 1 : 0;
    ++compared;
  }
  TEST_ASSERT_EQUAL_INT_MESSAGE(compared, within, "where this is meant, run tools/update-golden and say why");
  TEST_ASSERT_EQUAL_INT(3, compared);
}

void test_default_config_should_need_at_most_two_mebibytes_at_640x480() {
  TEST_ASSERT_LESS_OR_EQUAL_size_t(std::size_t{2} << 20, bytes_of("default_640x480"));
}

void test_a_mask_should_take_one_bit_for_sixteen_pixels() {
  pf_config_t config;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  config.camera = {PF_CAMERA_PINHOLE,  640, 480, 512, 512, 320, 240, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,   0,   0,   {}};
  pf_memory_t without, with;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &without));
  config.capacity.mask = 640 * 480;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &with));
  constexpr std::size_t kBits = 160 * 120, kAlignment = 64, kZone = 64;  // a zone with the address sanitizer alone
  TEST_ASSERT_GREATER_OR_EQUAL_size_t(kBits / 8, with.bytes - without.bytes);
  TEST_ASSERT_LESS_OR_EQUAL_size_t(kBits / 8 + kAlignment + kZone, with.bytes - without.bytes);
}

void test_memory_should_depend_on_capacities_and_image_size_alone() {
  pf_config_t config;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  config.camera = {PF_CAMERA_PINHOLE,  640, 480, 512, 512, 320, 240, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,   0,   0,   {}};
  pf_memory_t first, second;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &first));
  config.measurement.sigma_px = 1;
  config.motion.coast_s = 5;
  config.motion.restart_s = 0;
  pf_research_t research;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_research_default(&research));
  research.keep_gauge = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_set_research(&config, &research));
  config.motion.model = PF_MOTION_CONSTANT_POSITION;
  config.map.features_in_view = 20;
  config.camera.fx = config.camera.fy = 400;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &second));
  TEST_ASSERT_EQUAL_size_t(first.bytes, second.bytes);
  TEST_ASSERT_EQUAL_size_t(first.alignment, second.alignment);
}

}  // namespace

int main(void) {
#if defined(__SANITIZE_ADDRESS__) || defined(PLANEFOLD_SCALAR_FLOAT)
  SKIP_PROGRAM("golden numbers are those of the double library without sanitizers");
#endif
  UNITY_BEGIN();
  RUN_TEST(test_memory_should_be_within_three_percent_of_the_golden_numbers);
  RUN_TEST(test_default_config_should_need_at_most_two_mebibytes_at_640x480);
  RUN_TEST(test_a_mask_should_take_one_bit_for_sixteen_pixels);
  RUN_TEST(test_memory_should_depend_on_capacities_and_image_size_alone);
  return UNITY_END();
}
