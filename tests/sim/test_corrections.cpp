// What a frame's report says of poses that were given out before: it is by how much anchors move that stand at such poses, for updates of
// the filter and, with either back end, where the map gets its scale; and the motion from frame to frame is nearer to the truth with it.
#include <cmath>
#include <cstdio>
#include <vector>

#include "base/eigen.h"
#include "support/given_poses.h"
#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

double tolerance(const pf_config_t& config) { return config.scalar == PF_SCALAR_FLOAT ? 1e-4 : 1e-6; }

std::uint32_t anchor_at(pf_slam_t* slam, const pf_pose_t& pose) {
  std::uint32_t id = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_pose(slam, &pose, &id));
  return id;
}

GivenPose given(const pf_slam_t* slam, std::uint32_t id) {
  pf_anchor_t anchor;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchor(slam, id, &anchor));
  return GivenPose::of(anchor);
}

/// Frames in which the corrections were compared with an anchor, how many of them moved it, by how much in all, and what is left at most.
struct Compared {
  int frames = 0, moved = 0;
  double length = 0, worst = 0;
};

/// An anchor stands at the last pose that was given out, of every tenth frame.
Compared compare(RenderedRun& run, std::size_t frames) {
  Compared out;
  std::uint32_t id = 0;
  GivenPose before;
  while (run.frames.size() < frames) {
    if (id != 0) before = given(run.slam, id);
    TEST_ASSERT_TRUE(run.step());
    const RenderedRun::Frame& frame = run.frames.back();
    const Correction correction = Correction::of(frame.report);
    if (id != 0) {
      const GivenPose now = given(run.slam, id), told = correction.of(before);
      ++out.frames;
      out.moved += correction.is_identity() ? 0 : 1;
      out.length += (now.p - before.p).norm();
      out.worst = std::max(out.worst, told.distance(now));
      TEST_ASSERT_EQUAL_UINT32(now.map_id, told.map_id);
    }
    if (frame.status != PF_OK) continue;
    if (run.frames.size() % 10 != 0) continue;
    if (id != 0) TEST_ASSERT_EQUAL_INT(PF_OK, pf_remove_anchor(run.slam, id));
    id = anchor_at(run.slam, frame.pose);
  }
  std::printf("%d frames, in %d of them moved by %.4f in all: off by %.2e at most\n", out.frames, out.moved, out.length,
              out.worst);
  return out;
}

/// Motion of the camera from one frame to the next, in the frame before.
Eigen::Vector3d motion(const GivenPose& from, const GivenPose& to) { return from.q.conjugate() * (to.p - from.p); }

/// How far motions from frame to frame are from the truth, as poses were given out and with the first one corrected: root mean square over
/// frames that correct something [m].
void motions_are_nearer_to_the_truth(pf_backend_t backend) {
  RenderedRun::backend = backend;
  RenderedRun run("desk", 300, RenderedRun::Start::kRectangle);
  if (backend == PF_BACKEND_WINDOW)
    run.tracked_until(300);
  else
    compare(run, 300);
  double given = 0, corrected = 0, moved = 0;
  int count = 0;
  for (std::size_t i = 1; i < run.frames.size(); ++i) {
    const RenderedRun::Frame &before = run.frames[i - 1], &now = run.frames[i];
    const Correction correction = Correction::of(now.report);
    if (before.status != PF_OK || now.status != PF_OK || correction.is_identity()) continue;
    const GivenPose from = GivenPose::of(before.pose), to = GivenPose::of(now.pose), kept = correction.of(from);
    const Eigen::Vector3d truth = motion(GivenPose::of(before.truth), GivenPose::of(now.truth));
    given += (motion(from, to) - truth).squaredNorm();
    corrected += (motion(kept, to) - truth).squaredNorm();
    moved += (kept.p - from.p).squaredNorm();
    ++count;
  }
  TEST_ASSERT_TRUE(count > 10);
  const auto mm = [&](double sum) { return 1e3 * std::sqrt(sum / count); };
  std::printf("%d frames, moved by %.3f mm: motions off by %.3f mm, corrected %.3f mm\n", count, mm(moved), mm(given),
              mm(corrected));
  TEST_ASSERT_TRUE(corrected < 0.5 * given);
}

void test_motions_of_the_filter_should_be_nearer_to_the_truth_when_corrected() {
  motions_are_nearer_to_the_truth(PF_BACKEND_FILTER);
}
void test_motions_of_the_window_should_be_nearer_to_the_truth_when_corrected() {
  motions_are_nearer_to_the_truth(PF_BACKEND_WINDOW);
}

