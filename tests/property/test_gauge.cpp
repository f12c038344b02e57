// What one camera cannot observe: shifting, turning and scaling the whole world must not be seen by any measurement, must be
// carried by every verb of the filter, and must gain no information over a run.
#include "filter/gauge_information.h"
#include "filter/tuning.h"
#include "same.h"
#include "support/plane_scene.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kShiftAndTurn = 6, kAll = 7;

/// Of a covariance whose correlations have about this smallest eigenvalue.
void require_information(double smallest, bool expected) {
  SeededRandom random(68);
  TestFilter filter(true);
  fill_map(random, filter, 3, 3);
  Dense vectors;
  Eigen::VectorXd values = eigenvalues_of(random_covariance(random, filter.dim(), 1), &vectors);
  values(0) = smallest * values(filter.dim() - 1);
  const Dense P = vectors * values.asDiagonal() * vectors.transpose();
  filter.set_P(P);
  std::vector<double> scratch(static_cast<std::size_t>(filter.dim() * (filter.dim() + 8)));
  double out[49];
  TEST_ASSERT_EQUAL_INT(expected, gauge_information(*filter, scratch.data(), out));
  if (!expected) return;
  Dense whole = P;
  if (smallest < 0) whole.diagonal() *= 1 + static_cast<double>(tuning::soundness::kRounding);
  const Dense N = filter.gauge(), A = Eigen::Map<const Eigen::Matrix<double, 7, 7, Eigen::RowMajor>>(out);
  TEST_ASSERT_TRUE(largest(A - N.transpose() * whole.inverse() * N) < 1e-6 * largest(A));
}

void test_information_should_be_that_of_a_covariance_to_the_rounding_that_a_frame_allows() {
  require_information(1e-3, true);
  require_information(-1e-9, true);
  require_information(-1e-7, true);
  require_information(-1e-4, false);
}

void test_no_pixel_should_see_a_shift_a_turn_or_a_change_of_scale() {
  SeededRandom random(61);
  for (int trial = 0; trial < 20; ++trial) {
    TestFilter filter(true);
    const std::vector<int> slots = fill_map(random, filter, 6, 8);
    filter.set_P(random_covariance(random, filter.dim(), 0.1));
    Camera camera = test_camera_of(trial % kTestCameras);
    if (trial / kTestCameras % 2 == 1) camera.readout = Scalar(0.03);
    const Dense N = filter.gauge();
    for (const int slot : slots) {
      PixelMeasurement o;
      TEST_ASSERT_TRUE(filter->predict_pixel(camera, slot, &o));
      const Dense H = dense_rows(*filter, o.H);
      for (int c = 0; c < kAll; ++c)
        TEST_ASSERT_TRUE(largest(H * N.col(c)) < 1e-11 * (1 + largest(H) * largest(N.col(c))));
    }
  }
}

/// A reference camera somewhere else than the camera is, that stays.
int add_camera(SeededRandom& random, TestFilter& filter) {
  const Body body = filter->state().body;
  filter->set_mean(random_body(random));
  const int camera = filter->add_reference_camera();
  filter->pin(camera);
  filter->set_mean(body);
  return camera;
}

/// Gives the filter a covariance of nothing but gauge directions, N A N^T, applies a verb, and asks that it is N A N^T at the new
/// state: M N- = N+ for what the verb does with errors, over the first `directions`.
template <typename Verb>
void carries(const char* name, int directions, SeededRandom& random, Verb verb) {
  for (int trial = 0; trial < 10; ++trial) {
    TestFilter filter(true);
    const std::vector<int> slots = fill_map(random, filter, 4, 6);
    add_camera(random, filter);
    const Dense A = random_covariance(random, directions, 1);
    const Dense before = filter.gauge().leftCols(directions);
    filter.set_P(before * A * before.transpose());
    verb(filter, slots);
    const Dense after = filter.gauge().leftCols(directions);
    const Dense expected = after * A * after.transpose();
    const double error = largest(filter.P() - expected) / largest(expected);
    if (!(error < 1e-12)) std::printf("%s: relative error %.3g\n", name, error);
    TEST_ASSERT_TRUE_MESSAGE(error < 1e-12, name);
  }
}

