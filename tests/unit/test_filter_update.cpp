// The filter's update against the dense formulas of the textbook, on small maps.
#include "same.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// What the textbook makes of the kept observations: dx = K y and (I - K H) P (I - K H)^T + K R K^T. Only the first `estimated` rows of K
/// are used, where that is not 0 (Schmidt), or those behind the first `considered`. Rows of `partly` are those of an update by the
/// observations that estimate them.
struct Textbook {
  Eigen::VectorXd dx;
  Dense P;
  double nis;

  Textbook(const Scene& scene, const unsigned char* keep, int estimated = 0, int considered = 0,
           const PartlyConsidered& partly = PartlyConsidered()) {
    const int n = scene.filter.dim();
    std::vector<int> taken;
    for (int i = 0; i < scene.count(); ++i)
      if (keep == nullptr || keep[i] != 0) taken.push_back(i);
    const int m = 2 * static_cast<int>(taken.size());
    Dense H(m, n), R = Dense::Zero(m, m);
    Eigen::VectorXd y(m);
    for (int k = 0; 2 * k < m; ++k) {
      const PixelMeasurement& o = scene.observations[static_cast<std::size_t>(taken[static_cast<std::size_t>(k)])];
      H.middleRows(2 * k, 2) = dense_rows(*scene.filter, o.H);
      R.block(2 * k, 2 * k, 2, 2) = o.R_update.cast<double>();
      y.segment(2 * k, 2) = (o.measured - o.predicted).cast<double>();
    }
    const Dense before = scene.filter.P();
    const Dense S_inverse = inverse_of(H * before * H.transpose() + R);
    Dense K = before * H.transpose() * S_inverse;
    for (int k = 0; k < partly.count; ++k) {
      std::vector<int> of;
      for (int r = 0; r < m; ++r)
        if (partly.estimates[taken[static_cast<std::size_t>(r / 2)]] != 0) of.push_back(r);
      const Dense H_of = H(of, Eigen::all), R_of = R(of, of);
      const Dense K_of = before * H_of.transpose() * inverse_of(H_of * before * H_of.transpose() + R_of);
      const int first = scene.filter.first(partly.block[k]), size = (*scene.filter).state().block[partly.block[k]].size;
      K.middleRows(first, size).setZero();
      for (std::size_t r = 0; r < of.size(); ++r)
        K.block(first, of[r], size, 1) = K_of.block(first, static_cast<int>(r), size, 1);
    }
    if (estimated > 0) K.bottomRows(n - estimated).setZero();
    K.topRows(considered).setZero();
    const Dense A = Dense::Identity(n, n) - K * H;
    dx = K * y;
    P = A * before * A.transpose() + K * R * K.transpose();
    nis = y.dot(S_inverse * y);
  }
};

/// Mean of a scene moved by dx, block by block.
void check_state(const State& before, const TestFilter& filter, const std::vector<Block>& blocks,
                 const Eigen::VectorXd& dx) {
  const State& after = (*filter).state();
  const Body body = moved(before.body, dx.head(6).cast<Scalar>());
  TEST_ASSERT_TRUE(body.q_WC.angularDistance(after.body.q_WC) < Scalar(1e-7));
  TEST_ASSERT_TRUE((body.p_W - after.body.p_W).norm() < Scalar(kExact));
  TEST_ASSERT_TRUE((before.body.v_W + dx.segment(6, 3).cast<Scalar>() - after.body.v_W).norm() < Scalar(kExact));
  TEST_ASSERT_TRUE((before.body.w_C + dx.segment(9, 3).cast<Scalar>() - after.body.w_C).norm() < Scalar(kExact));
  for (int s = 0; s < after.slots; ++s) {
    const Block& old = blocks[static_cast<std::size_t>(s)];
    const Block& now = after.block[s];
    TEST_ASSERT_SAME(now.kind, old.kind);
    if (old.kind == BlockKind::kNone) continue;
    const Vec3 e = dx.segment(filter.first(s), 3).cast<Scalar>();
    if (old.kind != BlockKind::kInverseDepth) {
      TEST_ASSERT_TRUE((old.xyz() + e - now.xyz()).norm() < Scalar(kExact));
      continue;
    }
    const InverseDepth d = moved(old.inverse_depth(), e);
    TEST_ASSERT_TRUE(d.q_b.angularDistance(now.inverse_depth().q_b) < Scalar(1e-7));
    TEST_ASSERT_TRUE(std::abs(d.rho - now.inverse_depth().rho) < Scalar(kExact));
  }
}

