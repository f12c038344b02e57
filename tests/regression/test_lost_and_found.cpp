// Frames that do not support the pose: another place, no picture, and a view that comes back. Rendered, at 320x240.
#include <planefold_platform/sim.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "planefold/planefold.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::uint64_t kSeed = 11;
constexpr std::int64_t kFrameNs = 33333333;
constexpr int kPixels = 320 * 240;
constexpr int kSecond = 30;  // frames

using Picture = std::vector<std::uint8_t>;

/// The first pictures of a scene, all of which have one camera. The target stands on the desk only.
class Film {
 public:
  Film(const char* scene, int frames, std::uint64_t seed = kSeed) {
    pf_sim_options_t options;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default(scene, &options));
    options.camera = {PF_CAMERA_PINHOLE,  320, 240, 260, 260, 159.5, 119.5, {}, 0, PF_CAMERA_EXACT,
                      PF_TIMESTAMPS_REAL, 0,   0,   0,   {}};
    options.seed = seed;
    options.target = std::strcmp(scene, "desk") == 0;
    options.frames = frames;
    pf_sim_t* sim = pf_sim_open(scene, &options);
    TEST_ASSERT_NOT_NULL(sim);
    pf_sim_camera(sim, &camera);
    if (options.target) {
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_target(sim, PF_TARGET_RECTANGLE, &target));
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_target(sim, PF_TARGET_POINTS, &points));
    }
    pf_image_t image;
    pf_pose_t pose;
    while (pf_sim_next(sim, &image, &pose) == 1) {
      picture.emplace_back(image.pixels, image.pixels + kPixels);
      truth.push_back(pose);
    }
    pf_sim_close(sim);
    TEST_ASSERT_EQUAL_size_t(static_cast<std::size_t>(frames), picture.size());
  }

  pf_camera_t camera;
  pf_target_t target = {}, points = {};
  std::vector<Picture> picture;
  std::vector<pf_pose_t> truth;
};

const Film& desk() {
  static const Film film("desk", 4 * kSecond);
  return film;
}

const Film& room() {
  static const Film film("room", 8 * kSecond);
  return film;
}

/// A context that has tracked the beginning of the desk, and what it says to further pictures.
class Run {
 public:
  explicit Run(double restart_s, int max_kept_views = 24, int tracked = 3 * kSecond, bool with_wall = false,
               bool at_points = false) {
    std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
    pf_config_t config;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
    config.camera = desk().camera;
    config.motion.restart_s = restart_s;
    config.capacity.max_kept_views = max_kept_views;
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
    block_ = std::aligned_alloc(need.alignment, (need.bytes + need.alignment) / need.alignment * need.alignment);
    TEST_ASSERT_NOT_NULL(block_);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block_, need.bytes, &slam));
    pf_target_t target = at_points ? desk().points : desk().target;
    if (with_wall) target.q_WT[0] = 1;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
    if (with_wall) add_wall_of_target();
    for (int i = 0; i < tracked; ++i) TEST_ASSERT_EQUAL_INT(PF_OK, show(desk().picture[static_cast<std::size_t>(i)]));
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;
  ~Run() { std::free(block_); }

  pf_status_t show(const Picture& picture) {
    t_ns_ += kFrameNs;
    const pf_image_t image = {picture.data(), 320, 240, 320, t_ns_};
    const pf_status_t status = pf_push_frame(slam, &image);
    TEST_ASSERT_TRUE(status >= PF_OK);
    if (pf_get_pose(slam, &pose) != PF_OK) pose.t_ns = -1;
    return status;
  }
  pf_status_t show_black() { return show(Picture(kPixels, 0)); }

  std::vector<pf_feature_t> features() const {
    std::vector<pf_feature_t> features(200);
    std::size_t count = 0;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(slam, features.data(), features.size(), &count));
    features.resize(count);
    return features;
  }
  std::vector<std::uint32_t> ids() const {
    std::vector<std::uint32_t> all;
    for (const pf_feature_t& feature : features()) all.push_back(feature.id);
    return all;
  }

  pf_slam_t* slam = nullptr;
  pf_pose_t pose{};
  std::uint32_t wall = 0;

 private:
  /// The side of the box that carries the target: z = 0, seen from -z.
  void add_wall_of_target() {
    pf_wall_prior_t prior = {};
    prior.R_WP[0] = 1;
    prior.R_WP[4] = prior.R_WP[8] = -1;
    prior.covariance[0] = prior.covariance[4] = 1e-3;
    prior.covariance[8] = 1e-4;
    prior.outline_count = 4;
    const double corner[4][2] = {{-0.2, -0.15}, {0.2, -0.15}, {0.2, 0.15}, {-0.2, 0.15}};
    std::copy(&corner[0][0], &corner[0][0] + 8, &prior.outline_P[0][0]);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &prior, &wall));
  }

  void* block_ = nullptr;
  std::int64_t t_ns_ = 0;
};