void test_prediction_should_carry_every_direction() {
  SeededRandom random(62);
  const auto predict = [](TestFilter& filter, const std::vector<int>&) {
    Transition transition;
    predict_constant_velocity(filter->state().body, BodyLayout::with_constant_velocity(), Scalar(0.05),
                              {Scalar(0), Scalar(0)}, &transition);
    filter->predict(transition);
  };
  carries("predict", kAll, random, predict);
}

void test_damping_should_carry_every_direction() {
  SeededRandom random(63);
  const auto damp = [](TestFilter& filter, const std::vector<int>&) {
    Transition transition;
    damp_speed(filter->state().body, BodyLayout::with_constant_velocity(), Scalar(0.7), filter->state().body.w_C,
               Mat6::Zero(), &transition);
    for (Scalar& q : transition.Q) q = Scalar(0);
    filter->predict(transition);
  };
  carries("damp", kAll, random, damp);
}

void test_steering_should_carry_shifts_and_turns() {
  SeededRandom random(64);  // in metres, so it does not scale with the world
  const auto steer = [](TestFilter& filter, const std::vector<int>&) {
    Transition transition;
    change_velocity(filter->state().body, BodyLayout::with_constant_velocity(),
                    Vec3(Scalar(0.3), Scalar(-0.2), Scalar(0.5)), Vec3(Scalar(0.1), Scalar(0.4), Scalar(-0.2)),
                    &transition);
    filter->predict(transition);
  };
  carries("steer", kShiftAndTurn, random, steer);
}

void test_a_new_anchor_should_carry_every_direction() {
  SeededRandom random(65);
  carries("add_anchor", kAll, random, [](TestFilter& filter, const std::vector<int>&) { filter->add_anchor(); });
}

void test_a_new_reference_camera_should_carry_every_direction() {
  SeededRandom random(76);
  const auto begin = [](TestFilter& filter, const std::vector<int>&) { filter->add_reference_camera(); };
  carries("add_reference_camera", kAll, random, begin);
  const auto end = [](TestFilter& filter, const std::vector<int>&) {
    const int camera = filter->add_reference_camera();
    filter->pin(camera);
    filter->unpin(camera);
  };
  carries("unpin", kAll, random, end);
}

/// The motion since a reference camera is not seen by shifts and turns of the world, and grows with the world.
void test_the_motion_since_a_camera_should_know_nothing_of_the_gauge_but_the_scale() {
  SeededRandom random(75);
  for (int trial = 0; trial < 10; ++trial) {
    TestFilter filter(true);
    fill_map(random, filter, 4, 6);
    const int camera = add_camera(random, filter);
    Quat q_KC;
    Vec3 p_KC;
    Mat6 covariance;
    const Dense N = filter.gauge();
    const Dense A = random_covariance(random, kShiftAndTurn, 1);
    filter.set_P(N.leftCols(kShiftAndTurn) * A * N.leftCols(kShiftAndTurn).transpose());
    filter->motion_since(camera, &q_KC, &p_KC, &covariance);
    TEST_ASSERT_TRUE(largest(covariance.cast<double>()) < 1e-12 * largest(filter.P()));
    filter.set_P(N.col(kAll - 1) * N.col(kAll - 1).transpose());
    filter->motion_since(camera, &q_KC, &p_KC, &covariance);
    Dense expected = Dense::Zero(6, 6);
    expected.bottomRightCorner(3, 3) = (p_KC * p_KC.transpose()).cast<double>();
    TEST_ASSERT_TRUE(largest(covariance.cast<double>() - expected) < 1e-12 * largest(filter.P()));
  }
}

void test_a_new_inverse_depth_should_carry_shifts_and_turns() {
  SeededRandom random(66);  // its depth has a prior in metres
  const auto begin = [](TestFilter& filter, const std::vector<int>&) {
    const Vec3 ray = Vec3(Scalar(0.2), Scalar(-0.1), 1).normalized();
    filter->add_inverse_depth(filter->add_anchor(), ray, Mat32::Zero(), Mat2::Zero(), Scalar(0.5), Scalar(0));
  };
  carries("add_inverse_depth", kShiftAndTurn, random, begin);
  const auto begin_late = [](TestFilter& filter, const std::vector<int>&) {
    const Vec3 ray = Vec3(Scalar(0.2), Scalar(-0.1), 1).normalized();
    filter->add_inverse_depth(filter->add_anchor(), ray, Mat32::Zero(), Mat2::Zero(), Scalar(0.5), Scalar(0),
                              Scalar(0.01));
  };
  carries("add_inverse_depth of a later row", kShiftAndTurn, random, begin_late);
}

