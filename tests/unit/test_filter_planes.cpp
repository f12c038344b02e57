// Every operation on planes against dense formulas: the covariance after it is F P F^T with F found by differences of the operation
// itself on moved states, and conditioning is the dense Kalman update.
#include <memory>

#include "filter/plane_from_camera.h"
#include "same.h"
#include "support/plane_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// F of an operation at a scene, by central differences over all rows that it may depend on; rows of the body's turn and of bearings
/// are carried over unchanged.
template <typename Make, typename Operation>
void require_linear(const char* name, Make make, Operation operation, double noise_rank_one = 0,
                    const Vec3& noise_axis = Vec3::Zero(), int noise_slot = -1) {
  const auto made = make();
  PlaneScene& nominal = *made;
  const int n = nominal.filter.dim();
  const Dense P = nominal.filter.P();
  const State before_state = nominal.filter->state();
  std::vector<Block> blocks(before_state.block, before_state.block + before_state.slots);
  std::vector<int> first_before;
  for (int s = 0; s < before_state.slots; ++s) first_before.push_back(nominal.filter.first(s));
  operation(nominal);
  const int to = nominal.filter.dim();
  Dense F = Dense::Zero(to, n);
  constexpr double step = 1e-5;
  for (int j = 0; j < n; ++j) {
    Eigen::VectorXd moved[2];
    for (int side = 0; side < 2; ++side) {
      const auto again = make();
      PlaneScene& scene = *again;
      std::vector<Scalar> dx(static_cast<std::size_t>(n), Scalar(0));
      dx[static_cast<std::size_t>(j)] = static_cast<Scalar>(side == 0 ? step : -step);
      scene.filter.move(dx.data());
      operation(scene);
      moved[side] = coordinates(scene.filter);
    }
    F.col(j) = (moved[0] - moved[1]) / (2 * step);
  }
  // What coordinates() leaves out stays what it was, wherever its rows went.
  for (int i = 0; i < kBodyRows; ++i) {
    F.row(i).setZero();
    F(i, i) = 1;
  }
  for (int s = 0; s < before_state.slots; ++s) {
    if (blocks[static_cast<std::size_t>(s)].kind != BlockKind::kInverseDepth) continue;
    const int now = nominal.filter.first(s);
    for (int i = 0; i < 3; ++i) {
      F.row(now + i).setZero();
      F(now + i, first_before[static_cast<std::size_t>(s)] + i) = 1;
    }
  }
  Dense expected = F * P * F.transpose();
  if (noise_slot >= 0) {
    const int first = nominal.filter.first(noise_slot);
    expected.block(first, first, 3, 3) += noise_rank_one * (noise_axis * noise_axis.transpose()).cast<double>();
  }
  const double worst = difference(nominal.filter.P(), expected);
  if (!(worst < 1e-8)) std::printf("%s: %.3g\n", name, worst);
  TEST_ASSERT_TRUE_MESSAGE(worst < 1e-8, name);
}

constexpr std::uint64_t kSeed = 301;

std::unique_ptr<PlaneScene> folded_scene(std::uint64_t seed) {
  SeededRandom random(seed);
  auto made = std::make_unique<PlaneScene>(random, 0.01);
  PlaneScene& scene = *made;
  TEST_ASSERT_EQUAL_INT(8, scene.fold_all(PlaneScene::drop()));
  scene.spread(random, 0.05);
  return made;
}

void test_a_plane_should_have_the_covariance_of_its_fit() {
  SeededRandom random(kSeed);
  PlaneScene scene(random, 0.01);
  const State& state = scene.filter->state();
  const int n = scene.filter.dim(), before = n - 3;
  Dense J = Dense::Zero(3, before);
  for (const int s : scene.on_wall)
    J.block(0, scene.filter.first(s), 3, 3) = fit_plane_jacobian(scene.fit, state.block[s].xyz()).cast<double>();
  const Dense P = scene.filter.P();
  Dense expected(n, n);
  expected.topLeftCorner(before, before) = P.topLeftCorner(before, before);
  expected.bottomLeftCorner(3, before) = J * P.topLeftCorner(before, before);
  expected.topRightCorner(before, 3) = expected.bottomLeftCorner(3, before).transpose();
  expected.bottomRightCorner(3, 3) = J * P.topLeftCorner(before, before) * J.transpose();
  TEST_ASSERT_TRUE(difference(P, expected) < kExact);
}