double kept_share(const std::vector<std::uint32_t>& before, const std::vector<std::uint32_t>& now) {
  int kept = 0;
  for (const std::uint32_t id : before) kept += std::find(now.begin(), now.end(), id) != now.end() ? 1 : 0;
  return static_cast<double>(kept) / static_cast<double>(before.size());
}

double distance(const pf_pose_t& a, const pf_pose_t& b) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += (a.p_WC[i] - b.p_WC[i]) * (a.p_WC[i] - b.p_WC[i]);
  return std::sqrt(sum);
}

void test_another_place_after_a_blackout_should_never_be_called_tracked() {
  for (const int black : {6, kSecond / 2, kSecond, 2 * kSecond}) {
    Run run(0);
    for (int i = 0; i < black; ++i) run.show_black();
    int tracked = 0;
    for (int i = 0; i < 4 * kSecond; ++i)
      tracked += run.show(room().picture[static_cast<std::size_t>(i)]) == PF_OK ? 1 : 0;
    std::printf("%d black frames: tracked %d of %d of another place\n", black, tracked, 4 * kSecond);
    TEST_ASSERT_EQUAL_INT(0, tracked);
  }
}

/// A wall in which half a second without a picture once ended in 98 of 120 frames with PF_OK.
void test_a_wall_after_half_a_second_without_a_picture_should_never_be_called_tracked() {
  const Film wall("wall", 8 * kSecond, 20);
  Run run(0);
  for (int i = 0; i < kSecond / 2; ++i) run.show_black();
  int tracked = 0;
  for (std::size_t i = 4 * kSecond; i < wall.picture.size(); ++i) tracked += run.show(wall.picture[i]) == PF_OK ? 1 : 0;
  TEST_ASSERT_EQUAL_INT(0, tracked);
}

void test_another_place_without_a_blackout_should_never_be_called_tracked() {
  Run run(0);
  int tracked = 0;
  for (int i = 0; i < 8 * kSecond; ++i)
    tracked += run.show(room().picture[static_cast<std::size_t>(i)]) == PF_OK ? 1 : 0;
  TEST_ASSERT_EQUAL_INT(0, tracked);
}

/// Hardly a depth is known yet, and five matches along open rays agree nearly anywhere.
void test_another_place_should_teach_a_map_of_a_few_frames_nothing() {
  const Film wall("wall", 4 * kSecond, 20);
  for (const Film* place : {&room(), &wall}) {
    for (const int frames : {2, 5, 8, 15}) {
      for (const int black : {0, kSecond}) {
        Run run(0, 24, frames);
        for (int i = 0; i < black; ++i) run.show_black();
        pf_pose_t before = run.pose;
        for (std::size_t i = 0; i < 2 * kSecond; ++i) {
          TEST_ASSERT_NOT_EQUAL(PF_OK, run.show(place->picture[2 * i]));
          for (int k = 0; k < 6; ++k) TEST_ASSERT_TRUE(run.pose.covariance[7 * k] >= before.covariance[7 * k]);
          before = run.pose;
        }
      }
    }
  }
}

void test_covariance_should_never_shrink_while_coasting_or_lost() {
  Run run(0);
  pf_pose_t before = run.pose;
  for (int i = 0; i < 10 * kSecond; ++i) {
    const bool black = i < 2 * kSecond;
    const pf_status_t status =
        black ? run.show_black() : run.show(room().picture[static_cast<std::size_t>(i - 2 * kSecond)]);
    TEST_ASSERT_NOT_EQUAL(PF_OK, status);
    for (int k = 0; k < 6; ++k) TEST_ASSERT_TRUE(run.pose.covariance[7 * k] >= before.covariance[7 * k]);
    before = run.pose;
  }
  // A hand of 1 m/s may be anywhere in the room by then.
  TEST_ASSERT_TRUE(before.covariance[21] + before.covariance[28] + before.covariance[35] > 1);
}