void test_conversion_should_carry_every_direction() {
  SeededRandom random(67);
  const auto convert = [](TestFilter& filter, const std::vector<int>& slots) {
    filter->convert_to_point(slots.back());
    filter->convert_to_point(slots[slots.size() - 2]);
  };
  carries("convert_to_point", kAll, random, convert);
  const auto convert_all = [](TestFilter& filter, const std::vector<int>& slots) {
    for (std::size_t i = 4; i < slots.size(); ++i) filter->convert_to_point(slots[i]);  // their anchors go too
  };
  carries("convert_to_point of all", kAll, random, convert_all);
}

void test_removal_should_carry_every_direction() {
  SeededRandom random(68);
  const auto remove = [](TestFilter& filter, const std::vector<int>& slots) {
    const int gone[3] = {slots[1], slots[4], slots[7]};
    filter->remove(gone, 3);
  };
  carries("remove", kAll, random, remove);
}

/// The same for operations on planes, with the wall's points exactly on it where they are folded.
template <typename Before, typename Verb>
void carries_planes(const char* name, SeededRandom& random, Before before, Verb verb, double most = 1e-11) {
  for (int trial = 0; trial < 10; ++trial) {
    PlaneScene scene(random, 0);
    before(scene);
    add_camera(random, scene.filter);
    const Dense A = random_covariance(random, kAll, 1);
    const Dense N = scene.filter.gauge();
    scene.filter.set_P(N * A * N.transpose());
    verb(scene);
    const Dense after = scene.filter.gauge();
    const Dense expected = after * A * after.transpose();
    const double error = largest(scene.filter.P() - expected) / largest(expected);
    if (!(error < most)) std::printf("%s: relative error %.3g\n", name, error);
    TEST_ASSERT_TRUE_MESSAGE(error < most, name);
  }
}

void nothing(PlaneScene&) {}
void folded(PlaneScene& scene) { TEST_ASSERT_EQUAL_INT(8, scene.fold_all(PlaneScene::drop())); }

void move_a_little(PlaneScene& scene, SeededRandom& random) {
  std::vector<Scalar> dx(static_cast<std::size_t>(scene.filter.dim()));
  for (Scalar& d : dx) d = static_cast<Scalar>(0.05 * random.normal());
  scene.filter.move(dx.data());
}