void test_the_paper_s_fold_should_be_its_transform() {
  const auto make = [] {
    SeededRandom random(kSeed + 1);
    return std::make_unique<PlaneScene>(random, 0.02);
  };
  require_linear("fold", make, [](PlaneScene& scene) { scene.fold_all(PlaneScene::drop()); });
}

void test_unfolding_should_be_the_point_on_the_plane() {
  const auto make = [] { return folded_scene(kSeed + 2); };
  require_linear("unfold", make, [](PlaneScene& scene) { scene.filter->unfold(scene.on_wall[2], Scalar(0)); });
  const auto made = make();
  PlaneScene& scene = *made;
  const Block& plane = scene.filter->state().block[scene.plane];
  Vec3 normal;
  Scalar d;
  plane_normal(scene.filter->state().frame_of(plane), plane.xyz(), &normal, &d);
  require_linear(
      "unfold with noise", make, [](PlaneScene& s) { s.filter->unfold(s.on_wall[2], Scalar(0.03)); }, 0.03 * 0.03,
      normal, scene.on_wall[2]);
}

PlaneFrame another_frame(const PlaneFrame& frame) {
  PlaneFrame to = frame;
  to.R_WP = exp_so3(Vec3(Scalar(0.2), Scalar(-0.3), Scalar(0.4))).toRotationMatrix() * frame.R_WP;
  to.o_W += Vec3(Scalar(0.2), Scalar(0.1), Scalar(-0.3));
  return to;
}

void test_another_frame_should_change_coordinates_only() {
  const auto make = [] { return folded_scene(kSeed + 3); };
  const PlaneFrame to = another_frame(make()->fit.frame);
  require_linear("reanchor", make,
                 [&](PlaneScene& scene) { TEST_ASSERT_TRUE(scene.filter->reanchor(scene.plane, to)); });
  const auto made = make();
  PlaneScene& scene = *made;
  std::vector<Vec3> before;
  for (const int s : scene.on_wall) before.push_back(scene.filter->point(s));
  TEST_ASSERT_TRUE(scene.filter->reanchor(scene.plane, to));
  for (std::size_t i = 0; i < before.size(); ++i)
    TEST_ASSERT_TRUE((scene.filter->point(scene.on_wall[i]) - before[i]).norm() < Scalar(1e-12));
}

void test_a_merge_should_move_the_other_plane_s_points() {
  const auto make = [] {
    SeededRandom random(kSeed + 4);
    auto made = std::make_unique<PlaneScene>(random, 0.01);
    made->fold_all(PlaneScene::drop());
    made->add_second(PlaneScene::drop());
    made->spread(random, 0.05);
    return made;
  };
  require_linear("merge", make, [](PlaneScene& scene) {
    unsigned char folded[Filter::kMaxFolded];
    TEST_ASSERT_EQUAL_INT(5, scene.filter->fold(scene.plane, scene.second_wall.data(), 5, PlaneScene::drop(), folded));
    scene.filter->remove(&scene.other_plane, 1);
  });
}

/// Fixes six points, in two steps, so that the second finds a patch.
void fix_six(PlaneScene& scene, FixForm form) {
  const int* slots = scene.on_wall.data();
  TEST_ASSERT_TRUE(scene.filter->fix(slots, 4, form, slots, 8));
  TEST_ASSERT_TRUE(scene.filter->fix(slots + 5, 2, form, slots, 8));
}

