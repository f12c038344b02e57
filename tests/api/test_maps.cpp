// Saving a map and beginning in it: what is refused, that nothing changes then, and that a camera in the same room is found.
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "planefold/planefold.h"
#include "support/rendered_run.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFrames = 150, kLength = 240;

using Bytes = std::vector<std::uint8_t>;

std::string last_line;

void keep_line(void*, const char* line) { last_line = line; }

/// A run of a back end that has seen the first frames of a rendered room.
RenderedRun& walked(pf_backend_t backend = RenderedRun::backend) {
  static RenderedRun* runs[PF_BACKEND_WINDOW + 1] = {};
  RenderedRun*& run = runs[backend];
  if (run != nullptr) return *run;
  const pf_backend_t before = RenderedRun::backend;
  RenderedRun::backend = backend;
  run = new RenderedRun("room", kLength, RenderedRun::Start::kNone);
  RenderedRun::backend = before;
  run->config.capacity.max_places = 16;
  run->create();
  run->start_at_rectangle();
  TEST_ASSERT_TRUE(run->tracked_until(kFrames) > kFrames / 2);
  return *run;
}

Bytes saved(const pf_slam_t* slam) {
  std::size_t bytes = 0, used = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_map_size(slam, PF_MAP_PORTABLE, &bytes));
  Bytes map(bytes);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_save_map(slam, PF_MAP_PORTABLE, map.data(), map.size(), &used));
  TEST_ASSERT_TRUE(used <= bytes);
  map.resize(used);
  return map;
}

/// A context without frames, whose log is kept.
struct Fresh {
  RenderedRun run{"room", kLength, RenderedRun::Start::kNone};

  explicit Fresh(int places = 16, int planes = 8) {
    run.config.capacity.max_places = places;
    run.config.capacity.max_planes = planes;
    run.config.log = keep_line;
    run.create();
  }
  pf_status_t load(const Bytes& map) { return pf_load_map(run.slam, map.data(), map.size()); }
  pf_report_t report() const {
    pf_report_t out;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(run.slam, &out));
    return out;
  }
};

/// Of a map that was saved by a back end, in a context of the present one.
void find_again(pf_backend_t by) {
  RenderedRun& first = walked(by);
  const Bytes map = saved(first.slam);
  TEST_ASSERT_TRUE(map.size() <= 300000);
  Fresh second;
  TEST_ASSERT_EQUAL_INT(PF_OK, second.load(map));
  TEST_ASSERT_EQUAL_INT(PF_STATE_LOST, second.report().state);
  TEST_ASSERT_TRUE(second.report().places > 0);
  TEST_ASSERT_EQUAL_INT32(first.frames.back().report.planes, second.report().planes);
  second.run.skip(20);
  int found_at = -1, tracked = 0;
  double worst = 0;
  while (second.run.step()) {
    const RenderedRun::Frame& frame = second.run.frames.back();
    if (frame.status != PF_OK) continue;
    if (found_at < 0) found_at = static_cast<int>(second.run.frames.size());
    worst = std::fmax(worst, frame.error_m);
    ++tracked;
  }
  std::printf("found in frame %d, %d tracked, worst error %.4f m, %d returned\n", found_at, tracked, worst,
              second.report().places_returned);
  TEST_ASSERT_TRUE(found_at > 0 && found_at <= 30);
  TEST_ASSERT_TRUE(tracked >= 150);
  TEST_ASSERT_TRUE(worst < 0.1);
  TEST_ASSERT_TRUE(second.report().places_returned > 0);
}

void test_a_saved_map_should_be_found_again() { find_again(RenderedRun::backend); }

void test_a_map_of_the_other_back_end_should_be_found() {
  find_again(RenderedRun::backend == PF_BACKEND_FILTER ? PF_BACKEND_WINDOW : PF_BACKEND_FILTER);
}

void test_a_map_that_was_loaded_should_be_saved_as_the_same_bytes() {
  const Bytes map = saved(walked().slam);
  Fresh fresh;
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(map));
  TEST_ASSERT_TRUE(saved(fresh.run.slam) == map);
}