void test_operations_on_planes_should_carry_every_direction() {
  SeededRandom random(71);
  const auto begin = [](PlaneScene& scene) {
    std::vector<int> wall = scene.on_wall;
    std::vector<Vec3> points;
    for (const int s : wall) points.push_back(scene.filter->state().block[s].xyz());
    PlaneFit fit;
    TEST_ASSERT_TRUE(fit_plane(points.data(), 8, Vec3::Zero(), &fit));
    TEST_ASSERT_TRUE(scene.filter->add_plane(fit, wall.data(), 8, Scalar(0)) >= 0);
  };
  carries_planes("add_plane", random, nothing, begin);
  carries_planes("fold", random, nothing, folded);
  const auto begin_on = [](Scalar tau) {
    return [tau](PlaneScene& scene) {
      const State& state = scene.filter->state();
      const Vec3 to_W = scene.fit.frame.o_W - state.body.p_W;
      const Vec3 ray_C = (state.body.q_WC.conjugate() * to_W).normalized();
      TEST_ASSERT_TRUE(scene.filter->add_plane_point(scene.plane, ray_C, Mat32::Zero(), Mat2::Zero(), tau) >= 0);
    };
  };
  const auto slanted = [&](PlaneScene& scene) { move_a_little(scene, random); };
  carries_planes("add_plane_point", random, slanted, begin_on(Scalar(0)));
  carries_planes("add_plane_point of a later row", random, slanted, begin_on(Scalar(0.01)));
  const auto moved = [&](PlaneScene& scene) {
    folded(scene);
    move_a_little(scene, random);
  };
  carries_planes("unfold", random, moved, [](PlaneScene& scene) { scene.filter->unfold(scene.on_wall[3], Scalar(0)); });
  carries_planes("reanchor", random, moved, [](PlaneScene& scene) {
    PlaneFrame to = scene.fit.frame;
    to.R_WP = exp_so3(Vec3(Scalar(0.2), Scalar(0.1), Scalar(-0.4))).toRotationMatrix() * to.R_WP;
    to.o_W += Vec3(Scalar(0.3), Scalar(-0.2), Scalar(0.1));
    TEST_ASSERT_TRUE(scene.filter->reanchor(scene.plane, to));
  });
  const auto fix = [](PlaneScene& scene) {
    TEST_ASSERT_TRUE(scene.filter->fix(scene.on_wall.data(), 5, FixForm::kConsider, scene.on_wall.data(), 8));
  };
  carries_planes("fix", random, moved, fix, 1e-9);  // a patch has a hair of noise of its own
  const auto fixed = [&](PlaneScene& scene) {
    moved(scene);
    fix(scene);
    move_a_little(scene, random);
  };
  carries_planes("fix into a patch", random, fixed, [](PlaneScene& scene) {
    TEST_ASSERT_TRUE(scene.filter->fix(scene.on_wall.data() + 5, 2, FixForm::kConsider, nullptr, 0));
  });
  carries_planes("release", random, fixed, [](PlaneScene& scene) { scene.filter->release(scene.on_wall[1]); });
  carries_planes("unfold from a patch", random, fixed,
                 [](PlaneScene& scene) { scene.filter->unfold(scene.on_wall[1], Scalar(0)); });
}

void test_no_pixel_of_a_plane_s_point_should_see_the_gauge() {
  SeededRandom random(72);
  for (int trial = 0; trial < 10; ++trial) {
    PlaneScene scene(random, 0);
    folded(scene);
    TEST_ASSERT_TRUE(scene.filter->fix(scene.on_wall.data(), 5, FixForm::kConsider, scene.on_wall.data(), 8));
    move_a_little(scene, random);
    const Dense N = scene.filter.gauge();
    int seen = 0;
    for (const int slot : scene.on_wall) {
      PixelMeasurement o;
      if (!scene.filter->predict_pixel(pinhole_camera(), slot, &o)) continue;
      ++seen;
      const Dense H = dense_rows(*scene.filter, o.H);
      for (int c = 0; c < kAll; ++c)
        TEST_ASSERT_TRUE(largest(H * N.col(c)) < 1e-11 * (1 + largest(H) * largest(N.col(c))));
    }
    TEST_ASSERT_GREATER_THAN_INT(4, seen);
  }
}

/// An update with noisy pixels of the wall's points.
void update_with_wall(PlaneScene& scene, SeededRandom& random) {
  std::vector<PixelMeasurement> seen;
  for (const int slot : scene.on_wall) {
    PixelMeasurement o;
    if (!scene.filter->predict_pixel(pinhole_camera(), slot, &o)) continue;
    o.measured = o.predicted + random.normals<2>(2);
    o.set_noise(Mat2::Identity() * Scalar(0.25));
    seen.push_back(o);
  }
  scene.filter->begin_update(seen.data(), static_cast<int>(seen.size()));
  TEST_ASSERT_TRUE(scene.filter->finish_update(seen.data(), static_cast<int>(seen.size()), nullptr, nullptr));
}