void test_ids_should_survive_ten_seconds_without_pictures_and_eight_of_another_place() {
  Run run(0);
  const std::vector<std::uint32_t> before = run.ids();
  for (int i = 0; i < 10 * kSecond; ++i) run.show_black();
  TEST_ASSERT_EQUAL_DOUBLE(1, kept_share(before, run.ids()));
  for (const Picture& picture : room().picture) run.show(picture);
  TEST_ASSERT_EQUAL_DOUBLE(1, kept_share(before, run.ids()));
}

void test_the_map_should_be_found_again_where_it_was_left() {
  for (const int away : {0, 5 * kSecond}) {
    Run run(0);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(run.slam));
    const double before = distance(run.pose, desk().truth[3 * kSecond - 1]);
    for (int i = 0; i < kSecond; ++i) run.show_black();
    for (int i = 0; i < away; ++i) run.show(room().picture[static_cast<std::size_t>(i)]);
    int frames = 0;
    std::size_t at = 3 * kSecond;
    while (frames < kSecond && run.show(desk().picture[at++]) != PF_OK) ++frames;
    std::printf("found after %d frames, %.4f m off\n", frames, distance(run.pose, desk().truth[at - 1]));
    TEST_ASSERT_LESS_THAN_INT(kSecond, frames);
    TEST_ASSERT_TRUE(distance(run.pose, desk().truth[at - 1]) < 0.03);
    TEST_ASSERT_EQUAL_UINT32(1, run.pose.map_id);
    pf_motion_t motion;  // the mark is where it was
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(run.slam, &motion));
    TEST_ASSERT_DOUBLE_WITHIN(0.03 + before, distance(desk().truth[at - 1], desk().truth[3 * kSecond - 1]),
                              std::hypot(motion.p_KC[0], motion.p_KC[1], motion.p_KC[2]));
    for (; at < desk().picture.size(); ++at) TEST_ASSERT_EQUAL_INT(PF_OK, run.show(desk().picture[at]));
  }
}

void test_a_new_map_should_begin_with_a_new_id_after_restart_s_of_usable_pictures() {
  Run run(2);
  const std::vector<std::uint32_t> before = run.ids();
  TEST_ASSERT_EQUAL_UINT32(1, run.pose.map_id);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(run.slam));
  pf_motion_t motion;
  for (int i = 0; i < 10 * kSecond; ++i) run.show_black();  // no picture is no reason for a new map
  TEST_ASSERT_EQUAL_UINT32(1, run.pose.map_id);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(run.slam, &motion));
  int begun = -1;
  std::uint32_t last_id = 1;
  for (int i = 0; i < static_cast<int>(room().picture.size()); ++i) {
    run.show(room().picture[static_cast<std::size_t>(i)]);
    if (begun < 0 && run.pose.map_id > 1) begun = i;
    // An id belongs to one W: a start that is lost before any depth is known takes its id along.
    TEST_ASSERT_TRUE(run.pose.t_ns < 0 || run.pose.map_id >= last_id);
    if (run.pose.t_ns >= 0) last_id = run.pose.map_id;
  }
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_get_motion_since_mark(run.slam, &motion));  // the mark went with its map
  std::printf("a new map after %d frames\n", begun);
  TEST_ASSERT_INT_WITHIN(2, 2 * kSecond, begun);
  TEST_ASSERT_GREATER_THAN_UINT32(1, run.pose.map_id);
  TEST_ASSERT_EQUAL_DOUBLE(0, kept_share(before, run.ids()));
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(run.slam, &report));
  TEST_ASSERT_EQUAL_UINT32(run.pose.map_id, report.map_id);
  TEST_ASSERT_EQUAL_INT32(PF_STATE_TRACKING, report.state);
  pf_feature_t feature;
  std::size_t count;
  TEST_ASSERT_EQUAL_INT(PF_NOTE_TRUNCATED, pf_get_features(run.slam, &feature, 1, &count));
  TEST_ASSERT_EQUAL_UINT32(run.pose.map_id, feature.map_id);
}

/// Pictures of another place until a new map begins, in the frame of that number with one in front of the target. Returns the frame.
int show_room_until_new_map(Run* run, int in_front_of_target) {
  for (int i = 0; i < static_cast<int>(room().picture.size()); ++i) {
    run->show(i == in_front_of_target ? desk().picture[0] : room().picture[static_cast<std::size_t>(i)]);
    if (run->pose.map_id > 1 && run->pose.t_ns >= 0) return i;
  }
  TEST_FAIL_MESSAGE("no new map began");
  return -1;
}