void test_fixed_points_should_lie_where_they_were() {
  for (const FixForm form : {FixForm::kConsider, FixForm::kInflate, FixForm::kErrorFree}) {
    const auto made = folded_scene(kSeed + 5);
    PlaneScene& scene = *made;
    std::vector<Vec3> place;
    std::vector<Mat3> covariance;
    for (const int s : scene.on_wall) {
      place.push_back(scene.filter->point(s));
      covariance.push_back(scene.filter->covariance3(s));
    }
    const int before = scene.filter.dim();
    fix_six(scene, form);
    const int rows = form == FixForm::kConsider ? before + 4 : before + 4 - 12;
    TEST_ASSERT_EQUAL_INT(rows, scene.filter.dim());
    TEST_ASSERT_EQUAL_INT(form == FixForm::kConsider ? 12 : 0, scene.filter.held_dim());
    for (std::size_t i = 0; i < place.size(); ++i) {
      TEST_ASSERT_TRUE((scene.filter->point(scene.on_wall[i]) - place[i]).norm() < Scalar(1e-12));
      if (form != FixForm::kConsider) continue;
      const Mat3 now = scene.filter->covariance3(scene.on_wall[i]);
      TEST_ASSERT_TRUE((now - covariance[i]).norm() < Scalar(1e-9) * covariance[i].norm());
    }
  }
}

