// Predict, remove and convert against the dense formulas, on small maps.
#include "same.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Rows of the blocks that are left, in their order.
std::vector<int> rows_left(int dim, const std::vector<int>& gone_first) {
  std::vector<int> rows;
  for (int r = 0; r < dim; ++r) {
    bool stays = true;
    for (const int first : gone_first) stays = stays && (r < first || r >= first + 3);
    if (stays) rows.push_back(r);
  }
  return rows;
}

Dense select(const Dense& P, const std::vector<int>& rows) {
  const int n = static_cast<int>(rows.size());
  Dense out(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) out(i, j) = P(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
  return out;
}

void test_remove_should_leave_the_covariance_of_what_stays() {
  SeededRandom random(89);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, true);
    const Dense before = scene.filter.P();
    const int gone[3] = {scene.slots[static_cast<std::size_t>(trial % 5)], scene.slots[6], scene.slots[9]};
    std::vector<int> first;
    for (const int slot : gone) first.push_back(scene.filter.first(slot));
    const Dense expected = select(before, rows_left(scene.filter.dim(), first));
    scene.filter->remove(gone, 3);
    TEST_ASSERT_EQUAL_INT(before.rows() - 9, scene.filter.dim());
    TEST_ASSERT_SAME(0, largest(scene.filter.P() - expected));
  }
}

void test_an_anchor_should_go_with_the_last_feature_that_needs_it() {
  SeededRandom random(90);
  Scene scene(random, true);
  const State& state = scene.filter->state();
  const int anchor = state.block[scene.slots[5]].parent;
  std::vector<int> gone, first = {scene.filter.first(anchor)};
  for (std::size_t i = 5; i < scene.slots.size(); ++i) {
    if (state.block[scene.slots[i]].parent != anchor) continue;
    gone.push_back(scene.slots[i]);
    first.push_back(scene.filter.first(scene.slots[i]));
  }
  const Dense expected = select(scene.filter.P(), rows_left(scene.filter.dim(), first));
  scene.filter->remove(gone.data(), static_cast<int>(gone.size()));
  TEST_ASSERT_SAME(BlockKind::kNone, state.block[anchor].kind);
  TEST_ASSERT_SAME(0, largest(scene.filter.P() - expected));
  PixelMeasurement o;  // the others are where they say that they are
  for (const int slot : scene.slots)
    if (state.block[slot].kind != BlockKind::kNone)
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), slot, &o));
}

void test_conversion_should_leave_the_covariance_that_its_jacobians_say() {
  SeededRandom random(91);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, true);
    const State& state = scene.filter->state();
    const int slot = scene.slots[static_cast<std::size_t>(5 + trial % 6)];
    const Block block = state.block[slot];
    const int anchor = scene.filter.first(block.parent), first = scene.filter.first(slot), n = scene.filter.dim();
    const InverseDepth d = block.inverse_depth();
    const Mat3 R = d.q_b.toRotationMatrix();
    Dense F = Dense::Identity(n, n);
    F.block(first, first, 3, 2) = (R.leftCols<2>() / d.rho).cast<double>();
    F.block(first, first + 2, 3, 1) = (-R.col(2) / (d.rho * d.rho)).cast<double>();
    F.block(first, anchor, 3, 3).setIdentity();
    const Dense expected = F * scene.filter.P() * F.transpose();
    const Vec3 f_W = state.block[block.parent].xyz() + R.col(2) / d.rho;
    scene.filter->convert_to_point(slot);
    TEST_ASSERT_SAME(BlockKind::kPoint, state.block[slot].kind);
    TEST_ASSERT_TRUE((state.block[slot].xyz() - f_W).norm() < Scalar(1e-12));
    TEST_ASSERT_TRUE(difference(scene.filter.P(), expected) < kExact);
  }
}