void camera_moves_as_the_correction_says(RenderedRun::Start start) {
  RenderedRun::backend = PF_BACKEND_FILTER;
  RenderedRun run("desk", 200, start);
  const Compared compared = compare(run, 200);
  TEST_ASSERT_TRUE(compared.frames > 100 && compared.moved > 100 && compared.length > 1e-3);
  TEST_ASSERT_TRUE(compared.worst < tolerance(run.config));
}

void test_a_camera_that_an_update_moves_should_move_as_the_correction_says() {
  camera_moves_as_the_correction_says(RenderedRun::Start::kNone);
}
void test_it_should_do_so_after_a_start_at_a_target() {
  camera_moves_as_the_correction_says(RenderedRun::Start::kRectangle);
}

void test_without_a_camera_in_the_state_nothing_should_be_told() {
  RenderedRun::backend = PF_BACKEND_FILTER;
  RenderedRun run("desk", 60, RenderedRun::Start::kRectangle);
  run.tracked_until(60);
  for (const RenderedRun::Frame& frame : run.frames) {
    TEST_ASSERT_TRUE(Correction::of(frame.report).is_identity());
    TEST_ASSERT_EQUAL_UINT32(frame.report.map_id, frame.report.correction_from_map_id);
  }
}

/// What a frame that is repeated, or unusable, says.
void test_a_frame_that_moves_nothing_should_say_so() {
  RenderedRun::backend = PF_BACKEND_WINDOW;
  RenderedRun run("desk", 120, RenderedRun::Start::kNone);
  run.tracked_until(60);
  while (Correction::of(run.frames.back().report).is_identity()) TEST_ASSERT_TRUE(run.step());
  TEST_ASSERT_TRUE(run.freeze());
  TEST_ASSERT_TRUE(Correction::of(run.frames.back().report).is_identity());
  TEST_ASSERT_TRUE(run.step(0));
  TEST_ASSERT_TRUE(Correction::of(run.frames.back().report).is_identity());
}

/// The window, by a second pose: all that is in the map, features and keyframes, is scaled.
void test_a_map_that_is_scaled_should_say_by_how_much() {
  constexpr std::size_t kSecond = 120;
  RenderedRun::backend = PF_BACKEND_WINDOW;
  RenderedRun run("desk", 160, RenderedRun::Start::kNone);
  run.tracked_until(kSecond);
  do TEST_ASSERT_TRUE(run.step());
  while (run.frames.back().report.new_features == 0);  // behind a keyframe: the next frame adjusts nothing
  pf_pose_t pose{};
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = 1e-6;
  pose.p_WC[0] = 0.3;
  const pf_pose_t last = run.frames.back().pose;
  const std::uint32_t id = anchor_at(run.slam, last);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_second_pose(run.slam, last.t_ns + 33333333, &pose));
  const GivenPose before = given(run.slam, id);
  std::vector<pf_feature_t> features(300), now(300);
  std::size_t count = 0, count_now = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(run.slam, features.data(), features.size(), &count));
  TEST_ASSERT_TRUE(run.step());
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(run.slam, now.data(), now.size(), &count_now));
  const Correction correction = Correction::of(run.frames.back().report);
  std::printf("scale %.4f\n", correction.scale);
  TEST_ASSERT_TRUE(std::fabs(correction.scale - 1) > 0.01);
  TEST_ASSERT_EQUAL_UINT32(run.frames.back().report.map_id, run.frames.back().report.correction_from_map_id);
  TEST_ASSERT_TRUE(correction.of(before).distance(given(run.slam, id)) < tolerance(run.config));
  int same = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < count_now; ++k) {
      const Eigen::Map<const Eigen::Vector3d> p(features[i].p_W), q(now[k].p_W);
      if (now[k].id == features[i].id && (correction.of(p) - q).norm() < tolerance(run.config)) ++same;
    }
  std::printf("%d of %zu points are where it says\n", same, count);
  TEST_ASSERT_TRUE(same > static_cast<int>(count) / 2);
}

