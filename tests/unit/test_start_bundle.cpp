// The first depths from synthetic pixels of known poses and points.
#include <algorithm>

#include "bundle/start_bundle.h"
#include "same.h"
#include "support/bounds.h"
#include "support/filter_cases.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kSigma = Scalar(0.3);

/// Points 1 to 3 m in front of frame 0, and a camera that moves away from it.
struct Start {
  TestArena arena;
  StartRecord record;
  StartBundle bundle;
  Camera camera;
  std::vector<Vec3> points;
  std::vector<Body> truth;

  Start(SeededRandom& random, const Camera& c, int count, Scalar ray_sigma = kSigma) : camera(c) {
    TEST_ASSERT_TRUE(record.layout(*arena));
    TEST_ASSERT_TRUE(bundle.layout(*arena));
    record.init();
    bundle.init();
    for (int i = 0; i < count; ++i) {
      const Scalar depth = static_cast<Scalar>(random.uniform(1, 3));
      const Scalar y = depth * static_cast<Scalar>(random.uniform(-0.3, 0.3));  // arguments have no order of their own
      const Scalar x = depth * static_cast<Scalar>(random.uniform(-0.35, 0.35));
      const Vec3 p(x, y, depth);
      points.push_back(p);
      Vec2 z;
      Vec3 ray;
      TEST_ASSERT_TRUE(project(camera, p, &z));
      TEST_ASSERT_TRUE(unproject(camera, z + random.normals<2>(static_cast<double>(ray_sigma)), &ray));
      TEST_ASSERT_EQUAL_INT(i, record.add_feature(ray));
    }
  }

  /// The believed pose of a record's frame is a poor one: the turn to a degree, the place unknown.
  void see(SeededRandom& random, const Body& body, int visible) {
    truth.push_back(body);
    const Quat believed = exp_so3(random.normals<3>(0.02)) * body.q_WC;
    const int k = record.add_frame(static_cast<std::int64_t>(truth.size()) * 33000000, believed, Vec3::Zero());
    for (int i = 0; i < visible; ++i) {
      Vec2 z;
      if (!project(camera, body.q_WC.conjugate() * (points[static_cast<std::size_t>(i)] - body.p_W), &z)) continue;
      record.add_pixel(k, i, z + random.normals<2>(static_cast<double>(kSigma)));
    }
  }

  StartOutcome solve(Scalar median_depth = 1) { return bundle.solve(camera, record, kSigma, median_depth); }
};

Body on_the_way(const Vec3& direction, Scalar metres, Scalar turn) {
  Body body;
  body.p_W = direction * metres;
  body.q_WC = exp_so3(Vec3(turn * Scalar(0.5), turn, turn * Scalar(-0.3)));
  return body;
}

struct Errors {
  double depth_rms, depth_worst, turn, place;
};

