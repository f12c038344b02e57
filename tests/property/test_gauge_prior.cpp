// What is kept apart from P: P + N V N^T is the same covariance, through every operation, as one that holds all of it.
#include "observe/inverse_depth.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kSame = 1e-8;  // relative to standard deviations
constexpr double kScaleVariance = 0.05;

/// Part of it goes apart: a pose that is known to 0.1 rad and m, and a common scale to 22 %.
void keep_apart(TestFilter& filter) {
  GaugePrior& apart = const_cast<GaugePrior&>(filter->apart());
  Scalar pose[36] = {};
  for (int i = 0; i < 6; ++i) pose[7 * i] = Scalar(0.01);
  pose[1] = pose[6] = Scalar(0.004);
  pose[4] = pose[24] = Scalar(-0.003);
  apart.set_pose(filter->state(), pose, 6);
  apart.add_scale(Scalar(kScaleVariance));
}

/// P + N V N^T
Dense whole(const TestFilter& filter) {
  const Dense N = filter.gauge();
  return filter.P() + N * (*filter).apart().V().cast<double>() * N.transpose();
}

/// The same map twice, from the same seed: one that keeps a part apart, and one that holds all of it in P.
struct Pair {
  Scene split, direct;

  explicit Pair(std::uint64_t seed) : Pair(SeededRandom(seed), SeededRandom(seed)) {}

  void require_same(const char* after) {
    const double difference_found = difference(whole(split.filter), direct.filter.P());
    if (!(difference_found < kSame)) std::printf("%s: %.3g\n", after, difference_found);
    TEST_ASSERT_TRUE_MESSAGE(difference_found < kSame, after);
    Scalar a[144], b[144];
    split.filter->body_covariance(kBodyRows, a);
    direct.filter->body_covariance(kBodyRows, b);
    for (int i = 0; i < 144; ++i)
      TEST_ASSERT_TRUE(std::fabs(a[i] - b[i]) < kSame * std::sqrt(b[i / 12 * 13] * b[i % 12 * 13]));
    for (const int slot : split.slots)
      TEST_ASSERT_TRUE(difference(split.filter->covariance3(slot).cast<double>(),
                                  direct.filter->covariance3(slot).cast<double>()) < kSame);
  }

 private:
  Pair(SeededRandom a, SeededRandom b) : split(a, true), direct(b, true) {
    keep_apart(split.filter);
    direct.filter.set_P(whole(split.filter));
  }
};

template <typename Step>
void stays_the_same(const char* what, Step step) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Pair pair(seed);
    step(pair.split);
    step(pair.direct);
    pair.require_same(what);
  }
}

void update(Scene& scene) {
  scene.filter->begin_update(scene.observations.data(), scene.count());
  TEST_ASSERT_TRUE(scene.filter->finish_update(scene.observations.data(), scene.count(), nullptr, nullptr));
}

void predict(Scene& scene) {
  Transition transition;
  predict_constant_velocity(scene.filter->state().body, BodyLayout::with_constant_velocity(), Scalar(0.05),
                            {Scalar(0.5), Scalar(0.5)}, &transition);
  scene.filter->predict(transition);
}

void test_an_update_should_be_the_same() { stays_the_same("update", update); }

void test_a_prediction_should_be_the_same() { stays_the_same("predict", predict); }

void test_new_blocks_should_be_the_same() {
  stays_the_same("augment", [](Scene& scene) {
    const int anchor = scene.filter->add_anchor(), camera = scene.filter->add_reference_camera();
    scene.filter->pin(anchor);
    scene.filter->pin(camera);
  });
}

void test_conversion_and_removal_should_be_the_same() {
  stays_the_same("convert", [](Scene& scene) {
    for (std::size_t i = 0; i < scene.slots.size(); ++i)
      if (scene.filter->state().block[scene.slots[i]].kind == BlockKind::kInverseDepth)
        scene.filter->convert_to_point(scene.slots[i]);
    scene.filter->remove(&scene.slots[1], 1);
    scene.slots.erase(scene.slots.begin() + 1);
  });
}