void test_released_points_should_have_the_covariance_that_they_had() {
  const auto made = folded_scene(kSeed + 6);
  PlaneScene& scene = *made;
  const auto rows_of = [&](const std::vector<int>& slots) {
    std::vector<int> rows;
    for (int i = 0; i < kBodyRows; ++i) rows.push_back(i);
    rows.push_back(scene.filter.first(scene.plane));
    for (const int s : slots)
      for (int i = 0; i < scene.filter->state().block[s].size; ++i) rows.push_back(scene.filter.first(s) + i);
    return rows;
  };
  std::vector<int> all = scene.on_wall;
  all.insert(all.end(), scene.beside.begin(), scene.beside.end());
  const auto pick = [&] {
    const std::vector<int> rows = rows_of(all);
    const Dense P = scene.filter.P();
    const int n = static_cast<int>(rows.size());
    Dense out(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) out(i, j) = P(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
    return out;
  };
  const Dense before = pick();
  const int dim = scene.filter.dim();
  fix_six(scene, FixForm::kConsider);
  for (const int i : {0, 1, 2, 3, 5, 6})
    TEST_ASSERT_TRUE(scene.filter->release(scene.on_wall[static_cast<std::size_t>(i)]));
  TEST_ASSERT_EQUAL_INT(dim, scene.filter.dim());
  TEST_ASSERT_EQUAL_INT(0, scene.filter.held_dim());
  TEST_ASSERT_EQUAL_INT(-1, scene.filter->group_of(scene.plane));
  TEST_ASSERT_TRUE(difference(pick(), before) < kExact);
}

void test_variance_in_a_drawing_should_be_that_of_the_fixed_point() {
  const auto made = folded_scene(kSeed + 7);
  PlaneScene& scene = *made;
  const int* slots = scene.on_wall.data();
  const auto largest_of = [&](int slot) {
    const Dense C = scene.filter.P().block(scene.filter.first(slot), scene.filter.first(slot), 2, 2);
    const double half = (C(0, 0) + C(1, 1)) / 2, apart = (C(0, 0) - C(1, 1)) / 2;
    return half + std::hypot(apart, C(0, 1));
  };
  const double first = static_cast<double>(scene.filter->variance_in_group(slots[1], slots, 8));
  TEST_ASSERT_TRUE(scene.filter->fix(slots + 1, 1, FixForm::kConsider, slots, 8));
  TEST_ASSERT_TRUE(std::fabs(first - largest_of(slots[1])) < 1e-9 * first);
  const double second = static_cast<double>(scene.filter->variance_in_group(slots[4], slots, 8));
  TEST_ASSERT_TRUE(scene.filter->fix(slots + 4, 1, FixForm::kConsider, slots, 8));
  TEST_ASSERT_TRUE(std::fabs(second - largest_of(slots[4])) < 1e-9 * second);
}

void test_conditioning_should_be_the_dense_update_with_distances_of_zero() {
  SeededRandom random(kSeed + 8);
  PlaneScene scene(random, 0.01, false);  // the textbook filter: no transport
  scene.spread(random, 0.05);
  const State& state = scene.filter->state();
  const int n = scene.filter.dim(), m = 8;
  const Block& plane = state.block[scene.plane];
  Dense H = Dense::Zero(m, n);
  Eigen::VectorXd y(m);
  for (int i = 0; i < m; ++i) {
    const int slot = scene.on_wall[static_cast<std::size_t>(i)];
    const Block& point = state.block[slot];
    Mat13 J_x, J_p;
    y(i) = -static_cast<double>(plane_distance(state.frame_of(plane), plane.xyz(), point.xyz(), &J_x, &J_p));
    H.block(i, scene.filter.first(scene.plane), 1, 3) = J_x.cast<double>();
    H.block(i, scene.filter.first(slot), 1, 3) = J_p.cast<double>();
  }
  const Dense P = scene.filter.P();
  Dense R = 0.002 * 0.002 * Dense::Identity(m, m);
  for (int i = 0; i < m; ++i) {  // and what is neglected: the slant's error times the place's along the plane
    const int at = scene.filter.first(scene.on_wall[static_cast<std::size_t>(i)]);
    const Dense C = P.block(at, at, 3, 3) + P.block(3, 3, 3, 3) - P.block(at, 3, 3, 3) - P.block(3, at, 3, 3);
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d along = state.frame_of(plane).R_WP.col(k).cast<double>();
      const int slant = scene.filter.first(scene.plane) + k;
      R(i, i) += P(slant, slant) * along.dot(C * along);
    }
  }
  const Dense S = H * P * H.transpose() + R;
  const Dense K = P * H.transpose() * inverse_of(S);
  const Dense after = P - K * H * P;
  const Eigen::VectorXd dx = K * y;
  const Vec3 plane_before = plane.xyz();
  const int other = scene.filter.first(scene.beside[0]);
  const Vec3 beside_before = state.block[scene.beside[0]].xyz();
  const int first = scene.filter.first(scene.plane);
  unsigned char folded[Filter::kMaxFolded];
  TEST_ASSERT_EQUAL_INT(
      8, scene.filter->fold(scene.plane, scene.on_wall.data(), m, {Scalar(0.002), Scalar(1e12), true}, folded));
  TEST_ASSERT_TRUE(
      (scene.filter->state().block[scene.plane].xyz() - plane_before - dx.segment(first, 3).cast<Scalar>()).norm() <
      Scalar(1e-11));
  TEST_ASSERT_TRUE(
      (scene.filter->state().block[scene.beside[0]].xyz() - beside_before - dx.segment(other, 3).cast<Scalar>())
          .norm() < Scalar(1e-11));
  const int now = scene.filter.first(scene.plane);
  const Dense expected = after.block(first, first, 3, 3), is = scene.filter.P().block(now, now, 3, 3);
  TEST_ASSERT_TRUE(difference(is, expected) < 1e-8);
  const Dense body = after.topLeftCorner(12, 12), body_is = scene.filter.P().topLeftCorner(12, 12);
  TEST_ASSERT_TRUE(difference(body_is, body) < 1e-8);
}

void test_the_gate_should_keep_out_what_lies_beside() {
  SeededRandom random(kSeed + 9);
  PlaneScene scene(random, 0.001);
  scene.spread(random, 0.01);
  std::vector<int> both = scene.on_wall;
  both.insert(both.end(), scene.beside.begin(), scene.beside.end());
  unsigned char folded[Filter::kMaxFolded];
  const int count = static_cast<int>(both.size());
  TEST_ASSERT_EQUAL_INT(8,
                        scene.filter->fold(scene.plane, both.data(), count, {Scalar(0.002), Scalar(9), true}, folded));
  for (int i = 0; i < count; ++i) TEST_ASSERT_EQUAL_INT(i < 8 ? 1 : 0, folded[i]);
}