/// The largest errors over moves in several directions with three cameras; ray_sigma is the noise of frame 0's pixels.
Errors solve_moves(SeededRandom& random, Scalar ray_sigma) {
  Errors largest = {};
  const Vec3 directions[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, Vec3(1, Scalar(-0.5), Scalar(0.4)).normalized()};
  for (int trial = 0; trial < 12; ++trial) {
    const Vec3 direction = directions[trial % 4];
    Start start(random, test_camera_of(trial / 4), 48, ray_sigma);
    const Scalar step = Scalar(0.012) * Scalar(525) / start.camera.fx;  // the same parallax for all
    StartOutcome outcome = StartOutcome::kWait;
    for (int k = 1; k <= 25 && outcome != StartOutcome::kSettled; ++k) {
      start.see(random, on_the_way(direction, step * Scalar(k), Scalar(0.003) * Scalar(k)), 48);
      outcome = start.solve();
      TEST_ASSERT_TRUE(outcome != StartOutcome::kTooFew);
    }
    TEST_ASSERT_TRUE_MESSAGE(outcome == StartOutcome::kSettled, "a baseline of 0.3 m at 2 m was not enough");

    // Scale: the median of true distance times inverse depth.
    std::vector<double> ratio;
    for (int i = 0; i < 48; ++i)
      if (start.bundle.good(i))
        ratio.push_back(static_cast<double>(start.points[static_cast<std::size_t>(i)].norm() * start.bundle.rho(i)));
    TEST_ASSERT_GREATER_THAN_size_t(40, ratio.size());
    std::sort(ratio.begin(), ratio.end());
    const double scale = ratio[ratio.size() / 2];  // units of the bundle per metre, inverted
    double square = 0, worst = 0;
    for (const double r : ratio) {
      square += (r / scale - 1) * (r / scale - 1);
      worst = std::max(worst, std::fabs(r / scale - 1));
    }
    const double rms = std::sqrt(square / static_cast<double>(ratio.size()));
    const Body& last = start.truth.back();
    const StartRecord::Frame& frame = start.record.frame(start.record.frames() - 1);
    const double turn_error = static_cast<double>(frame.q_WC.angularDistance(last.q_WC));
    const double place_error =
        static_cast<double>((frame.p_W * static_cast<Scalar>(scale) - last.p_W).norm() / last.p_W.norm());
    std::printf("frames %d, depths: rms %.4f, worst %.4f; turn %.5f rad; place %.4f of the way\n",
                start.record.frames(), rms, worst, turn_error, place_error);
    largest.depth_rms = std::max(largest.depth_rms, rms);
    largest.depth_worst = std::max(largest.depth_worst, worst);
    largest.turn = std::max(largest.turn, turn_error);
    largest.place = std::max(largest.place, place_error);
  }
  return largest;
}

void test_depths_and_poses_should_be_right_up_to_scale_when_the_first_sight_is_exact() {
  SeededRandom random(111);
  const Errors errors = solve_moves(random, 0);
  EXPECT_BELOW(0.03, errors.depth_rms);
  EXPECT_BELOW(0.1, errors.depth_worst);
  EXPECT_BELOW(0.01, errors.turn);
  EXPECT_BELOW(0.06, errors.place);
}

/// The adjustment takes frame 0's rays as exact: their noise goes into the shared pose, and less into the depths.
void test_depths_should_be_right_up_to_scale_when_the_first_sight_is_noisy() {
  SeededRandom random(118);
  const Errors errors = solve_moves(random, kSigma);
  EXPECT_BELOW(0.04, errors.depth_rms);
  EXPECT_BELOW(0.15, errors.depth_worst);
}

void test_median_depth_should_be_the_one_that_was_asked_for() {
  SeededRandom random(112);
  Start start(random, pinhole_camera(), 40);
  for (int k = 1; k <= 20; ++k) start.see(random, on_the_way({1, 0, 0}, Scalar(0.012) * Scalar(k), 0), 40);
  TEST_ASSERT_SAME(StartOutcome::kSettled, start.solve(Scalar(2.5)));
  std::vector<double> rho;
  for (int i = 0; i < 40; ++i)
    if (start.bundle.good(i)) rho.push_back(static_cast<double>(start.bundle.rho(i)));
  std::nth_element(rho.begin(), rho.begin() + static_cast<std::ptrdiff_t>(rho.size() / 2), rho.end());
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1 / 2.5, rho[rho.size() / 2]);
}

void test_start_should_wait_when_the_camera_only_turns() {
  SeededRandom random(113);
  for (int trial = 0; trial < 5; ++trial) {
    Start start(random, pinhole_camera(), 48);
    for (int k = 1; k <= 30; ++k) {
      start.see(random, on_the_way(Vec3::Zero(), 0, Scalar(0.004) * Scalar(k)), 48);
      TEST_ASSERT_SAME(StartOutcome::kWait, start.solve());
    }
  }
}

void test_start_should_wait_when_the_camera_rests() {
  SeededRandom random(114);
  Start start(random, radtan_camera(), 48);
  for (int k = 1; k <= 70; ++k) {  // longer than the record is
    start.see(random, Body(), 48);
    TEST_ASSERT_SAME(StartOutcome::kWait, start.solve());
    TEST_ASSERT_LESS_OR_EQUAL_INT(static_cast<int>(StartRecord::kMaxFrames), start.record.frames());
  }
}

