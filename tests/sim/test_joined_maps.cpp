// A camera that is taken elsewhere and comes back: the map that began meanwhile is recognised in the one that was left, and joined to it.
// What was given out in it goes along by the correction of that frame.
#include "support/given_poses.h"
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
  GivenPose kept;  ///< as it was given out, and corrected since
};

/// An anchor at a pose of the present map, and what the frame that joins the map makes of it.
struct Probe {
  std::uint32_t id = 0;
  Correction join;
  GivenPose before, after;

  static GivenPose read(const pf_slam_t* slam, std::uint32_t id) {
    pf_anchor_t anchor;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchor(slam, id, &anchor));
    return GivenPose::of(anchor);
  }
};

void correct(const Correction& by, std::vector<Seen>* seen) {
  for (Seen& one : *seen) one.kept = by.of(one.kept);
}

/// Plays frames of a film. Returns what was tracked. earlier: what was, which is corrected too. probe: is set in the first tracked frame,
/// and compared where the map goes on under another id.
std::vector<Seen> play(Context& context, Film& film, int count, std::int64_t* t_ns,
                       std::vector<Seen>* earlier = nullptr, Probe* probe = nullptr) {
  std::vector<Seen> out;
  for (int k = 0; k < count; ++k) {
    pf_image_t image = film.at(static_cast<std::size_t>(k)).image;
    image.t_ns = *t_ns += 33333333;
    pf_pose_t pose;
    pf_report_t report;
    const GivenPose before = probe != nullptr && probe->id != 0 ? Probe::read(context.slam, probe->id) : GivenPose();
    const pf_status_t status = pf_push_frame(context.slam, &image);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(context.slam, &report));
    const Correction correction = Correction::of(report);
    correct(correction, &out);
    if (earlier != nullptr) correct(correction, earlier);
    if (probe != nullptr && probe->id != 0 && correction.from != correction.to && correction.from == before.map_id) {
      probe->join = correction;
      probe->before = before;
      probe->after = Probe::read(context.slam, probe->id);
    }
    if (status != PF_OK || pf_get_pose(context.slam, &pose) != PF_OK) continue;
    if (probe != nullptr && probe->id == 0)
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_pose(context.slam, &pose, &probe->id));
    Seen seen = {report.map_id, {}, {}, GivenPose::of(pose)};
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
  std::vector<Seen> first = play(context, room, kFirst, &t_ns);
  std::printf("%zu of %d frames tracked\n", first.size(), kFirst);
  TEST_ASSERT_TRUE(first.size() > kFirst / 2);
  play(context, desk, kAway, &t_ns);
  Probe probe;
  const std::vector<Seen> again = play(context, room, kBack, &t_ns, &first, &probe);
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
  // In the frame that joins the maps an anchor, and so all of the newer map, moves as the correction says.
  std::printf("map %u is map %u, scaled by %.4f: an anchor is off by %.2e\n", probe.join.from, probe.join.to,
              probe.join.scale, probe.join.of(probe.before).distance(probe.after));
  TEST_ASSERT_EQUAL_UINT32(1, probe.join.to);
  TEST_ASSERT_EQUAL_UINT32(1, probe.after.map_id);
  TEST_ASSERT_TRUE(std::fabs(probe.join.scale - 1) > 0.01);
  TEST_ASSERT_TRUE(probe.join.of(probe.before).distance(probe.after) < 1e-6);
  // Poses of the newer map, as they were given out and as they are kept: against those of the first map.
  double raw = 0, kept = 0;
  int count = 0;
  for (std::size_t i = 0; i < joined; ++i) {
    if (again[i].map_id != probe.join.from) continue;
    TEST_ASSERT_EQUAL_UINT32(1, again[i].kept.map_id);
    ++count;
    for (const Seen& a : first) {
      const double truth = distance(a.truth, again[i].truth);
      raw = std::max(raw, std::fabs(distance(a.p, again[i].p) * metres / units - truth));
      kept = std::max(kept, std::fabs(distance(a.kept.p.data(), again[i].kept.p.data()) * metres / units - truth));
    }
  }
  std::printf("%d poses of the newer map: off by %.3f m as they were given out, by %.3f m when corrected\n", count, raw,
              kept);
  TEST_ASSERT_TRUE(count > 5);
  TEST_ASSERT_TRUE(kept < 0.1 * metres && kept < 0.5 * raw);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_map_should_be_joined_to_the_one_that_was_left_before);
  return UNITY_END();
}