std::vector<pf_anchor_t> anchors_of(const pf_slam_t* slam) {
  std::vector<pf_anchor_t> all(64);
  std::size_t count = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchors(slam, all.data(), all.size(), &count));
  all.resize(count);
  return all;
}

/// One on a plane, and one beside the camera.
void set_two(pf_slam_t* slam, std::uint32_t id[2]) {
  pf_hit_t hit;
  pf_status_t found = PF_NOTE_NOTHING;
  for (int k = 1; found != PF_OK && k < 64; ++k) {
    const double pixel[2] = {40.0 * (k % 8), 30.0 * (k / 8)};
    found = pf_hit_test(slam, pixel, &hit);
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, found);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_hit(slam, &hit, &id[0]));
  pf_anchor_t anchor;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchor(slam, id[0], &anchor));
  TEST_ASSERT_EQUAL_UINT32(hit.plane, anchor.plane);
  for (int i = 0; i < 3; ++i) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, hit.p_W[i], anchor.p_WA[i]);
    // That of the camera is carried from the keyframe that holds it to where the camera is.
    TEST_ASSERT_DOUBLE_WITHIN(0.5 * hit.covariance[4 * i], hit.covariance[4 * i], anchor.covariance[21 + 7 * i]);
  }
  pf_pose_t pose;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
  pose.p_WC[0] += 0.3;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_pose(slam, &pose, &id[1]));
}

void test_anchors_should_be_saved_and_come_back() {
  pf_slam_t* const slam = walked().slam;
  const Bytes without = saved(slam);
  std::uint32_t id[2];
  set_two(slam, id);
  const Bytes map = saved(slam);
  TEST_ASSERT_EQUAL_size_t(without.size() + 24 + 4 + 2 * 464, map.size());
  Fresh fresh;
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(map));
  const std::vector<pf_anchor_t> was = anchors_of(slam), now = anchors_of(fresh.run.slam);
  TEST_ASSERT_EQUAL_size_t(2, now.size());
  for (std::size_t k = 0; k < 2; ++k) {
    TEST_ASSERT_EQUAL_UINT32(id[k], now[k].id);
    TEST_ASSERT_EQUAL_UINT32(was[k].plane, now[k].plane);
    TEST_ASSERT_EQUAL_UINT32(fresh.report().map_id, now[k].map_id);
    for (int i = 0; i < 4; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-5, was[k].q_WA[i], now[k].q_WA[i]);
    for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-5, was[k].p_WA[i], now[k].p_WA[i]);
    for (int i = 0; i < 6; ++i) TEST_ASSERT_TRUE(now[k].covariance[7 * i] > 0.9 * was[k].covariance[7 * i]);
  }
  TEST_ASSERT_TRUE(saved(fresh.run.slam) == map);
  pf_pose_t pose;
  std::uint32_t none = 77;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(fresh.run.slam, &pose));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_add_anchor_pose(fresh.run.slam, &pose, &none));  // lost
  fresh.run.skip(20);
  while (fresh.run.step() && fresh.run.frames.back().status != PF_OK) continue;
  for (int k = 0; k < 60; ++k) TEST_ASSERT_TRUE(fresh.run.step());
  const std::vector<pf_anchor_t> later = anchors_of(fresh.run.slam);
  for (std::size_t k = 0; k < 2; ++k)
    for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(0.05, was[k].p_WA[i], later[k].p_WA[i]);
  std::uint32_t third[2];
  set_two(fresh.run.slam, third);
  TEST_ASSERT_TRUE(third[0] > id[1]);
  Fresh few;
  few.run.config.capacity.max_anchors = 1;
  few.run.create();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_FULL, few.load(map));
  TEST_ASSERT_EQUAL_INT32(0, few.report().places);
  TEST_ASSERT_EQUAL_INT(PF_STATE_STARTING, few.report().state);
  TEST_ASSERT_EQUAL_INT(PF_OK, few.load(without));
  TEST_ASSERT_EQUAL_size_t(0, anchors_of(few.run.slam).size());
  for (const std::uint32_t one : id) TEST_ASSERT_EQUAL_INT(PF_OK, pf_remove_anchor(slam, one));
  TEST_ASSERT_TRUE(saved(slam) == without);
}