void test_start_should_begin_again_when_too_few_of_the_first_features_are_left() {
  SeededRandom random(115);
  Start start(random, pinhole_camera(), 30);
  start.see(random, on_the_way({1, 0, 0}, Scalar(0.2), 0), 30);
  start.see(random, on_the_way({1, 0, 0}, Scalar(0.25), 0), 11);
  TEST_ASSERT_SAME(StartOutcome::kTooFew, start.solve());
}

/// A sideways move in which four features drift away on their own, so many pixels a frame.
void drift(SeededRandom& random, Start& start, Scalar drift_px) {
  for (int k = 1; k <= 25; ++k) {
    start.see(random, on_the_way({1, 0, 0}, Scalar(0.012) * Scalar(k), 0), 48);
    for (int i = 0; i < 4; ++i)
      start.record.add_pixel(k - 1, i, start.record.pixel(k - 1, i) + Vec2(0, drift_px * Scalar(k)));
  }
}

/// Root mean square of the relative errors of depths up to scale, after a sideways move that was seen through another lens than the
/// calibration's; `prior` null: the bundle takes that as exact.
double solve_through_another_lens(const Camera& lens, const Camera& calibration, const LensPrior* prior,
                                  Camera* adjusted) {
  SeededRandom random(119);
  Start start(random, lens, 48, 0);
  start.camera = calibration;
  if (prior != nullptr) {
    TEST_ASSERT_TRUE(start.bundle.layout(*start.arena, prior->rows.count));
    start.bundle.init();
    start.bundle.free_lens(calibration, *prior, calibration);
  }
  for (int i = 0; i < start.record.features(); ++i) {
    Vec2 z;
    Vec3 ray;
    TEST_ASSERT_TRUE(project(lens, start.record.ray(i), &z));
    TEST_ASSERT_TRUE(unproject(calibration, z, &ray));
    start.record.set_ray(i, ray);
  }
  StartOutcome outcome = StartOutcome::kWait;
  for (int k = 1; k <= 25 && outcome != StartOutcome::kSettled; ++k) {
    start.camera = lens;
    start.see(random, on_the_way({1, 0, 0}, Scalar(0.012) * Scalar(k), Scalar(0.003) * Scalar(k)), 48);
    start.camera = calibration;
    outcome = start.solve();
  }
  TEST_ASSERT_SAME(StartOutcome::kSettled, outcome);
  if (prior != nullptr) *adjusted = *start.bundle.lens();
  std::vector<double> ratio;
  for (int i = 0; i < 48; ++i)
    if (start.bundle.good(i))
      ratio.push_back(static_cast<double>(start.points[static_cast<std::size_t>(i)].norm() * start.bundle.rho(i)));
  TEST_ASSERT_GREATER_THAN_size_t(36, ratio.size());
  std::sort(ratio.begin(), ratio.end());
  double square = 0;
  for (const double r : ratio) square += std::pow(r / ratio[ratio.size() / 2] - 1, 2);
  return std::sqrt(square / static_cast<double>(ratio.size()));
}

void test_wrong_lens_should_be_found_with_the_depths_when_it_is_uncertain() {
  const Camera lens = test_camera(CameraModel::kRadtan, 640, 480, 525, 525, 320, 240, -0.08);
  Camera calibration = test_camera(CameraModel::kRadtan, 640, 480, 525, 525, 320, 240), adjusted;
  LensSigmas sigmas;
  sigmas.focal = Scalar(0.01);
  sigmas.aspect = Scalar(0.001);
  sigmas.centre = Scalar(3);
  sigmas.distortion[0] = Scalar(0.1);
  const LensPrior prior = make_lens_prior(sigmas, &calibration);
  const double as_exact = solve_through_another_lens(lens, calibration, nullptr, nullptr);
  const double with_lens = solve_through_another_lens(lens, calibration, &prior, &adjusted);
  std::printf("depths rms %.4f with the wrong lens, %.4f with k1 of %.3f found\n", as_exact, with_lens,
              static_cast<double>(adjusted.distortion[0]));
  EXPECT_BELOW(0.5 * as_exact, with_lens);
  EXPECT_BELOW(0.05, std::fabs(static_cast<double>(adjusted.distortion[0] - lens.distortion[0])));
}