void check_update(Scene& scene, const unsigned char* keep, bool textbook_covariance,
                  EstimatedRows rows = EstimatedRows()) {
  const BodyLayout& layout = scene.filter->state().layout;
  const Textbook expected(scene, keep, rows.map ? 0 : layout.dynamic_rows(), rows.motion ? 0 : layout.rows(),
                          rows.partly);
  const State before = scene.filter->state();
  const std::vector<Block> blocks(before.block, before.block + before.slots);
  scene.filter->begin_update(scene.observations.data(), scene.count());
  Scalar nis = 0;
  TEST_ASSERT_TRUE(scene.filter->finish_update(scene.observations.data(), scene.count(), keep, &nis, rows));
  TEST_ASSERT_DOUBLE_WITHIN(1e-8 * expected.nis, expected.nis, static_cast<double>(nis));
  check_state(before, scene.filter, blocks, expected.dx);
  if (textbook_covariance) TEST_ASSERT_TRUE(difference(scene.filter.P(), expected.P) < kExact);
}

void test_update_should_be_the_textbook_ekf_when_all_is_taken_in() {
  SeededRandom random(81);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, false);
    check_update(scene, nullptr, true);
  }
}

void test_update_should_be_the_textbook_ekf_of_what_is_kept_when_some_is_rejected() {
  SeededRandom random(82);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, false);
    unsigned char keep[16];
    for (int i = 0; i < scene.count(); ++i) keep[i] = random.uniform(0, 1) < 0.6 ? 1 : 0;
    keep[trial % scene.count()] = 1;
    check_update(scene, keep, true);
  }
}

void test_update_should_be_schmidts_when_only_motion_is_estimated() {
  SeededRandom random(87);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, false);
    const Dense before = scene.filter.P();
    const int moving = scene.filter->state().layout.dynamic_rows(), others = scene.filter.dim() - moving;
    check_update(scene, nullptr, true, {true, false});
    TEST_ASSERT_TRUE(
        difference(scene.filter.P().bottomRightCorner(others, others), before.bottomRightCorner(others, others)) == 0);
    for (PixelMeasurement& o : scene.observations) {
      const Vec2 measured = o.measured;
      const Mat2 noise = o.R_update;
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), o.block, &o));
      o.measured = measured;
      o.set_noise(noise);
    }
    check_update(scene, nullptr, true);
  }
}

void test_update_should_be_schmidts_when_only_the_map_is_estimated() {
  SeededRandom random(88);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, false);
    const Dense before = scene.filter.P();
    const int body = scene.filter->state().layout.rows();
    check_update(scene, nullptr, true, {false, true});
    TEST_ASSERT_SAME(0, difference(scene.filter.P().topLeftCorner(body, body), before.topLeftCorner(body, body)));
  }
}

void test_blocks_should_be_estimated_by_some_measurements_alone_when_the_others_consider_them() {
  SeededRandom random(90);
  for (int trial = 0; trial < 30; ++trial) {
    Scene scene(random, false);
    const int count = scene.count(), first = trial % count, last = (first + 1 + trial % (count - 1)) % count;
    const int blocks[2] = {scene.observations[static_cast<std::size_t>(first)].block,
                           scene.observations[static_cast<std::size_t>(last)].block};
    unsigned char keep[16], estimates[16];
    for (int i = 0; i < count; ++i) {
      keep[i] = i == first || random.uniform(0, 1) < 0.8 ? 1 : 0;
      estimates[i] = trial % 5 > 0 && random.uniform(0, 1) < 0.5 ? 1 : 0;  // none in each fifth trial
    }
    check_update(scene, keep, true, {trial % 3 > 0, true, {blocks, 1 + trial % 2, estimates}});
  }
}

void test_update_should_change_nothing_when_neither_motion_nor_map_is_estimated() {
  SeededRandom random(89);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, trial % 2 == 1);
    const Dense before = scene.filter.P();
    const Vec3 p_W = scene.filter->state().body.p_W;
    scene.filter->begin_update(scene.observations.data(), scene.count());
    TEST_ASSERT_TRUE(
        scene.filter->finish_update(scene.observations.data(), scene.count(), nullptr, nullptr, {false, false}));
    TEST_ASSERT_TRUE(difference(scene.filter.P(), before) < kExact);
    TEST_ASSERT_TRUE(scene.filter->state().body.p_W == p_W);
  }
}

void test_update_should_move_the_mean_like_the_textbook_when_the_gauge_is_kept() {
  SeededRandom random(83);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, true);
    check_update(scene, nullptr, false);
  }
}

/// M (P - K S K^T) M^T, where M is the identity but for the gauge: along N- it does what the state did.
void test_update_should_only_move_the_gauge_of_the_textbook_covariance_when_it_is_kept() {
  SeededRandom random(84);
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, true);
    const bool only_motion = trial % 3 == 1, only_map = trial % 3 == 2;
    const BodyLayout& layout = scene.filter->state().layout;
    const Textbook expected(scene, nullptr, only_motion ? layout.dynamic_rows() : 0, only_map ? layout.rows() : 0);
    const Dense before = scene.filter.gauge();
    scene.filter->begin_update(scene.observations.data(), scene.count());
    TEST_ASSERT_TRUE(scene.filter->finish_update(scene.observations.data(), scene.count(), nullptr, nullptr,
                                                 {!only_map, !only_motion}));
    const Dense after = scene.filter.gauge();
    const Dense now = after.transpose() * inverse_of(scene.filter.P()) * after;
    const Dense should = before.transpose() * inverse_of(expected.P) * before;
    TEST_ASSERT_TRUE(largest(now - should) < 1e-7 * largest(should));
    // The change lies in the span of the change of the gauge: P+ - P1 = dN C + C^T dN^T.
    const Dense dN = after.rightCols(4) - before.rightCols(4);
    const Dense Q = Dense::Identity(dN.rows(), dN.rows()) - dN * inverse_of(dN.transpose() * dN) * dN.transpose();
    const Dense left = Q * (scene.filter.P() - expected.P) * Q;
    TEST_ASSERT_TRUE(largest(left) < 1e-10);
  }
}