/// After a fold that moves the state, and after an update of planar points with considered ones among them, the information about the
/// gauge is what it was.
void test_folds_and_updates_should_gain_nothing_about_the_gauge() {
  SeededRandom random(73);
  for (int trial = 0; trial < 10; ++trial) {
    PlaneScene scene(random, 0.01);
    // Tight, so that the world is a rigid one that drifts: gauge directions with little else.
    const Dense N = scene.filter.gauge();
    const Dense A = random_covariance(random, kAll, 0.3);
    scene.filter.set_P(N * A * N.transpose() + random_covariance(random, scene.filter.dim(), 0.02));
    Dense before = scene.filter.gauge_information();
    unsigned char in[Filter::kMaxFolded];
    TEST_ASSERT_EQUAL_INT(
        8, scene.filter->fold(scene.plane, scene.on_wall.data(), 8, {Scalar(0.002), Scalar(1e6), true}, in));
    Dense now = scene.filter.gauge_information();
    for (int i = 0; i < kAll; ++i) {
      if (!(now(i, i) < before(i, i) * (1 + 1e-9)))
        std::printf("fold, direction %d: %.3g\n", i, now(i, i) / before(i, i) - 1);
      TEST_ASSERT_TRUE(now(i, i) < before(i, i) * (1 + 1e-9));
    }
    TEST_ASSERT_TRUE(scene.filter->fix(scene.on_wall.data(), 5, FixForm::kConsider, scene.on_wall.data(), 8));
    before = scene.filter.gauge_information();
    update_with_wall(scene, random);
    now = scene.filter.gauge_information();
    for (int i = 0; i < kAll; ++i) {
      if (!(now(i, i) < before(i, i) * (1 + 1e-9)))
        std::printf("update, direction %d: %.3g\n", i, now(i, i) / before(i, i) - 1);
      TEST_ASSERT_TRUE(now(i, i) < before(i, i) * (1 + 1e-9));
    }
  }
}

/// A point that begins before a wall has nothing of its own but how far it is off.
void test_a_new_point_before_a_wall_should_carry_every_direction() {
  SeededRandom random(78);
  for (const Scalar tau : {Scalar(0), Scalar(0.01)}) {
    const auto begin = [tau](PlaneScene& scene) {
      const State& state = scene.filter->state();
      const Vec3 to_W = scene.fit.frame.o_W - state.body.p_W;
      const Vec3 ray_C = (state.body.q_WC.conjugate() * to_W).normalized();
      const int anchor = scene.filter->add_anchor();
      TEST_ASSERT_TRUE(
          scene.filter->add_before_plane(anchor, scene.plane, ray_C, Mat32::Zero(), Mat2::Zero(), 0, tau) >= 0);
    };
    carries_planes(
        "add_before_plane", random, [&](PlaneScene& scene) { move_a_little(scene, random); }, begin);
  }
}

/// A wall that is known beforehand says where the world is, when it enters: N_w^T C^-1 N_w of its own rows, and nothing later.
void test_a_known_wall_should_bring_its_own_information_once() {
  SeededRandom random(77);
  for (int trial = 0; trial < 10; ++trial) {
    PlaneScene scene(random, 0.01);
    const Dense N = scene.filter.gauge();
    scene.filter.set_P(N * random_covariance(random, kAll, 0.3) * N.transpose() +
                       random_covariance(random, scene.filter.dim(), 0.02));
    const Dense before = scene.filter.gauge_information();
    PlaneFrame frame = scene.fit.frame;
    frame.R_WP = random_turn(random, 0.1).toRotationMatrix() * frame.R_WP;
    const Dense C = random_covariance(random, 3, 0.05);
    const int wall = scene.filter->add_known_plane(frame, C.cast<Scalar>(), Scalar(0.002));
    TEST_ASSERT_TRUE(wall >= 0);
    const Dense N_w = plane_gauge(frame, Vec3::Zero()).cast<double>();
    const Dense expected = before + N_w.transpose() * inverse_of(C) * N_w;
    Dense now = scene.filter.gauge_information();
    TEST_ASSERT_TRUE(largest(now - expected) < 1e-9 * largest(expected));

    unsigned char in[Filter::kMaxFolded];
    TEST_ASSERT_EQUAL_INT(8, scene.filter->fold(wall, scene.on_wall.data(), 8, {Scalar(0.002), Scalar(1e6), true}, in));
    const Dense folded = scene.filter.gauge_information();
    for (int i = 0; i < kAll; ++i) TEST_ASSERT_TRUE(folded(i, i) < now(i, i) * (1 + 1e-9));
    for (int k = 0; k < 3; ++k) update_with_wall(scene, random);
    now = scene.filter.gauge_information();
    for (int i = 0; i < kAll; ++i) TEST_ASSERT_TRUE(now(i, i) < folded(i, i) * (1 + 1e-9));
  }
}