/// A hand's path, t [s] after frame 0.
Body shaken(double t) {
  Body body;
  body.p_W = Vec3(static_cast<Scalar>(0.15 * std::sin(3 * t)), static_cast<Scalar>(0.08 * std::sin(5 * t)),
                  static_cast<Scalar>(0.03 * std::sin(4 * t)));
  body.q_WC = exp_so3(Vec3(static_cast<Scalar>(0.06 * std::sin(6 * t)), static_cast<Scalar>(0.04 * std::sin(5 * t)),
                           static_cast<Scalar>(0.05 * std::sin(4 * t))));
  return body;
}

Body relative_to_first_frame(double t) {
  Body body = shaken(t);
  const Body first = shaken(0);
  body.q_WC = first.q_WC.conjugate() * body.q_WC;
  body.p_W = first.q_WC.conjugate() * (body.p_W - first.p_W);
  return body;
}

/// Where a point is seen by rows that are read out one after the other, the middle one at t.
Vec2 by_rows(const Camera& camera, Scalar readout, double t, const Vec3& p) {
  Vec2 z(0, static_cast<Scalar>(camera.height) / 2);
  for (int round = 0; round < 4; ++round) {
    const double part = (static_cast<double>(z.y()) + 0.5) / camera.height - 0.5;
    const Body body = relative_to_first_frame(t + static_cast<double>(readout) * part);
    TEST_ASSERT_TRUE(project(camera, body.q_WC.conjugate() * (p - body.p_W), &z));
  }
  return z;
}

/// Root mean square of the relative errors of depths up to scale, of a record whose rows were read out over 20 ms. prior: of the readout,
/// from 0; null: rows are taken to be read out at once.
double solve_rows(const LensPrior* prior, Scalar* readout) {
  SeededRandom random(121);
  const Camera camera = pinhole_camera();
  Start start(random, camera, 48, 0);
  if (prior != nullptr) {
    TEST_ASSERT_TRUE(start.bundle.layout(*start.arena, prior->rows.count));
    start.bundle.init();
    start.bundle.free_lens(camera, *prior, camera);
  }
  for (int i = 0; i < start.record.features(); ++i) {
    Vec3 ray;
    TEST_ASSERT_TRUE(
        unproject(camera, by_rows(camera, Scalar(0.02), 0, start.points[static_cast<std::size_t>(i)]), &ray));
    start.record.set_ray(i, ray);
  }
  StartOutcome outcome = StartOutcome::kWait;
  for (int k = 1; k <= 25; ++k) {
    const double t = 0.033 * k;
    const int frame =
        start.record.add_frame(static_cast<std::int64_t>(k) * 33000000, relative_to_first_frame(t).q_WC, Vec3::Zero());
    for (int i = 0; i < start.record.features(); ++i)
      start.record.add_pixel(frame, i,
                             by_rows(camera, Scalar(0.02), t, start.points[static_cast<std::size_t>(i)]) +
                                 random.normals<2>(static_cast<double>(kSigma)));
    if (k == 25) outcome = start.solve();
  }
  TEST_ASSERT_TRUE(outcome == StartOutcome::kSolved || outcome == StartOutcome::kSettled);
  if (prior != nullptr) *readout = start.bundle.lens()->readout;
  std::vector<double> ratio;
  for (int i = 0; i < 48; ++i)
    if (start.bundle.good(i))
      ratio.push_back(static_cast<double>(start.points[static_cast<std::size_t>(i)].norm() * start.bundle.rho(i)));
  TEST_ASSERT_GREATER_THAN_size_t(24, ratio.size());
  std::sort(ratio.begin(), ratio.end());
  double square = 0;
  for (const double r : ratio) square += std::pow(r / ratio[ratio.size() / 2] - 1, 2);
  return std::sqrt(square / static_cast<double>(ratio.size()));
}