/// Becoming metric by samples, while the camera moves.
void metric_map_says_so(pf_backend_t backend) {
  pf_sim_options_t options;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default("room", &options));
  options.seed = 3;
  Film& film = Film::of("room", options);
  pf_sim_imu_options_t unit;
  pf_sim_imu_options_default(&unit);
  pf_sim_imu_t* const imu = pf_sim_imu_open(film.scene(), &unit);
  TEST_ASSERT_NOT_NULL(imu);
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam = nullptr;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  pf_sim_camera(film.scene(), &config.camera);
  config.backend = backend;
  if (backend == PF_BACKEND_WINDOW) config.map.features_in_view = 150;
  config.motion.model = PF_MOTION_INERTIAL;
  config.capacity.max_imu_samples = 400;
  config.imu = unit.model;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  void* const block = std::aligned_alloc(need.alignment, (need.bytes / need.alignment + 1) * need.alignment);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
  std::uint32_t id = 0;
  bool is_renamed = false;
  std::vector<GivenPose> early;  ///< poses of the map up to scale, as they were given out and corrected since
  std::vector<Eigen::Vector3d> truth;
  for (std::size_t k = 0; k < 400 && !is_renamed; ++k) {
    const Film::Frame& frame = film.at(k);
    while (pf_sim_imu_next_ns(imu) <= frame.image.t_ns) {
      pf_imu_sample_t sample;
      pf_sim_imu_next(imu, &sample);
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
    }
    GivenPose before;
    if (id != 0) before = given(slam, id);
    const pf_status_t status = pf_push_frame(slam, &frame.image);
    pf_report_t report;
    pf_pose_t pose;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
    const Correction correction = Correction::of(report);
    for (GivenPose& one : early) one = correction.of(one);
    is_renamed = report.map_id != report.correction_from_map_id;
    if (is_renamed) {
      std::printf("frame %zu: map %u is scaled by %.3f and goes on as map %u\n", k, report.correction_from_map_id,
                  correction.scale, report.map_id);
      TEST_ASSERT_TRUE(id != 0);
      const GivenPose now = given(slam, id);
      TEST_ASSERT_EQUAL_UINT32(report.map_id, now.map_id);
      TEST_ASSERT_EQUAL_UINT32(report.correction_from_map_id, before.map_id);
      const bool is_adjusted = backend == PF_BACKEND_WINDOW && report.new_features > 0;  // then it moves by itself too
      TEST_ASSERT_TRUE(correction.of(before).distance(now) < (is_adjusted ? 0.01 : tolerance(config)));
      TEST_ASSERT_TRUE(std::fabs(correction.scale - 1) > 0.01);
    }
    if (status != PF_OK) continue;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
    const bool is_probe = backend == PF_BACKEND_FILTER ? k % 10 == 0 : report.new_features > 0;
    if (is_probe && !is_renamed) {
      if (id != 0) TEST_ASSERT_EQUAL_INT(PF_OK, pf_remove_anchor(slam, id));
      id = anchor_at(slam, pose);
    }
    early.push_back(GivenPose::of(pose));
    truth.emplace_back(frame.truth.p_WC[0], frame.truth.p_WC[1], frame.truth.p_WC[2]);
  }
  TEST_ASSERT_TRUE_MESSAGE(is_renamed, "it was never in metres");
  // The way of the camera, in the metres that the map has become.
  const double way = (early.back().p - early.front().p).norm(), true_way = (truth.back() - truth.front()).norm();
  std::printf("from the first of %zu poses to the last: %.3f of %.3f m\n", early.size(), way, true_way);
  TEST_ASSERT_TRUE(std::fabs(way / true_way - 1) < 0.15);
  pf_sim_imu_close(imu);
  std::free(block);
}

void test_a_filter_that_becomes_metric_should_say_by_how_much() { metric_map_says_so(PF_BACKEND_FILTER); }
void test_a_window_that_becomes_metric_should_say_by_how_much() { metric_map_says_so(PF_BACKEND_WINDOW); }

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_camera_that_an_update_moves_should_move_as_the_correction_says);
  RUN_TEST(test_it_should_do_so_after_a_start_at_a_target);
  RUN_TEST(test_motions_of_the_filter_should_be_nearer_to_the_truth_when_corrected);
  RUN_TEST(test_motions_of_the_window_should_be_nearer_to_the_truth_when_corrected);
  RUN_TEST(test_without_a_camera_in_the_state_nothing_should_be_told);
  RUN_TEST(test_a_frame_that_moves_nothing_should_say_so);
  RUN_TEST(test_a_map_that_is_scaled_should_say_by_how_much);
  RUN_TEST(test_a_filter_that_becomes_metric_should_say_by_how_much);
  RUN_TEST(test_a_window_that_becomes_metric_should_say_by_how_much);
  return UNITY_END();
}