/// Largest growth of the information along any gauge direction in one frame, relative to what there was, over 60 frames of a
/// hand that moves in front of 16 points whose depths are not known at first.
struct Growth {
  double shift_and_turn = 0, scale = 0;
};

Growth run(bool keep_gauge, SeededRandom& random) {
  TestFilter filter(keep_gauge);
  const Camera camera = pinhole_camera();
  constexpr int kPoints = 16, kFrames = 60;
  constexpr Scalar dt = Scalar(1) / Scalar(30), sigma = Scalar(0.5);
  Body truth;
  truth.q_WC = random_turn(random, 0.3);
  truth.p_W = random.normals<3>(0.5);
  filter->set_mean(truth);
  filter.set_P(Eigen::VectorXd::Constant(kBodyRows, 0.01).asDiagonal());

  Vec3 point[kPoints];
  int slot[kPoints];
  const int anchor = filter->add_anchor();
  for (int i = 0; i < kPoints; ++i) {
    point[i] = point_in_view(random, truth);
    Vec2 z;
    Vec3 ray;
    Mat32 J;
    TEST_ASSERT_TRUE(project(camera, truth.q_WC.conjugate() * (point[i] - truth.p_W), &z));
    TEST_ASSERT_TRUE(unproject(camera, z + random.normals<2>(static_cast<double>(sigma)), &ray, &J));
    slot[i] = filter->add_inverse_depth(anchor, ray, J, Mat2::Identity() * (sigma * sigma), Scalar(0.5), Scalar(0.5));
  }

  Growth growth;
  Dense before;
  int points = 0;
  for (int k = 0; k < kFrames; ++k) {
    if (k == kFrames / 4) filter->pin(filter->add_reference_camera());  // a mark
    truth.v_W = Vec3(Scalar(0.5) * std::cos(Scalar(k) / 8), Scalar(0.3) * std::sin(Scalar(k) / 11), Scalar(0.1));
    truth.w_C = Vec3(Scalar(0.2) * std::sin(Scalar(k) / 7), Scalar(-0.2) * std::cos(Scalar(k) / 9), Scalar(0.05));
    Transition transition;
    predict_constant_velocity(truth, BodyLayout::with_constant_velocity(), dt, {}, &transition);
    truth = transition.mean;
    predict_constant_velocity(filter->state().body, BodyLayout::with_constant_velocity(), dt, {Scalar(3), Scalar(3)},
                              &transition);
    filter->predict(transition);
    PixelMeasurement o[kPoints];
    int count = 0;
    for (int i = 0; i < kPoints; ++i) {
      Vec2 z;
      if (!project(camera, truth.q_WC.conjugate() * (point[i] - truth.p_W), &z)) continue;
      if (!filter->predict_pixel(camera, slot[i], &o[count])) continue;
      o[count].measured = z + random.normals<2>(static_cast<double>(sigma));
      o[count].set_noise(Mat2::Identity() * (sigma * sigma) + o[count].second_order);
      ++count;
    }
    filter->begin_update(o, count);
    TEST_ASSERT_TRUE(filter->finish_update(o, count, nullptr, nullptr));
    points = 0;
    for (int i = 0; i < kPoints; ++i) {
      const Block& block = filter->state().block[slot[i]];
      // Every second one is converted on the way, as soon as its depth is surely positive.
      const Scalar rho = block.inverse_depth().rho;
      if (block.kind == BlockKind::kInverseDepth && i % 2 == 0 && k > 20 &&
          rho * rho > Scalar(9) * filter->block_variance(slot[i], 2))
        filter->convert_to_point(slot[i]);
      points += filter->state().block[slot[i]].kind == BlockKind::kPoint ? 1 : 0;
    }

    const Dense now = filter.gauge_information();
    // Where the camera is seen from a state that is far from W's origin, turns and shifts mix: compare along the axes.
    for (int i = 0; i < kAll && k > 0; ++i) {
      const double grown = (now(i, i) - before(i, i)) / before(i, i);
      double& worst = i < kShiftAndTurn ? growth.shift_and_turn : growth.scale;
      worst = std::max(worst, grown);
    }
    before = now;
  }
  TEST_ASSERT_GREATER_THAN_INT(4, points);  // the run went through conversions
  TEST_ASSERT_TRUE((filter->state().body.p_W - truth.p_W).norm() < Scalar(0.5));
  std::printf("largest growth in a frame: shift and turn %.3g, scale %.3g; %d points\n", growth.shift_and_turn,
              growth.scale, points);
  return growth;
}