/// Fixed points have no gain: an update leaves them and their covariance as they are, and is the dense Schmidt update for all others.
void test_considered_points_should_keep_their_values_in_an_update() {
  SeededRandom random(kSeed + 10);
  const auto made = folded_scene(kSeed + 10);
  PlaneScene& scene = *made;
  fix_six(scene, FixForm::kConsider);
  scene.spread(random, 0.02);
  const Camera camera = pinhole_camera();
  std::vector<PixelMeasurement> seen;
  for (const int s : scene.on_wall) {
    PixelMeasurement o;
    TEST_ASSERT_TRUE(scene.filter->predict_pixel(camera, s, &o));
    o.measured = o.predicted + random.normals<2>(1);
    o.set_noise(Mat2::Identity());
    seen.push_back(o);
  }
  const int n = scene.filter.dim(), m = 2 * static_cast<int>(seen.size());
  Dense H(m, n);
  for (std::size_t i = 0; i < seen.size(); ++i)
    H.middleRows(2 * static_cast<int>(i), 2) = dense_rows(*scene.filter, seen[i].H);
  const Dense P = scene.filter.P();
  const Dense S = H * P * H.transpose() + Dense::Identity(m, m);
  Dense K = P * H.transpose() * inverse_of(S);
  K.middleRows(kBodyRows, scene.filter.held_dim()).setZero();
  const Dense I = Dense::Identity(n, n);
  const Dense schmidt = (I - K * H) * P * (I - K * H).transpose() + K * K.transpose();
  const Eigen::VectorXd before = coordinates(scene.filter);
  const_cast<Filter&>(*scene.filter).begin_update(seen.data(), static_cast<int>(seen.size()));
  TestFilter& filter = scene.filter;
  TEST_ASSERT_TRUE(filter->finish_update(seen.data(), static_cast<int>(seen.size()), nullptr, nullptr));
  const Eigen::VectorXd after = coordinates(filter);
  for (int i = kBodyRows; i < filter->blocks().held_end(); ++i) TEST_ASSERT_EQUAL_DOUBLE(before(i), after(i));
  // The gauge's transport comes on top, of second order here: without it the filter is the dense one.
  Dense held = filter.P().block(kBodyRows, kBodyRows, scene.filter.held_dim(), scene.filter.held_dim());
  TEST_ASSERT_TRUE(
      difference(held, schmidt.block(kBodyRows, kBodyRows, scene.filter.held_dim(), scene.filter.held_dim())) < 0.05);

  const auto plain_made = folded_scene(kSeed + 10);
  PlaneScene& plain = *plain_made;
  fix_six(plain, FixForm::kConsider);
  plain.filter.set_P(P);
  plain.filter->keep_gauge(false);
  plain.filter->begin_update(seen.data(), static_cast<int>(seen.size()));
  TEST_ASSERT_TRUE(plain.filter->finish_update(seen.data(), static_cast<int>(seen.size()), nullptr, nullptr));
  TEST_ASSERT_TRUE(difference(plain.filter.P(), schmidt) < kExact);
}