int target_points_in_new_map(bool at_points) {
  Run first(2, 24, kSecond, false, at_points), second(2, 24, kSecond, false, at_points);
  const int begun = show_room_until_new_map(&first, -1);
  TEST_ASSERT_EQUAL_INT(begun, show_room_until_new_map(&second, begun));
  int count = 0;
  for (const pf_feature_t& feature : second.features()) count += feature.is_target;
  return count;
}

/// The pose that comes with known points says where the camera is in the first frame. After a loss, strong corners near those pixels are
/// chance: on a real desk 18 of 18 new maps began there at wrong places, by 20 degrees to half a turn.
void test_a_new_map_should_begin_at_a_rectangle_and_not_at_points_of_the_first_frame() {
  TEST_ASSERT_EQUAL_INT(4, target_points_in_new_map(false));
  TEST_ASSERT_EQUAL_INT(0, target_points_in_new_map(true));
}

void test_no_new_map_should_begin_when_restart_s_is_zero() {
  Run run(0);
  for (const Picture& picture : room().picture) run.show(picture);
  TEST_ASSERT_EQUAL_UINT32(1, run.pose.map_id);
  pf_state_t state;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_state(run.slam, &state));
  TEST_ASSERT_EQUAL_INT(PF_STATE_LOST, state);
}

/// W is the plan's as long as the map has a wall of it: another map would begin somewhere else.
void test_no_new_map_should_begin_as_long_as_a_wall_is_known() {
  Run run(2, 24, 3 * kSecond, true);
  for (const Picture& picture : room().picture) run.show(picture);
  TEST_ASSERT_EQUAL_UINT32(1, run.pose.map_id);
  pf_state_t state;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_state(run.slam, &state));
  TEST_ASSERT_EQUAL_INT(PF_STATE_LOST, state);
  int frames = 0;
  for (std::size_t at = 3 * kSecond; frames < kSecond && run.show(desk().picture[at]) != PF_OK; ++at) ++frames;
  std::printf("found after %d frames\n", frames);
  TEST_ASSERT_LESS_THAN_INT(kSecond, frames);
  TEST_ASSERT_EQUAL_UINT32(1, run.pose.map_id);
  pf_plane_t planes[16];
  std::size_t count = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_planes(run.slam, planes, 16, &count));
  const pf_plane_t* wall = std::find_if(planes, planes + count, [&](const pf_plane_t& p) { return p.id == run.wall; });
  TEST_ASSERT_TRUE(wall != planes + count);
  TEST_ASSERT_EQUAL_INT(1, wall->is_wall);
  TEST_ASSERT_EQUAL_INT(0, wall->rejected);
}

void test_a_short_gap_should_be_recovered_without_kept_views() {
  Run run(0, 0);
  for (int i = 0; i < 6; ++i) run.show_black();
  int frames = 0;
  std::size_t at = 3 * kSecond;
  while (frames < kSecond && run.show(desk().picture[at++]) != PF_OK) ++frames;
  std::printf("found after %d frames\n", frames);
  TEST_ASSERT_LESS_THAN_INT(6, frames);
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(run.slam, &report));
  TEST_ASSERT_EQUAL_INT32(0, report.kept_views);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_another_place_after_a_blackout_should_never_be_called_tracked);
  RUN_TEST(test_a_wall_after_half_a_second_without_a_picture_should_never_be_called_tracked);
  RUN_TEST(test_another_place_without_a_blackout_should_never_be_called_tracked);
  RUN_TEST(test_another_place_should_teach_a_map_of_a_few_frames_nothing);
  RUN_TEST(test_covariance_should_never_shrink_while_coasting_or_lost);
  RUN_TEST(test_ids_should_survive_ten_seconds_without_pictures_and_eight_of_another_place);
  RUN_TEST(test_the_map_should_be_found_again_where_it_was_left);
  RUN_TEST(test_a_new_map_should_begin_with_a_new_id_after_restart_s_of_usable_pictures);
  RUN_TEST(test_a_new_map_should_begin_at_a_rectangle_and_not_at_points_of_the_first_frame);
  RUN_TEST(test_no_new_map_should_begin_when_restart_s_is_zero);
  RUN_TEST(test_no_new_map_should_begin_as_long_as_a_wall_is_known);
  RUN_TEST(test_a_short_gap_should_be_recovered_without_kept_views);
  return UNITY_END();
}
