// Saves of a context, to go on with: what is refused, by which name, and that nothing changes then.
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "memory/crc32c.h"
#include "planefold/planefold.h"
#include "support/continued.h"
#include "support/rendered_run.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFrames = 40, kLength = 70, kPlaces = 16;

using Bytes = std::vector<std::uint8_t>;

std::string last_line;

void keep_line(void*, const char* line) { last_line = line; }

/// A run of the present back end that has seen the first frames of a rendered room.
RenderedRun& walked() {
  static RenderedRun* runs[PF_BACKEND_WINDOW + 1] = {};
  RenderedRun*& run = runs[RenderedRun::backend];
  if (run != nullptr) return *run;
  run = new RenderedRun("room", kLength, RenderedRun::Start::kNone);
  run->config.capacity.max_places = kPlaces;
  run->create();
  run->start_at_rectangle();
  TEST_ASSERT_TRUE(run->tracked_until(kFrames) > kFrames / 2);
  return *run;
}

struct Fresh {
  RenderedRun run{"room", kLength, RenderedRun::Start::kNone};

  Fresh() { again(); }
  /// With what has been changed in the config.
  void again() {
    run.config.log = keep_line;
    run.config.capacity.max_places = kPlaces;
    run.create();
    last_line.clear();
  }
  pf_status_t load(const Bytes& map) { return pf_load_map(run.slam, map.data(), map.size()); }
  void expect_refusal(const Bytes& map, const char* why) {
    const std::vector<double> before = numbers_of(run.slam);
    TEST_ASSERT_EQUAL_INT(PF_ERROR_MAP, load(map));
    if (last_line.find(why) == std::string::npos) std::printf("%s\n", last_line.c_str());
    TEST_ASSERT_TRUE(last_line.find(why) != std::string::npos);
    TEST_ASSERT_TRUE(numbers_of(run.slam) == before);
  }
};

/// A number of a section's contents is another one, under a CRC that fits. at: from the section's first byte on.
Bytes forged(const Bytes& map, std::size_t section, std::size_t at, std::uint8_t flip) {
  constexpr std::size_t kHeader = 24;
  Bytes out = map;
  std::uint64_t length = 0;
  std::memcpy(&length, map.data() + section + 8, sizeof length);
  out[section + kHeader + at] ^= flip;
  const std::uint32_t crc =
      crc32c(out.data() + section + kHeader, static_cast<std::size_t>(length), crc32c(out.data() + section, 16));
  std::memcpy(out.data() + section + 16, &crc, sizeof crc);
  return out;
}

constexpr std::size_t kOrigin = 32, kLive = 32 + 24 + 24;  ///< where the sections begin

void test_a_context_should_go_on_at_another_address() {
  RenderedRun& first = walked();
  const Bytes map = saved_to_continue(first.slam);
  std::printf("%zu bytes of a block of %zu\n", map.size(), first.need.bytes);
  Fresh fresh;
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(map));
  TEST_ASSERT_TRUE(numbers_of(fresh.run.slam) == numbers_of(first.slam));
  TEST_ASSERT_TRUE(saved_to_continue(fresh.run.slam) == map);
  fresh.run.skip(kFrames);
  RenderedRun plain("room", kLength, RenderedRun::Start::kNone);
  plain.config.capacity.max_places = kPlaces;
  plain.create();
  plain.start_at_rectangle();
  plain.tracked_until(kFrames);
  while (plain.step()) {
    TEST_ASSERT_TRUE(fresh.run.step());
    TEST_ASSERT_TRUE(numbers_of(fresh.run.slam) == numbers_of(plain.slam));
  }
}

void test_another_origin_should_be_refused_by_name() {
  const Bytes map = saved_to_continue(walked().slam);
  Fresh fresh;
  fresh.expect_refusal(forged(map, kOrigin, 0, 1), "another release");
  fresh.expect_refusal(forged(map, kOrigin, 4, 12), "the other scalar");
  fresh.expect_refusal(forged(map, kOrigin, 8, 1), "another kernel set");
  fresh.expect_refusal(forged(map, kOrigin, 16, 1), "another build");
  fresh.run.config.measurement.sigma_px *= 1.5;
  fresh.again();
  fresh.expect_refusal(map, "another config");
  const pf_backend_t backend = RenderedRun::backend;
  RenderedRun::backend = backend == PF_BACKEND_FILTER ? PF_BACKEND_WINDOW : PF_BACKEND_FILTER;
  Fresh of_the_other;
  RenderedRun::backend = backend;
  of_the_other.expect_refusal(map, "another config");
}

