// A camera that is taken elsewhere and comes back: the map that began meanwhile is recognised in the one that was left, and joined to it.
#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Frames in the first scene, in another one, and in the first one again.
constexpr int kFirst = 200, kAway = 110, kBack = 200;

struct Context {
  pf_slam_t* slam = nullptr;
  std::vector<unsigned char> block;

  explicit Context(const pf_camera_t& camera) {
    pf_config_t config;
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
    config.camera = camera;
    config.backend = PF_BACKEND_WINDOW;
    config.map.features_in_view = 150;
    config.motion.restart_s = 1;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
    block.resize(need.bytes + need.alignment);
    unsigned char* at =
        block.data() + (need.alignment - reinterpret_cast<std::uintptr_t>(block.data()) % need.alignment);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, at, need.bytes, &slam));
  }
};

struct Seen {
  std::uint32_t map_id;
  double p[3], truth[3];
};

/// Plays frames of a film. Returns what was tracked.
std::vector<Seen> play(Context& context, Film& film, int count, std::int64_t* t_ns) {
  std::vector<Seen> out;
  for (int k = 0; k < count; ++k) {
    pf_image_t image = film.at(static_cast<std::size_t>(k)).image;
    image.t_ns = *t_ns += 33333333;
    pf_pose_t pose;
    pf_report_t report;
    if (pf_push_frame(context.slam, &image) != PF_OK || pf_get_pose(context.slam, &pose) != PF_OK) continue;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(context.slam, &report));
    Seen seen = {report.map_id, {}, {}};
    for (int i = 0; i < 3; ++i) {
      seen.p[i] = pose.p_WC[i];
      seen.truth[i] = film.at(static_cast<std::size_t>(k)).truth.p_WC[i];
    }
    out.push_back(seen);
  }
  return out;
}

double distance(const double a[3], const double b[3]) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

void test_a_map_should_be_joined_to_the_one_that_was_left_before() {
  pf_sim_options_t options;
  pf_sim_options_default("room", &options);
  options.seed = 5;
  Film& room = Film::of("room", options);
  pf_sim_options_t of_desk;
  pf_sim_options_default("desk", &of_desk);
  of_desk.seed = 6;
  Film& desk = Film::of("desk", of_desk);
  pf_camera_t camera;
  pf_sim_camera(room.scene(), &camera);
  Context context(camera);
  std::int64_t t_ns = 0;
  const std::vector<Seen> first = play(context, room, kFirst, &t_ns);
  std::printf("%zu of %d frames tracked\n", first.size(), kFirst);
  TEST_ASSERT_TRUE(first.size() > kFirst / 2);
  play(context, desk, kAway, &t_ns);
  const std::vector<Seen> again = play(context, room, kBack, &t_ns);
  TEST_ASSERT_TRUE(!again.empty());
  std::size_t joined = 0;
  while (joined < again.size() && again[joined].map_id != 1) ++joined;
  std::printf("maps %u .. %u, joined after %zu of %zu tracked frames\n", again.front().map_id, again.back().map_id,
              joined, again.size());
  TEST_ASSERT_TRUE_MESSAGE(again.front().map_id > 1, "it was never lost");
  TEST_ASSERT_EQUAL_UINT32_MESSAGE(1, again.back().map_id, "it was not joined");
  // The unit of the first map, by the two of its places that are farthest apart; then distances of places before and after.
  double units = 0, metres = 0;
  for (const Seen& a : first)
    for (const Seen& b : first)
      if (distance(a.truth, b.truth) > metres) {
        metres = distance(a.truth, b.truth);
        units = distance(a.p, b.p);
      }
  double worst = 0;
  for (std::size_t i = joined; i < again.size(); ++i)
    for (const Seen& a : first)
      worst =
          std::max(worst, std::fabs(distance(a.p, again[i].p) * metres / units - distance(a.truth, again[i].truth)));
  std::printf("places over %.2f m: off by at most %.3f m against those before\n", metres, worst);
  TEST_ASSERT_TRUE(worst < 0.1 * metres);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_map_should_be_joined_to_the_one_that_was_left_before);
  return UNITY_END();
}