/// A plane that is rotated and translated together with the camera stays where it was in the camera's axes.
void test_rows_of_a_plane_seen_from_the_camera_should_not_see_what_both_share() {
  SeededRandom random(32);
  PlaneScene scene(random, 0.001);
  scene.fold_all(PlaneScene::drop());
  const int p = scene.filter.first(scene.plane);
  const auto seen = [&] {  // normal and distance from the camera, in its axes
    const State& state = scene.filter->state();
    Vec3 n_W;
    Scalar d_W;
    plane_normal(state.frame_of(state.block[scene.plane]), state.block[scene.plane].xyz(), &n_W, &d_W);
    Eigen::Vector4d out;
    out << (state.body.q_WC.conjugate() * n_W).cast<double>(), static_cast<double>(d_W - n_W.dot(state.body.p_W));
    return out;
  };
  constexpr double step = sizeof(Scalar) == 8 ? 1e-6 : 1e-3;
  for (int k = 0; k < 6; ++k) {
    const auto J = plane_from_camera(scene.filter->state(), scene.plane);
    TEST_ASSERT_EQUAL_INT(2, J.parts);
    std::vector<Scalar> dx(static_cast<std::size_t>(scene.filter.dim()), Scalar(0));
    dx[static_cast<std::size_t>(k)] = static_cast<Scalar>(step);
    for (int i = 0; i < 3; ++i) {
      TEST_ASSERT_SAME(1, J.h[9 * i + i]);
      dx[static_cast<std::size_t>(p + i)] = -static_cast<Scalar>(step) * J.h[9 * i + 3 + k];
    }
    const Eigen::Vector4d before = seen();
    scene.filter.move(dx.data());
    TEST_ASSERT_TRUE((seen() - before).norm() < (sizeof(Scalar) == 8 ? 1e-4 : 2e-2) * step);
  }
}

/// What a wrong plane has taught is taken back along P J^T (J P J^T)^-1, from the camera and all else, and nothing becomes more certain.
void test_forgetting_through_a_plane_should_reach_what_it_has_taught() {
  SeededRandom random(31);
  PlaneScene scene(random, 0.001);
  scene.fold_all(PlaneScene::drop());
  const Dense P = scene.filter.P();
  const Vec3 sigma(Scalar(0.02), Scalar(0.03), Scalar(0.01));
  const auto rows = plane_from_camera(scene.filter->state(), scene.plane);
  const Dense J = dense_rows(*scene.filter, rows);
  scene.filter->forget_through(scene.plane, sigma);
  const Dense G = P * J.transpose() * inverse_of(J * P * J.transpose());
  const Eigen::Vector3d s = sigma.cast<double>();
  const Dense expected = P + G * s.cwiseProduct(s).asDiagonal() * G.transpose();
  const Dense after = scene.filter.P();
  TEST_ASSERT_TRUE((after - expected).cwiseAbs().maxCoeff() <
                   (sizeof(Scalar) == 8 ? 1e-9 : 2e-3) * expected.cwiseAbs().maxCoeff());
  const Dense seen = J * (after - P) * J.transpose();
  for (int i = 0; i < 3; ++i) TEST_ASSERT_FLOAT_WITHIN(0.05 * s(i) * s(i), s(i) * s(i), seen(i, i));
}

/// A prior of covariance C that is taken back but for one part in w leaves the information of a prior of (1 + w) C, and the step of the
/// mean that is not taken counts as uncertain.
void test_taking_back_a_prior_should_leave_what_a_wider_one_would_have_given() {
  SeededRandom random(33);
  PlaneScene scene(random, 0.001);
  scene.fold_all(PlaneScene::drop());
  std::vector<Scalar> dx(static_cast<std::size_t>(scene.filter.dim()), Scalar(0));
  const int p = scene.filter.first(scene.plane);
  for (int k = 0; k < 3; ++k) dx[static_cast<std::size_t>(p + k)] = Scalar(0.01) * static_cast<Scalar>(k + 1);
  scene.filter.move(dx.data());
  const Dense P = scene.filter.P(), Ppp = P.block(p, p, 3, 3), C = 3 * Ppp;
  constexpr double w = 50;
  TEST_ASSERT_TRUE(scene.filter->forget_prior(scene.plane, C.cast<Scalar>(), Scalar(w)));
  Dense information = inverse_of(P);
  information.block(p, p, 3, 3) -= inverse_of(C) * (1 - 1 / (1 + w));
  const Dense M = inverse_of((1 + 1 / w) * C - Ppp);
  const Eigen::VectorXd step = P.middleCols(p, 3) * M * scene.filter->state().block[scene.plane].xyz().cast<double>();
  const Dense expected = inverse_of(information) + step * step.transpose(), after = scene.filter.P();
  TEST_ASSERT_TRUE((after - expected).cwiseAbs().maxCoeff() <
                   (sizeof(Scalar) == 8 ? 1e-9 : 2e-3) * expected.cwiseAbs().maxCoeff());
  TEST_ASSERT_TRUE(step.norm() > 1e-3);
  // What is tighter than the plane is now was never its prior.
  const Dense tight = Ppp / 2;
  TEST_ASSERT_FALSE(scene.filter->forget_prior(scene.plane, tight.cast<Scalar>(), Scalar(w)));
  TEST_ASSERT_SAME(0, (scene.filter.P() - after).cwiseAbs().maxCoeff());
}