void test_a_damaged_context_should_be_refused_and_change_nothing() {
  const Bytes map = saved_to_continue(walked().slam);
  Fresh fresh;
  const std::vector<double> before = numbers_of(fresh.run.slam);
  for (std::size_t k = 0; k < 60; ++k) {
    const std::size_t at = k * (map.size() - 1) / 59;
    Bytes damaged = map;
    damaged[at] ^= 0x10;
    TEST_ASSERT_EQUAL_INT(PF_ERROR_MAP, fresh.load(damaged));
    Bytes cut(map.begin(), map.begin() + static_cast<std::ptrdiff_t>(at));
    cut.reserve(1);
    TEST_ASSERT_EQUAL_INT(PF_ERROR_MAP, fresh.load(cut));
  }
  TEST_ASSERT_TRUE(numbers_of(fresh.run.slam) == before);
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(map));
}

/// Whatever they say: a refusal after which the context is new, or a context that runs.
void test_forged_numbers_should_do_no_harm() {
  const Bytes map = saved_to_continue(walked().slam);
  const std::size_t length = map.size() - kLive - 24;
  Fresh fresh;
  const std::vector<double> before = numbers_of(fresh.run.slam);
  int refused = 0, taken = 0;
  for (std::size_t k = 0; k < 300; ++k) {
    const std::size_t at = k < 150 ? k : (k - 150) * (length - 1) / 149;
    const pf_status_t status = fresh.load(forged(map, kLive, at, static_cast<std::uint8_t>(1u << (k % 8))));
    TEST_ASSERT_TRUE(status == PF_OK || status == PF_ERROR_MAP);
    refused += status == PF_ERROR_MAP ? 1 : 0;
    taken += status == PF_OK ? 1 : 0;
    if (status == PF_ERROR_MAP) TEST_ASSERT_TRUE(numbers_of(fresh.run.slam) == before);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(fresh.run.slam));
  }
  std::printf("%d refused, %d taken\n", refused, taken);
  TEST_ASSERT_TRUE(refused > 0 && taken > 0);
}

void test_a_context_that_was_told_something_should_refuse() {
  const Bytes map = saved_to_continue(walked().slam);
  Fresh fresh;
  fresh.run.start_at_rectangle();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, fresh.load(map));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(fresh.run.slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(map));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, fresh.load(map));
}

void test_what_was_rejected_should_have_told_nothing() {
  const Bytes map = saved_to_continue(walked().slam);
  Fresh fresh;
  pf_slam_t* const slam = fresh.run.slam;
  const double nan3[3] = {std::nan(""), 0, 0};
  const pf_imu_sample_t sample = {0, {nan3[0], 0, 0}, {}};
  std::uint32_t id = 0;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_push_frame(slam, nullptr));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_start_from_pose(slam, nullptr, nullptr));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_add_wall(slam, nullptr, &id));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_push_imu(slam, &sample, 1));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_set_gravity(slam, nan3));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_mark_pose(slam));
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_remove_anchor(slam, 7));
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(map));
}

void test_a_small_buffer_should_stay_as_it_is() {
  std::size_t bytes = 0, used = 7;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_map_size(walked().slam, PF_MAP_CONTINUE, &bytes));
  Bytes buffer(bytes, 0x5a);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_MEMORY, pf_save_map(walked().slam, PF_MAP_CONTINUE, buffer.data(), bytes - 1, &used));
  TEST_ASSERT_TRUE(buffer == Bytes(bytes, 0x5a));
  TEST_ASSERT_EQUAL_size_t(7, used);
}

void test_a_context_without_frames_should_be_saved_too() {
  Fresh before;
  before.run.start_at_rectangle();
  const Bytes map = saved_to_continue(before.run.slam);
  Fresh after;
  TEST_ASSERT_EQUAL_INT(PF_OK, after.load(map));
  while (before.run.step() && before.run.frames.size() < 10) {
    TEST_ASSERT_TRUE(after.run.step());
    TEST_ASSERT_TRUE(numbers_of(after.run.slam) == numbers_of(before.run.slam));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  for (const pf_backend_t backend : {PF_BACKEND_WINDOW, PF_BACKEND_FILTER}) {
    RenderedRun::backend = backend;
    RUN_TEST(test_a_context_should_go_on_at_another_address);
    RUN_TEST(test_another_origin_should_be_refused_by_name);
    RUN_TEST(test_a_damaged_context_should_be_refused_and_change_nothing);
    RUN_TEST(test_forged_numbers_should_do_no_harm);
    RUN_TEST(test_a_context_that_was_told_something_should_refuse);
    RUN_TEST(test_what_was_rejected_should_have_told_nothing);
    RUN_TEST(test_a_small_buffer_should_stay_as_it_is);
    RUN_TEST(test_a_context_without_frames_should_be_saved_too);
  }
  return UNITY_END();
}