void test_many_steps_should_be_the_same() {
  stays_the_same("twenty frames", [](Scene& scene) {
    for (int frame = 0; frame < 20; ++frame) {
      predict(scene);
      for (PixelMeasurement& o : scene.observations) {
        const Vec2 measured = o.measured;
        const Mat2 R = o.R_update;
        TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), o.block, &o));
        o.measured = measured;
        o.set_noise(R);
      }
      update(scene);
    }
  });
}

void test_the_motion_since_a_camera_should_be_the_same() {
  Pair pair(7);
  Mat6 covariance[2];
  for (Scene* scene : {&pair.split, &pair.direct}) {
    const int camera = scene->filter->add_reference_camera();
    scene->filter->pin(camera);
    predict(*scene);
    Quat q_KC;
    Vec3 p_KC;
    scene->filter->motion_since(camera, &q_KC, &p_KC, &covariance[scene == &pair.split ? 0 : 1]);
  }
  TEST_ASSERT_TRUE(difference(covariance[0].cast<double>(), covariance[1].cast<double>()) < kSame);
}

/// Something tells where W is: what was apart goes into P, and P is then the whole covariance.
void test_what_tells_the_gauge_should_bring_all_of_it_into_P() {
  Pair pair(8);
  for (Scene* scene : {&pair.split, &pair.direct})
    TEST_ASSERT_TRUE(scene->filter->add_point(Vec3(1, 2, 3), Scalar(1e-4) * Mat3::Identity()) >= 0);
  TEST_ASSERT_FALSE(pair.split.filter->apart().any());
  TEST_ASSERT_TRUE(difference(pair.split.filter.P(), pair.direct.filter.P()) < kSame);
}

void test_the_information_of_the_gauge_should_be_the_same() {
  Pair pair(9);
  Dense found[2];
  for (Scene* scene : {&pair.split, &pair.direct}) {
    found[scene == &pair.split ? 0 : 1] = scene->filter.gauge_information();
  }
  TEST_ASSERT_TRUE(largest(found[0] - found[1]) < 1e-6 * largest(found[1]));
}

/// take_out: what does not change with the scale keeps its covariance, and the row l has none any more but what is left.
void test_taking_the_scale_out_should_leave_what_does_not_depend_on_it() {
  SeededRandom random(10);
  Scene scene(random, true);
  TestFilter& filter = scene.filter;
  const Dense P = filter.P(), N = filter.gauge().col(6);
  ScaleRow l;
  TEST_ASSERT_TRUE(filter->scale_row(&l));
  const Dense L = dense_rows(*filter, l);
  std::vector<Scalar> direction(static_cast<std::size_t>(filter->blocks().ld()));
  for (int i = 0; i < filter.dim(); ++i) direction[static_cast<std::size_t>(i)] = static_cast<Scalar>(N(i, 0));
  const double left = 1e-3;
  const Scalar variance = const_cast<BlockFilter&>(filter->blocks())
                              .take_out(direction.data(), static_cast<Scalar>(left), 2, [&](int, ScaleRow* half) {
                                *half = l;
                                for (int i = 0; i < half->columns(); ++i) half->h[i] /= 2;
                                return true;
                              });
  TEST_ASSERT_TRUE(std::fabs(static_cast<double>(variance) - (L * P * L.transpose())(0, 0)) < 1e-12);
  const Dense M = Dense::Identity(filter.dim(), filter.dim()) - N * L;
  TEST_ASSERT_TRUE(difference(filter.P(), M * P * M.transpose() + left * N * N.transpose()) < kSame);
  for (const PixelMeasurement& o : scene.observations) {
    const Dense H = dense_rows(*filter, o.H);
    TEST_ASSERT_TRUE(largest(H * (filter.P() - P) * H.transpose()) < 1e-9 * largest(H * P * H.transpose()));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_an_update_should_be_the_same);
  RUN_TEST(test_a_prediction_should_be_the_same);
  RUN_TEST(test_new_blocks_should_be_the_same);
  RUN_TEST(test_conversion_and_removal_should_be_the_same);
  RUN_TEST(test_many_steps_should_be_the_same);
  RUN_TEST(test_the_motion_since_a_camera_should_be_the_same);
  RUN_TEST(test_what_tells_the_gauge_should_bring_all_of_it_into_P);
  RUN_TEST(test_the_information_of_the_gauge_should_be_the_same);
  RUN_TEST(test_taking_the_scale_out_should_leave_what_does_not_depend_on_it);
  return UNITY_END();
}