/// The scale may hang on two points of two planes, which fills its row; an inverse depth against it needs room for one column more.
void test_sigma_of_an_inverse_depth_should_have_room_for_the_longest_row_of_the_scale() {
  SeededRandom random(37);
  PlaneScene scene(random, 0.001);
  scene.fold_all(PlaneScene::drop());
  scene.add_second(PlaneScene::drop());
  const int slots[4] = {scene.plane, scene.on_wall[0], scene.other_plane, scene.second_wall[0]};
  int slot = -1;
  for (const int s : scene.far_off)
    if (scene.filter->state().block[s].kind == BlockKind::kInverseDepth) slot = s;
  TEST_ASSERT_TRUE(slot >= 0);
  const Scalar rho = scene.filter->state().block[slot].inverse_depth().rho;
  ScaleRow l;
  Eigen::VectorXd row = Eigen::VectorXd::Zero(scene.filter.dim());
  int c = 0;
  for (const int at : slots) {
    const int size = scene.filter->state().block[at].size;
    Scalar h[3];
    for (int k = 0; k < size; ++k, ++c) {
      h[k] = static_cast<Scalar>(random.normal());
      row(scene.filter.first(at) + k) = static_cast<double>(rho * h[k]);
    }
    add_part(&l, Part::of(at, 0, size), h);
  }
  TEST_ASSERT_EQUAL_INT(4, l.parts);
  row(scene.filter.first(slot) + 2) = 1;
  const double expected = std::sqrt(row.dot(scene.filter.P() * row));
  const double sigma = static_cast<double>(scene.filter->relative_sigma_rho(slot, l));
  TEST_ASSERT_TRUE(std::abs(sigma - expected) < (sizeof(Scalar) == 8 ? 1e-9 : 1e-3) * expected);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_plane_should_have_the_covariance_of_its_fit);
  RUN_TEST(test_the_paper_s_fold_should_be_its_transform);
  RUN_TEST(test_unfolding_should_be_the_point_on_the_plane);
  RUN_TEST(test_another_frame_should_change_coordinates_only);
  RUN_TEST(test_a_merge_should_move_the_other_plane_s_points);
  RUN_TEST(test_fixed_points_should_lie_where_they_were);
  RUN_TEST(test_released_points_should_have_the_covariance_that_they_had);
  RUN_TEST(test_variance_in_a_drawing_should_be_that_of_the_fixed_point);
  RUN_TEST(test_rows_of_a_plane_seen_from_the_camera_should_not_see_what_both_share);
  RUN_TEST(test_forgetting_through_a_plane_should_reach_what_it_has_taught);
  RUN_TEST(test_taking_back_a_prior_should_leave_what_a_wider_one_would_have_given);
  RUN_TEST(test_sigma_of_an_inverse_depth_should_have_room_for_the_longest_row_of_the_scale);
  RUN_TEST(test_conditioning_should_be_the_dense_update_with_distances_of_zero);
  RUN_TEST(test_the_gate_should_keep_out_what_lies_beside);
  RUN_TEST(test_considered_points_should_keep_their_values_in_an_update);
  return UNITY_END();
}