void test_saving_should_change_nothing() {
  RenderedRun& run = walked();
  pf_report_t before, after;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(run.slam, &before));
  const Bytes map = saved(run.slam);
  TEST_ASSERT_TRUE(saved(run.slam) == map);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(run.slam, &after));
  TEST_ASSERT_EQUAL_MEMORY(&before, &after, sizeof(before));
}

void test_a_small_buffer_should_stay_as_it_is() {
  RenderedRun& run = walked();
  const Bytes map = saved(run.slam);
  Bytes small(map.size() - 1, 0x5a);
  std::size_t used = 77;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_MEMORY, pf_save_map(run.slam, PF_MAP_PORTABLE, small.data(), small.size(), &used));
  TEST_ASSERT_EQUAL_size_t(77, used);
  for (const std::uint8_t byte : small) TEST_ASSERT_EQUAL_HEX8(0x5a, byte);
}

void test_kinds_and_null_pointers_should_be_refused() {
  RenderedRun& run = walked();
  std::size_t bytes = 0;
  std::uint8_t byte = 0;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_map_size(nullptr, PF_MAP_PORTABLE, &bytes));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_map_size(run.slam, PF_MAP_PORTABLE, nullptr));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_save_map(run.slam, PF_MAP_PORTABLE, nullptr, 10, &bytes));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_save_map(run.slam, PF_MAP_PORTABLE, &byte, 1, nullptr));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_load_map(run.slam, nullptr, 10));
  for (const int32_t kind : {0, 3, -1}) {
    TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_map_size(run.slam, kind, &bytes));
    TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_save_map(run.slam, kind, &byte, 1, &bytes));
  }
}

void test_a_map_should_be_refused_where_something_else_has_begun() {
  const Bytes map = saved(walked().slam);
  Fresh begun;
  TEST_ASSERT_TRUE(begun.run.step());
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, begun.load(map));
  Fresh at_target;
  at_target.run.start_at_rectangle();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, at_target.load(map));
  Fresh twice;
  TEST_ASSERT_EQUAL_INT(PF_OK, twice.load(map));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, twice.load(map));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(twice.run.slam));
  TEST_ASSERT_EQUAL_INT32(0, twice.report().places);
  TEST_ASSERT_EQUAL_INT(PF_OK, twice.load(map));
  Fresh without(0);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, without.load(map));
  std::size_t bytes = 0;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_map_size(without.run.slam, PF_MAP_PORTABLE, &bytes));
}

/// A filter that was not asked for places has none.
void test_a_filter_without_places_should_refuse_maps() {
  if (RenderedRun::backend != PF_BACKEND_FILTER) return;
  const Bytes map = saved(walked().slam);
  Fresh fresh(-1);
  std::size_t bytes = 0;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, fresh.load(map));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_map_size(fresh.run.slam, PF_MAP_PORTABLE, &bytes));
  pf_memory_t without, with;
  pf_config_t config = fresh.run.config;
  config.capacity.max_places = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &without));
  TEST_ASSERT_EQUAL_size_t(without.bytes, fresh.run.need.bytes);
  config.capacity.max_places = 16;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &with));
  std::printf("16 places add %zu bytes\n", with.bytes - without.bytes);
  TEST_ASSERT_TRUE(with.bytes - without.bytes < 360000);
}

void test_a_start_should_be_refused_in_a_map_that_was_loaded() {
  Fresh fresh;
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(saved(walked().slam)));
  pf_target_t target;
  std::memset(&target, 0, sizeof(target));
  target.kind = PF_TARGET_RECTANGLE;
  target.width = target.height = target.sigma = 0.1;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_start_from_target(fresh.run.slam, &target));
}