void test_readout_should_be_found_with_the_depths_when_nothing_tells_it() {
  Camera camera = pinhole_camera();
  LensSigmas sigmas;
  sigmas.readout = Scalar(0.015);
  const LensPrior prior = readout_prior(make_lens_prior(sigmas, &camera));
  TEST_ASSERT_EQUAL_INT(1, prior.rows.count);
  Scalar readout = 0;
  const double at_once = solve_rows(nullptr, nullptr), by_rows_found = solve_rows(&prior, &readout);
  std::printf("depths rms %.4f with rows at once, %.4f with a readout of %.2f ms found\n", at_once, by_rows_found,
              1e3 * static_cast<double>(readout));
  EXPECT_BELOW(0.6 * at_once, by_rows_found);
  EXPECT_BELOW(0.004, std::fabs(static_cast<double>(readout) - 0.02));
}

void test_lens_should_be_left_alone_when_a_start_waits() {
  SeededRandom random(120);
  Camera calibration = radtan_camera();
  LensSigmas sigmas;
  sigmas.focal = Scalar(0.01);
  const LensPrior prior = make_lens_prior(sigmas, &calibration);
  Start start(random, calibration, 48);
  TEST_ASSERT_TRUE(start.bundle.layout(*start.arena, prior.rows.count));
  start.bundle.init();
  start.bundle.free_lens(calibration, prior, calibration);
  drift(random, start, Scalar(1.5));
  const Vec3 ray = start.record.ray(7);
  TEST_ASSERT_SAME(StartOutcome::kWait, start.solve());
  TEST_ASSERT_EQUAL_DOUBLE(static_cast<double>(calibration.fx), static_cast<double>(start.bundle.lens()->fx));
  EXPECT_BELOW(1e-5, static_cast<double>((start.record.ray(7) - ray).norm()));
}

void test_features_should_not_be_called_good_when_they_drift() {
  SeededRandom random(116);
  Start start(random, pinhole_camera(), 48);
  drift(random, start, Scalar(0.16));
  const StartOutcome outcome = start.solve();
  TEST_ASSERT_TRUE(outcome == StartOutcome::kSolved || outcome == StartOutcome::kSettled);
  for (int i = 0; i < 4; ++i) TEST_ASSERT_FALSE(start.bundle.good(i));
  int good = 0;
  for (int i = 4; i < 48; ++i) good += start.bundle.good(i) ? 1 : 0;
  TEST_ASSERT_GREATER_THAN_INT(38, good);
}

void test_start_should_wait_when_the_pixels_have_no_common_explanation() {
  SeededRandom random(117);
  Start start(random, pinhole_camera(), 48);
  drift(random, start, Scalar(1.5));
  TEST_ASSERT_SAME(StartOutcome::kWait, start.solve());
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_depths_and_poses_should_be_right_up_to_scale_when_the_first_sight_is_exact);
  RUN_TEST(test_depths_should_be_right_up_to_scale_when_the_first_sight_is_noisy);
  RUN_TEST(test_median_depth_should_be_the_one_that_was_asked_for);
  RUN_TEST(test_start_should_wait_when_the_camera_only_turns);
  RUN_TEST(test_start_should_wait_when_the_camera_rests);
  RUN_TEST(test_start_should_begin_again_when_too_few_of_the_first_features_are_left);
  RUN_TEST(test_wrong_lens_should_be_found_with_the_depths_when_it_is_uncertain);
  RUN_TEST(test_readout_should_be_found_with_the_depths_when_nothing_tells_it);
  RUN_TEST(test_lens_should_be_left_alone_when_a_start_waits);
  RUN_TEST(test_features_should_not_be_called_good_when_they_drift);
  RUN_TEST(test_start_should_wait_when_the_pixels_have_no_common_explanation);
  return UNITY_END();
}