void test_prediction_should_be_f_p_ft_plus_q() {
  SeededRandom random(92);
  Scene scene(random, true);
  const int n = scene.filter.dim();
  Transition t;
  predict_constant_velocity(scene.filter->state().body, BodyLayout::with_constant_velocity(), Scalar(0.05), {1, 2}, &t);
  Dense F = Dense::Identity(n, n), Q = Dense::Zero(n, n);
  for (int i = 0; i < t.dim; ++i)
    for (int j = 0; j < t.dim; ++j) {
      F(i, j) = static_cast<double>(t.F[i * t.dim + j]);
      Q(i, j) = static_cast<double>(t.Q[i * t.dim + j]);
    }
  const Dense expected = F * scene.filter.P() * F.transpose() + Q;
  scene.filter->predict(t);
  TEST_ASSERT_TRUE(difference(scene.filter.P(), expected) < kExact);
}

/// A camera that coasts: its speed goes on, or ends at once. Both must be within what the filter expects, for a whole second.
void test_damping_should_leave_room_for_both_when_a_speed_goes_on_and_when_it_ends() {
  SeededRandom random(93);
  constexpr Scalar kDt = Scalar(1.0 / 30), kFactor = Scalar(0.875);
  for (int trial = 0; trial < 10; ++trial) {
    TestFilter filter(true);
    Scalar covariance[kBodyRows * kBodyRows] = {};
    for (int i = 0; i < kBodyRows; ++i) covariance[i * kBodyRows + i] = Scalar(1e-6);
    Body start = random_body(random);
    start.q_WC = Quat::Identity();
    filter->set_body(start, covariance);
    for (int frame = 1; frame <= 30; ++frame) {
      Mat6 P_speed;
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) P_speed(i, j) = filter->covariance()(kVelocityRow + i, kVelocityRow + j);
      Transition t;
      damp_speed(filter->state().body, BodyLayout::with_constant_velocity(), kFactor, filter->state().body.w_C, P_speed,
                 &t);
      filter->predict(t);
      predict_constant_velocity(filter->state().body, BodyLayout::with_constant_velocity(), kDt,
                                {Scalar(0.01), Scalar(0.01)}, &t);
      filter->predict(t);
      const Scalar elapsed = kDt * static_cast<Scalar>(frame);
      const Vec3 gone = filter->state().body.p_W - start.p_W;
      const Vec3 way = start.v_W.normalized();
      Scalar variance = 0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          variance += way(i) * way(j) * filter->covariance()(Body::kPosition + i, Body::kPosition + j);
      const Scalar sigma = std::sqrt(variance);
      TEST_ASSERT_TRUE((start.v_W * elapsed - gone).norm() < 3 * sigma);
      TEST_ASSERT_TRUE(gone.norm() < 3 * sigma);
    }
    TEST_ASSERT_TRUE(filter->state().body.v_W.norm() < Scalar(0.1) * start.v_W.norm());
  }
}

void test_a_full_filter_should_refuse_new_blocks_and_stay_as_it_is() {
  SeededRandom random(93);
  TestFilter filter(true, BodyLayout::with_constant_velocity(), 32, 6);
  int added = 0;
  while (filter->add_point(random.normals<3>(1), Mat3::Identity()) >= 0) ++added;
  TEST_ASSERT_EQUAL_INT(6, added);
  TEST_ASSERT_EQUAL_INT(kBodyRows + 3 * added, filter.dim());
  const std::vector<Scalar> before = bits_of(filter);
  TEST_ASSERT_EQUAL_INT(-1, filter->add_anchor());
  TEST_ASSERT_EQUAL_INT(-1, filter->add_point(Vec3::Zero(), Mat3::Identity()));
  const std::vector<Scalar> after = bits_of(filter);
  TEST_ASSERT_EQUAL_size_t(before.size(), after.size());
  TEST_ASSERT_EQUAL_MEMORY(before.data(), after.data(), before.size() * sizeof(Scalar));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_remove_should_leave_the_covariance_of_what_stays);
  RUN_TEST(test_an_anchor_should_go_with_the_last_feature_that_needs_it);
  RUN_TEST(test_conversion_should_leave_the_covariance_that_its_jacobians_say);
  RUN_TEST(test_prediction_should_be_f_p_ft_plus_q);
  RUN_TEST(test_damping_should_leave_room_for_both_when_a_speed_goes_on_and_when_it_ends);
  RUN_TEST(test_a_full_filter_should_refuse_new_blocks_and_stay_as_it_is);
  return UNITY_END();
}