void test_a_map_beyond_the_capacities_should_be_refused() {
  const Bytes map = saved(walked().slam);
  Fresh few(1);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_FULL, few.load(map));
  TEST_ASSERT_EQUAL_INT32(0, few.report().places);
  TEST_ASSERT_EQUAL_INT32(0, few.report().planes);
  TEST_ASSERT_EQUAL_INT(PF_STATE_STARTING, few.report().state);
}

void test_a_damaged_map_should_be_refused_and_change_nothing() {
  const Bytes map = saved(walked().slam);
  Fresh fresh;
  const pf_report_t before = fresh.report();
  for (std::size_t k = 0; k < 400; ++k) {
    Bytes damaged = map;
    damaged[k * (map.size() - 1) / 399] ^= 0x10;
    TEST_ASSERT_EQUAL_INT(PF_ERROR_MAP, fresh.load(damaged));
    Bytes cut = map;  // at an address of its own, so that what is read behind its end shows
    cut.resize(k * (map.size() - 1) / 399);
    cut.shrink_to_fit();
    cut.reserve(1);
    TEST_ASSERT_EQUAL_INT(PF_ERROR_MAP, pf_load_map(fresh.run.slam, cut.data(), cut.size()));
  }
  TEST_ASSERT_FALSE(last_line.empty());
  const pf_report_t after = fresh.report();
  TEST_ASSERT_EQUAL_MEMORY(&before, &after, sizeof(before));
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(map));
}

/// No new map begins before the old one is found.
void test_a_loaded_map_should_be_searched_for_without_end() {
  Fresh fresh;
  TEST_ASSERT_EQUAL_INT(PF_OK, fresh.load(saved(walked().slam)));
  std::vector<std::uint8_t> other(320 * 240);
  pf_camera_t camera = fresh.run.config.camera;
  other.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int frame = 0; frame < 60; ++frame) {
    for (std::size_t i = 0; i < other.size(); ++i) {
      const std::size_t x = i % static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(frame),
                        y = i / static_cast<std::size_t>(camera.width);
      other[i] = static_cast<std::uint8_t>((x / 9 * 2654435761u ^ y / 7 * 40503u) >> 5);
    }
    const pf_image_t image = {other.data(), camera.width, camera.height, camera.width,
                              (frame + 1) * INT64_C(200000000)};
    TEST_ASSERT_EQUAL_INT(PF_NOTE_LOST, pf_push_frame(fresh.run.slam, &image));
  }
  TEST_ASSERT_EQUAL_UINT32(1, fresh.report().map_id);
  TEST_ASSERT_TRUE(fresh.report().places > 0);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  for (const pf_backend_t backend : {PF_BACKEND_WINDOW, PF_BACKEND_FILTER}) {
    RenderedRun::backend = backend;
    std::printf("%s\n", backend == PF_BACKEND_FILTER ? "filter" : "window");
    RUN_TEST(test_a_saved_map_should_be_found_again);
    RUN_TEST(test_a_map_of_the_other_back_end_should_be_found);
    RUN_TEST(test_a_map_that_was_loaded_should_be_saved_as_the_same_bytes);
    RUN_TEST(test_anchors_should_be_saved_and_come_back);
    RUN_TEST(test_saving_should_change_nothing);
    RUN_TEST(test_a_small_buffer_should_stay_as_it_is);
    RUN_TEST(test_kinds_and_null_pointers_should_be_refused);
    RUN_TEST(test_a_map_should_be_refused_where_something_else_has_begun);
    RUN_TEST(test_a_filter_without_places_should_refuse_maps);
    RUN_TEST(test_a_start_should_be_refused_in_a_map_that_was_loaded);
    RUN_TEST(test_a_map_beyond_the_capacities_should_be_refused);
    RUN_TEST(test_a_damaged_map_should_be_refused_and_change_nothing);
    RUN_TEST(test_a_loaded_map_should_be_searched_for_without_end);
  }
  return UNITY_END();
}
