// The stack that each call uses on real work stays within what pf_memory_query says.
#include <planefold/planefold_research.h>

#include "support/rendered_run.h"
#include "support/skip.h"
#include "support/stack_meter.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

template <typename Call>
std::size_t metered(const char* name, Call call) {
  const std::size_t bytes = stack_meter_run([](void* context) { (*static_cast<Call*>(context))(); }, &call);
  std::printf("%-28s %zu bytes\n", name, bytes);
  return bytes;
}

void check_run(const char* scene, RenderedRun::Start start) {
  RenderedRun run(scene, 90, start);
  const std::size_t most = run.need.stack_bytes;
  std::size_t largest = 0;
  for (int k = 0; k < 90; ++k) {  // inside of the thread there is nothing but the call
    pf_image_t image;
    TEST_ASSERT_TRUE(run.next_image(&image));
    pf_slam_t* slam = run.slam;
    auto push = [slam, &image] { pf_push_frame(slam, &image); };
    const std::size_t bytes = stack_meter_run([](void* context) { (*static_cast<decltype(push)*>(context))(); }, &push);
    if (bytes > largest) largest = bytes;
  }
  pf_state_t state;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_state(run.slam, &state));
  std::printf("pf_push_frame, %s: %zu bytes of %zu\n", scene, largest, most);
  TEST_ASSERT_EQUAL_INT(PF_STATE_TRACKING, state);  // it came through start, search, update and map
  TEST_ASSERT_LESS_OR_EQUAL_size_t(most, largest);

  pf_pose_t pose;
  pf_report_t report;
  std::vector<pf_feature_t> features(100);
  std::vector<pf_match_t> tracks(200);
  std::size_t count;
  const double ahead[3] = {0, 0, 0};
  double pixel[2], covariance[4];
  TEST_ASSERT_LESS_OR_EQUAL_size_t(most, metered("pf_get_pose", [&] { pf_get_pose(run.slam, &pose); }));
  TEST_ASSERT_LESS_OR_EQUAL_size_t(
      most, metered("pf_predict_pose", [&] { pf_predict_pose(run.slam, pose.t_ns + 20000000, &pose); }));
  TEST_ASSERT_LESS_OR_EQUAL_size_t(
      most, metered("pf_project_point", [&] { pf_project_point(run.slam, ahead, pixel, covariance); }));
  TEST_ASSERT_LESS_OR_EQUAL_size_t(most, metered("pf_get_report", [&] { pf_get_report(run.slam, &report); }));
  TEST_ASSERT_LESS_OR_EQUAL_size_t(
      most, metered("pf_get_features", [&] { pf_get_features(run.slam, features.data(), features.size(), &count); }));
  TEST_ASSERT_LESS_OR_EQUAL_size_t(
      most, metered("pf_get_matches", [&] { pf_get_matches(run.slam, tracks.data(), tracks.size(), &count); }));
  std::vector<double> scratch(static_cast<std::size_t>(300 * 308));
  double information[49];
  TEST_ASSERT_LESS_OR_EQUAL_size_t(most, metered("pf_get_gauge_information", [&] {
                                     pf_get_gauge_information(run.slam, scratch.data(), scratch.size(), information);
                                   }));
  TEST_ASSERT_LESS_OR_EQUAL_size_t(most, metered("pf_reset", [&] { pf_reset(run.slam); }));
  TEST_ASSERT_LESS_OR_EQUAL_size_t(most, metered("pf_create", [&] { run.create(); }));
  pf_memory_t memory;
  TEST_ASSERT_LESS_OR_EQUAL_size_t(most, metered("pf_memory_query", [&] { pf_memory_query(&run.config, &memory); }));
  const char* field;
  TEST_ASSERT_LESS_OR_EQUAL_size_t(most, metered("pf_config_check", [&] { pf_config_check(&run.config, &field); }));
}

void test_stack_should_stay_within_its_budget_from_a_start_at_a_rectangle() {
  check_run("desk", RenderedRun::Start::kRectangle);
}

void test_stack_should_stay_within_its_budget_from_a_start_without_a_target() {
  check_run("desk", RenderedRun::Start::kNone);
}

void test_stack_should_stay_within_its_budget_with_observations() {
  RenderedRun run("wall", 1, RenderedRun::Start::kNone);
  std::size_t largest = 0;
  for (int k = 0; k < 60; ++k) {
    std::vector<pf_observation_t> observations;
    for (int i = 0; i < 60; ++i) {
      const double z = 1.5 + 0.2 * (i % 7);
      const double p_C[3] = {-0.8 + 0.17 * (i % 10) - 0.01 * k, -0.5 + 0.2 * (i / 10), z};
      pf_observation_t o = {static_cast<std::uint32_t>(i), {}, 0.0};
      if (pf_camera_project(&run.config.camera, p_C, o.pixel) == PF_OK) observations.push_back(o);
    }
    pf_slam_t* slam = run.slam;
    auto push = [slam, k, &observations] {
      pf_push_observations(slam, INT64_C(33000000) * (k + 1), observations.data(), observations.size());
    };
    const std::size_t bytes = stack_meter_run([](void* context) { (*static_cast<decltype(push)*>(context))(); }, &push);
    if (bytes > largest) largest = bytes;
  }
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(run.slam, &report));
  std::printf("pf_push_observations: %zu bytes of %zu\n", largest, run.need.stack_bytes);
  TEST_ASSERT_GREATER_THAN_INT(30, report.inliers);
  TEST_ASSERT_LESS_OR_EQUAL_size_t(run.need.stack_bytes, largest);
}

}  // namespace

int main(void) {
  if (!stack_meter_is_meaningful()) SKIP_PROGRAM("sanitizers multiply the use of stack");
  UNITY_BEGIN();
  RUN_TEST(test_stack_should_stay_within_its_budget_from_a_start_at_a_rectangle);
  RUN_TEST(test_stack_should_stay_within_its_budget_from_a_start_without_a_target);
  RUN_TEST(test_stack_should_stay_within_its_budget_with_observations);
  return UNITY_END();
}