void test_joint_innovation_should_be_h_p_ht_in_any_order() {
  SeededRandom random(85);
  Scene scene(random, true);
  const Dense P = scene.filter.P();
  scene.filter->begin_update(scene.observations.data(), scene.count());
  for (int i = 0; i < scene.count(); ++i) {
    const Dense Hi = dense_rows(*scene.filter, scene.observations[static_cast<std::size_t>(i)].H);
    for (int j = 0; j < scene.count(); ++j) {
      const Dense Hj = dense_rows(*scene.filter, scene.observations[static_cast<std::size_t>(j)].H);
      const Dense expected = Hi * P * Hj.transpose();
      TEST_ASSERT_TRUE(largest(scene.filter->innovation_block(i, j).cast<double>() - expected) < 1e-9);
      if (i == j)
        TEST_ASSERT_TRUE(
            largest(scene.filter->innovation(scene.observations[static_cast<std::size_t>(i)]).cast<double>() -
                    expected) < 1e-9);
    }
  }
}

void test_update_should_change_nothing_when_the_innovation_cannot_be_factored() {
  SeededRandom random(86);
  for (const bool keep_gauge : {false, true}) {
    Scene scene(random, keep_gauge);
    scene.observations[3].set_noise(Mat2::Identity() * Scalar(-1e6));
    const std::vector<Scalar> before = bits_of(scene.filter);
    scene.filter->begin_update(scene.observations.data(), scene.count());
    Scalar nis = -1;
    TEST_ASSERT_FALSE(scene.filter->finish_update(scene.observations.data(), scene.count(), nullptr, &nis));
    TEST_ASSERT_SAME(Scalar(-1), nis);
    const std::vector<Scalar> after = bits_of(scene.filter);
    TEST_ASSERT_EQUAL_MEMORY(before.data(), after.data(), before.size() * sizeof(Scalar));
  }
}

void test_update_should_change_nothing_when_a_measurement_is_not_a_number() {
  SeededRandom random(87);
  Scene scene(random, true);
  scene.observations[2].measured.x() = std::numeric_limits<Scalar>::quiet_NaN();
  const std::vector<Scalar> before = bits_of(scene.filter);
  scene.filter->begin_update(scene.observations.data(), scene.count());
  TEST_ASSERT_FALSE(scene.filter->finish_update(scene.observations.data(), scene.count(), nullptr, nullptr));
  const std::vector<Scalar> after = bits_of(scene.filter);
  TEST_ASSERT_EQUAL_MEMORY(before.data(), after.data(), before.size() * sizeof(Scalar));
}

void test_update_should_be_refused_when_nothing_is_kept() {
  SeededRandom random(88);
  Scene scene(random, true);
  const unsigned char none[16] = {};
  const std::vector<Scalar> before = bits_of(scene.filter);
  scene.filter->begin_update(scene.observations.data(), scene.count());
  TEST_ASSERT_FALSE(scene.filter->finish_update(scene.observations.data(), scene.count(), none, nullptr));
  const std::vector<Scalar> after = bits_of(scene.filter);
  TEST_ASSERT_EQUAL_MEMORY(before.data(), after.data(), before.size() * sizeof(Scalar));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_update_should_be_the_textbook_ekf_when_all_is_taken_in);
  RUN_TEST(test_update_should_be_the_textbook_ekf_of_what_is_kept_when_some_is_rejected);
  RUN_TEST(test_update_should_be_schmidts_when_only_motion_is_estimated);
  RUN_TEST(test_update_should_be_schmidts_when_only_the_map_is_estimated);
  RUN_TEST(test_blocks_should_be_estimated_by_some_measurements_alone_when_the_others_consider_them);
  RUN_TEST(test_update_should_change_nothing_when_neither_motion_nor_map_is_estimated);
  RUN_TEST(test_update_should_move_the_mean_like_the_textbook_when_the_gauge_is_kept);
  RUN_TEST(test_update_should_only_move_the_gauge_of_the_textbook_covariance_when_it_is_kept);
  RUN_TEST(test_joint_innovation_should_be_h_p_ht_in_any_order);
  RUN_TEST(test_update_should_change_nothing_when_the_innovation_cannot_be_factored);
  RUN_TEST(test_update_should_change_nothing_when_a_measurement_is_not_a_number);
  RUN_TEST(test_update_should_be_refused_when_nothing_is_kept);
  return UNITY_END();
}