/// A model that measures the scale says so in one place: its direction is zero in the rows and in the information, nothing picks a log
/// scale, and updates still gain nothing about the other six.
void test_a_direction_that_is_observable_should_be_zero_and_leave_the_others() {
  SeededRandom random(74);
  for (int trial = 0; trial < 10; ++trial) {
    PlaneScene scene(random, 0.01);
    const Dense N = scene.filter.gauge();
    scene.filter.set_P(N * random_covariance(random, kAll, 0.3) * N.transpose() +
                       random_covariance(random, scene.filter.dim(), 0.02));
    const Dense all = scene.filter.gauge_information();
    scene.filter.set_unobservable(gauge::kMetric);
    TEST_ASSERT_SAME(0, largest(scene.filter.gauge().leftCols(kShiftAndTurn) - N.leftCols(kShiftAndTurn)));
    TEST_ASSERT_SAME(0, largest(scene.filter.gauge().col(gauge::kScale)));
    const Dense before = scene.filter.gauge_information();
    TEST_ASSERT_SAME(0, largest(before.topLeftCorner(6, 6) - all.topLeftCorner(6, 6)));
    TEST_ASSERT_SAME(0, largest(before.row(gauge::kScale)));
    TEST_ASSERT_SAME(0, largest(before.col(gauge::kScale)));
    ScaleRow l;
    TEST_ASSERT_FALSE(scene.filter->scale_row(&l));
    update_with_wall(scene, random);
    const Dense now = scene.filter.gauge_information();
    for (int i = 0; i < kShiftAndTurn; ++i) TEST_ASSERT_TRUE(now(i, i) < before(i, i) * (1 + 1e-9));
  }
}

void test_information_about_the_gauge_should_never_grow_when_it_is_kept() {
  SeededRandom random(69);
  for (int trial = 0; trial < 5; ++trial) {
    const Growth growth = run(true, random);
    TEST_ASSERT_TRUE(growth.shift_and_turn < 1e-9);
    TEST_ASSERT_TRUE(growth.scale < 1e-9);
  }
}

void test_information_about_the_gauge_should_grow_with_the_textbook_filter() {
  SeededRandom random(70);
  for (int trial = 0; trial < 5; ++trial) {
    const Growth growth = run(false, random);
    TEST_ASSERT_TRUE(growth.shift_and_turn > 1e-6);
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_information_should_be_that_of_a_covariance_to_the_rounding_that_a_frame_allows);
  RUN_TEST(test_no_pixel_should_see_a_shift_a_turn_or_a_change_of_scale);
  RUN_TEST(test_prediction_should_carry_every_direction);
  RUN_TEST(test_damping_should_carry_every_direction);
  RUN_TEST(test_steering_should_carry_shifts_and_turns);
  RUN_TEST(test_a_new_anchor_should_carry_every_direction);
  RUN_TEST(test_a_new_reference_camera_should_carry_every_direction);
  RUN_TEST(test_the_motion_since_a_camera_should_know_nothing_of_the_gauge_but_the_scale);
  RUN_TEST(test_a_new_inverse_depth_should_carry_shifts_and_turns);
  RUN_TEST(test_conversion_should_carry_every_direction);
  RUN_TEST(test_removal_should_carry_every_direction);
  RUN_TEST(test_operations_on_planes_should_carry_every_direction);
  RUN_TEST(test_no_pixel_of_a_plane_s_point_should_see_the_gauge);
  RUN_TEST(test_folds_and_updates_should_gain_nothing_about_the_gauge);
  RUN_TEST(test_a_new_point_before_a_wall_should_carry_every_direction);
  RUN_TEST(test_a_known_wall_should_bring_its_own_information_once);
  RUN_TEST(test_a_direction_that_is_observable_should_be_zero_and_leave_the_others);
  RUN_TEST(test_information_about_the_gauge_should_never_grow_when_it_is_kept);
  RUN_TEST(test_information_about_the_gauge_should_grow_with_the_textbook_filter);
  return UNITY_END();
}
